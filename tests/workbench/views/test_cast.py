"""Several heads in one view: beside one another, faces at one height, each with the motion of its own."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from corpus_tools.mesh import CHARACTERS, bundled_head
from workbench.state import Session, Stages
from workbench.views.cast import cast_camera, cast_places
from workbench.views.face import Face


def test_heads_do_not_overlap_and_faces_are_at_one_height():
    meshes = [bundled_head(name) for name in CHARACTERS]
    edges, heights = [], []
    for mesh, place in zip(meshes, cast_places(meshes), strict=True):
        skin = mesh.vertices_mm[mesh.part_mask("skin")] + place[:3, 3]
        marked = mesh.vertices_mm[list(mesh.markers.values())] + place[:3, 3]
        edges.append((skin[:, 0].min(), skin[:, 0].max()))
        heights.append(0.5 * (marked[:, 1].min() + marked[:, 1].max()))
    assert all(a[1] < b[0] for a, b in itertools.pairwise(edges))
    assert np.ptp(heights) < 1e-6
    camera = cast_camera(meshes)
    distance = np.linalg.norm(np.subtract(camera["position"], camera["focal_point"]))
    wide = 1.3 * 2 * distance * np.tan(np.radians(camera["view_angle"] / 2))
    assert wide >= edges[-1][1] - edges[0][0]


@pytest.mark.slow
def test_each_head_speaks_the_same_motion_as_its_own_face_does(opened):
    session, stages = Session(), Stages()
    session.opened(opened)
    result = stages.run(session.request())
    child = stages.on_head(result, "child")
    assert child.trajectory is result.trajectory
    face = Face(clock="cast", theme="light")
    face.show(result)
    alone, camera = len(face.mesh_view.actors), dict(face.mesh_view.camera)
    face.show_cast((child,))
    names = [a["name"] for a in face.mesh_view.actors]
    assert len(names) == 2 * alone
    tracks = face.mesh_view.motion["tracks"]
    values = {name: t["values"] for t in tracks if t["kind"] == "deform" for name in t["actors"]}
    for name, spoken in (("skin", result), ("child/skin", child)):
        mesh, targets_mm = spoken.head.mesh, spoken.animation.targets_mm
        rest_mm = mesh.vertices_mm[[mesh.markers[n] for n in spoken.head.names]]
        assert values[name] == (targets_mm - rest_mm).astype(np.float32).tobytes()
    assert values["skin"] != values["child/skin"]
    elsewhere = replace(child, request=replace(child.request, sentence="another"))
    face.show_cast((elsewhere,))
    assert "child/skin" not in {a for t in face.mesh_view.motion["tracks"] for a in t["actors"]}  # it rests
    face.show_cast(())
    assert len(face.mesh_view.actors) == alone
    assert face.mesh_view.camera == camera
