"""The strip of frames: phones spread over the sentence, paths of the right vertices, SVG and PNG alike."""

import io
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from PIL import Image

from corpus_tools.config import Config, config_with
from corpus_tools.core import Interval, Mesh, MeshError
from corpus_tools.mesh import CHARACTERS, bundled_head
from corpus_tools.pipeline import prepare_head, synthesise
from corpus_tools.render.drawing import Drawing
from corpus_tools.render.strip import chosen_phones, strip_drawing, tracked_vertices

SVG = "{http://www.w3.org/2000/svg}"


def phones(*texts):
    return [Interval(0.1 * k, 0.1 * (k + 1), text) for k, text in enumerate(texts)]


def test_phones_are_spread_and_each_is_the_most_unlike_of_its_part():
    row = phones("SIL", "A", "M", "I", "S", "O", "B", "SIL")
    opening = {"A": 9.0, "M": 0.0, "I": 4.0, "S": 3.0, "O": 8.0, "B": 0.1}

    def aperture(time_s):
        return next(opening[p.text] for p in row if p.start_s <= time_s < p.end_s)

    assert [p.text for p in chosen_phones(row, 3, "SIL", aperture)] == ["A", "I", "O"]
    assert [p.text for p in chosen_phones(row, 2, "SIL", aperture)] == ["A", "O"]
    assert [p.text for p in chosen_phones(row, 6, "SIL", aperture)] == ["A", "M", "I", "S", "O", "B"]
    assert len(chosen_phones(row, 16, "SIL", aperture)) == 6
    assert chosen_phones(phones("SIL"), 4, "SIL", lambda t: 0.0) == phones("SIL")


@pytest.mark.parametrize("character", list(CHARACTERS))
def test_tracked_vertices_are_where_their_names_say(character):
    mesh = bundled_head(character)
    at = {name: mesh.vertices_mm[v] for name, v in tracked_vertices(mesh).items()}
    assert at["upper lip"][1] > at["lower lip"][1] > at["chin"][1]
    for name in ("upper lip", "lower lip", "chin"):
        assert abs(at[name][0]) < 0.2 * at["corner"][0]


def test_a_mesh_without_lip_markers_is_refused():
    mesh = Mesh("bare", np.eye(3), np.array([[0, 1, 2]]), np.zeros(3, np.int8))
    with pytest.raises(MeshError, match="'bare' has 0 markers on the outer lips"):
        tracked_vertices(mesh)


def test_a_drawing_is_the_same_as_svg_and_png():
    drawing = Drawing(60, 40, "lines & <marks>")
    drawing.line([(5, 10), (55, 10)], "#ff0000", 4)
    drawing.line([(5, 20), (55, 20)], "#0000ff", 4, dashed=True)
    drawing.picture(10, 26, 8, 8, np.full((4, 4, 3), (0, 128, 0), np.uint8))
    drawing.text(40, 30, "M", 12)
    drawing.text(52, 30, "up", 8, upright=True)
    tree = ET.fromstring(drawing.svg())
    assert tree.find(f"{SVG}title").text == "lines & <marks>"
    assert len(tree.findall(f"{SVG}polyline")) == 2
    assert [t.text for t in tree.findall(f"{SVG}text")] == ["M", "up"]
    image = np.asarray(Image.open(io.BytesIO(drawing.png(2)))).astype(int)
    assert image.shape == (80, 120, 3)
    assert (image[20, 20:100] == [255, 0, 0]).all()
    blue = (image[40, 10:110] == [0, 0, 255]).all(axis=1)
    assert 0.4 < blue.mean() < 0.8
    assert (image[60, 28] == [0, 128, 0]).all()
    assert (image[52:68, 72:88].min(axis=2) < 100).any()
    assert (image[50:70, 98:112].min(axis=2) < 100).any()


def test_the_figure_names_its_axes_and_draws_what_was_synthesised(offscreen, opened_corpus):
    config = config_with(Config(), alignment__rate_hz=60.0)
    head = prepare_head(opened_corpus, "base", config)
    target = min((r.utterance for r in opened_corpus.recordings), key=lambda u: u.duration_s)
    made = synthesise(opened_corpus, target, config, head, (target.name,))
    shown = chosen_phones(target.phones.intervals, 2, "SIL", lambda t: t)
    tree = ET.fromstring(strip_drawing(made, head, config, shown, lambda f, w: None).svg())
    texts = [t.text for t in tree.findall(f"{SVG}text")]
    assert {"time (s)", "up (mm)", "forward (mm)", "phones", "upper lip", "lower lip", "chin"} <= set(texts)
    assert [f"{p.text}   {p.centre_s:.2f} s" for p in shown] == [t for t in texts if t.endswith(" s")]
    assert len(tree.findall(f"{SVG}image")) == 2
    curves = [p for p in tree.findall(f"{SVG}polyline") if p.get("stroke-width") == "1.7"]
    assert len(curves) == 8
    lower = np.array([[float(c) for c in p.split(",")] for p in curves[1].get("points").split()])
    height = made.vertices_mm[:, tracked_vertices(head.mesh)["lower lip"], 1]
    assert np.corrcoef(lower[:, 1], height)[0, 1] < -0.9999
    assert (np.diff(lower[:, 0]) > 0).all()
