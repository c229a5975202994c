"""Pictures with pyvista, off-screen: the probe, the scene, snapshots."""

from corpus_tools.render.probe import OffscreenStatus, apply_window, probe_offscreen
from corpus_tools.render.scene import PART_STYLES, VIEWS, part_surface, scene, snapshot

__all__ = [
    "PART_STYLES",
    "VIEWS",
    "OffscreenStatus",
    "apply_window",
    "part_surface",
    "probe_offscreen",
    "scene",
    "snapshot",
]
