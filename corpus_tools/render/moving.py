"""A scene that is drawn again and again: one plotter, points and normals written in place."""

from __future__ import annotations

import itertools
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image

from corpus_tools.core import FloatArray, Mesh
from corpus_tools.mesh import with_level_neck
from corpus_tools.render.scene import scene
from corpus_tools.render.surfaces import DrawnPart, drawn_part

__all__ = ["MovingHead", "poses_at"]

MARGIN_PIXELS = 8
FINER = 2
"""Drawn at twice the size and averaged: smoother inside the head too, and quicker in software than VTK's own
multisampling (75 against 97 ms a picture of 1280 x 720)."""


def poses_at(
    times_s: npt.ArrayLike, vertices_mm: npt.NDArray[np.float32], wanted_s: npt.ArrayLike
) -> list[FloatArray]:
    """Return the vertices at any times, linearly between frames and held before the first and after the last.

    Parameters
    ----------
    times_s : (n_frames,), s
    vertices_mm : (n_frames, n_vertices, 3), mm
    wanted_s : (n,), s
    """
    times = np.asarray(times_s, float)
    place = np.interp(np.asarray(wanted_s, float), times, np.arange(len(times)))
    poses = []
    for at in place:
        low = int(at)
        share = at - low
        pose = np.asarray(vertices_mm[low], float)
        if share > 1e-9:
            pose = (1 - share) * pose + share * vertices_mm[low + 1]
        poses.append(pose)
    return poses


class _Shown:
    """One actor of the plotter and the part that it shows."""

    def __init__(self, actor: Any, part: DrawnPart) -> None:
        self.part = part
        self.surface = actor.mapper.dataset.copy()
        if self.part.colours is not None:
            self.surface.set_active_scalars("colour")  # else normals of the last part are colours
        actor.mapper.SetInputData(self.surface)  # ours: pyvista may put a filter before the mapper

    def show(self, vertices_mm: FloatArray) -> None:
        points = self.part.points_mm(vertices_mm)
        self.surface.points[:] = points  # in place: the mapper draws these very arrays
        self.surface.point_data["Normals"][:] = self.part.normals(points)
        for array in (self.surface.GetPoints(), self.surface.GetPointData().GetNormals(), self.surface):
            array.Modified()


class MovingHead:
    """Pictures of a mesh in many poses, off-screen; a context manager.

    Only the middle of the picture, as far as the head can reach, is drawn.

    Parameters
    ----------
    mesh : Mesh
    poses_mm : (n_poses, n_vertices, 3), mm
        All poses that will be drawn, or poses that reach as far.
    size : (int, int)
        Width and height of the pictures, pixels.
    options
        View and zoom, as for :func:`~corpus_tools.render.scene.scene`.

    Raises
    ------
    MissingExtraError
        This machine cannot draw off-screen; the sentence names the package.
    """

    def __init__(
        self, mesh: Mesh, poses_mm: npt.ArrayLike, *, size: tuple[int, int] = (1280, 720), **options: Any
    ) -> None:
        self.mesh, self.size = mesh, size
        self.plotter = scene(mesh, size=size, **options)
        self.shown = [_Shown(self.plotter.actors[n], drawn_part(mesh, n)) for n in mesh.part_names]
        poses = np.asarray(poses_mm).reshape(-1, 3)
        corners = np.array(list(itertools.product(*zip(poses.min(axis=0), poses.max(axis=0), strict=True))))
        across = self.on_screen(corners)[:, 0]
        reach = np.abs(across - size[0] / 2).max() if np.isfinite(across).all() else np.inf
        self.margin = int(max(0.0, size[0] / 2 - reach - MARGIN_PIXELS))
        self.plotter.render_window.SetMultiSamples(0)
        self.plotter.window_size = [FINER * (size[0] - 2 * self.margin), FINER * size[1]]

    def __enter__(self) -> MovingHead:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.plotter.close()

    def draw(self, vertices_mm: npt.ArrayLike) -> npt.NDArray[np.uint8]:
        """Return the picture of a pose, (height, width, 3)."""
        vertices = with_level_neck(self.mesh, vertices_mm)
        for part in self.shown:
            part.show(vertices)
        self.plotter.reset_camera_clipping_range()
        self.plotter.render_window.Render()
        fine = np.ascontiguousarray(np.asarray(self.plotter.screenshot(return_img=True))[..., :3])
        middle = np.asarray(Image.fromarray(fine).reduce(FINER))
        return np.pad(middle, ((0, 0), (self.margin, self.margin), (0, 0)), mode="edge")

    def on_screen(self, points_mm: npt.ArrayLike) -> FloatArray:
        """Return where points are in the picture, (n, 2) pixels from its upper left corner."""
        points = np.asarray(points_mm, float).reshape(-1, 3)
        width, height = self.size
        matrix = self.plotter.camera.GetCompositeProjectionTransformMatrix(width / height, -1, 1)
        m = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])
        clip = np.column_stack([points, np.ones(len(points))]) @ m.T
        device = clip[:, :2] / clip[:, 3:]
        return np.column_stack([0.5 * (device[:, 0] + 1) * width, 0.5 * (1 - device[:, 1]) * height])
