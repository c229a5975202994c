"""Pictures with pyvista, off-screen: the probe, the scene, snapshots, films; and every export by name."""

from corpus_tools.render.encoder import Encoder, encoding, ffmpeg_path
from corpus_tools.render.exports import (
    EXPORTERS,
    Exporter,
    check_exports,
    export_all,
    export_names,
    is_export_folder,
)
from corpus_tools.render.film import film_times_s, write_film, write_frames
from corpus_tools.render.moving import MovingHead, poses_at
from corpus_tools.render.probe import OffscreenStatus, apply_window, probe_offscreen
from corpus_tools.render.scene import PART_STYLES, VIEWS, scene, snapshot
from corpus_tools.render.surfaces import DrawnPart, drawn_part, part_surface

__all__ = [
    "EXPORTERS",
    "PART_STYLES",
    "VIEWS",
    "DrawnPart",
    "Encoder",
    "Exporter",
    "MovingHead",
    "OffscreenStatus",
    "apply_window",
    "check_exports",
    "drawn_part",
    "encoding",
    "export_all",
    "export_names",
    "ffmpeg_path",
    "film_times_s",
    "is_export_folder",
    "part_surface",
    "poses_at",
    "probe_offscreen",
    "scene",
    "snapshot",
    "write_film",
    "write_frames",
]
