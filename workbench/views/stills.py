"""Pictures of a mesh view made by the server, for a browser without WebGL2."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from corpus_tools.render import apply_window, probe_offscreen
from workbench.views.posed import PosedScene

__all__ = ["Stills"]

_DRAWER = ThreadPoolExecutor(1, thread_name_prefix="pictures")
"""One thread draws for all views: VTK wants a window to be used where it was made."""
LARGEST_PX = 1600


class Stills:
    """Draws a scene at one moment, in a thread of its own; remembers the scene between pictures."""

    def __init__(self) -> None:
        self._scene: PosedScene | None = None
        self._key: Any = None

    def ask(self, scene: Mapping[str, Any], moment: Mapping[str, Any], reply: Callable[..., None]) -> None:
        """Draw, and call `reply` from the drawing thread.

        Parameters
        ----------
        scene : mapping
            actors, lights, motion, ground, camera (which may be empty), revision.
        moment : mapping
            time (s), width, height (px), and the camera of the browser, or None.
        reply : callable
            ``reply(picture=jpeg, camera=camera)`` or ``reply(reason=sentence)``.
        """
        _DRAWER.submit(self._answer, dict(scene), dict(moment), reply)

    def _answer(self, scene: dict[str, Any], moment: dict[str, Any], reply: Callable[..., None]) -> None:
        status = probe_offscreen()
        if not status.ok:
            reply(reason=status.reason)
            return
        apply_window(status)
        try:
            reply(**self._draw(scene, moment))
        except Exception as error:  # the page must hear of it, whatever it was
            reply(reason=f"The server could not draw the picture ({type(error).__name__}: {error}).")

    def _draw(self, scene: dict[str, Any], moment: dict[str, Any]) -> dict[str, Any]:
        actors = scene["actors"]
        key = (scene["revision"], [(a["name"], id(a["points"]), id(a["scalars"])) for a in actors])
        if self._scene is None or key != self._key:
            self._close()
            self._scene, self._key = PosedScene(actors, scene["lights"]), key
        self._scene.pose(actors, scene["motion"], float(moment["time"]))
        camera = moment.get("camera") or scene["camera"] or self._scene.home()
        size = tuple(max(16, min(LARGEST_PX, int(moment[side]))) for side in ("width", "height"))
        return {"picture": self._scene.picture(camera, scene["ground"], size), "camera": camera}  # type: ignore[arg-type]

    def _close(self) -> None:
        if self._scene is not None:
            self._scene.close()
            self._scene = None

    def close(self) -> None:
        """Give the window back, in the thread that made it."""
        _DRAWER.submit(self._close)
