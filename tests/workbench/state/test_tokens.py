"""The tokens: texts keep their contrast and classes their distance, in both themes."""

import itertools

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from workbench.state import THEMES, css_variables, source_slots, tokens

# Machado, Oliveira & Fernandes 2009, full severity, on linear RGB
VISIONS = {
    "normal": np.eye(3),
    "protan": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deutan": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritan": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}


def linear(colour: str) -> np.ndarray:
    s = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return np.where(s <= 0.04045, s / 12.92, ((s + 0.055) / 1.055) ** 2.4)


def contrast(a: str, b: str) -> float:
    weights = np.array([0.2126, 0.7152, 0.0722])
    low, high = sorted((float(weights @ linear(a)), float(weights @ linear(b))))
    return (high + 0.05) / (low + 0.05)


def oklab(rgb: np.ndarray) -> np.ndarray:
    m1 = np.array(
        [
            [0.4122214708, 0.5363325363, 0.0514459929],
            [0.2119034982, 0.6806995451, 0.1073969566],
            [0.0883024619, 0.2817188376, 0.6299787005],
        ]
    )
    m2 = np.array(
        [
            [0.2104542553, 0.7936177850, -0.0040720468],
            [1.9779984951, -2.4285922050, 0.4505937099],
            [0.0259040371, 0.7827717662, -0.8086757660],
        ]
    )
    return m2 @ np.cbrt(m1 @ np.clip(rgb, 0, 1))


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize("ink", ["ink", "ink2", "ink3", "acc", "warn", "err", "ok", "cursor"])
@pytest.mark.parametrize("ground", ["panel", "sunk"])
def test_text_contrast_is_at_least_4_5(theme, ink, ground):
    c = tokens(theme).colours
    assert contrast(c[ink], c[ground]) >= 4.5


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize(
    ("ink", "ground"),
    [
        ("warn", "warn_ground"),
        ("err", "err_ground"),
        ("ok", "ok_ground"),
        ("acc", "acc_ground"),
        ("acc_ink", "acc"),
    ],
)
def test_text_on_its_own_ground(theme, ink, ground):
    c = tokens(theme).colours
    assert contrast(c[ink], c[ground]) >= 4.5


@pytest.mark.parametrize("theme", THEMES)
def test_phone_classes_differ_under_four_visions(theme):
    colours = [linear(c) for name, c in tokens(theme).phone_classes.items() if name != "silence"]
    for matrix in VISIONS.values():
        seen = [oklab(np.asarray(matrix) @ c) for c in colours]
        nearest = min(np.linalg.norm(a - b) for a, b in itertools.combinations(seen, 2))
        assert nearest >= 0.08


@pytest.mark.parametrize("theme", THEMES)
def test_every_token_becomes_a_css_variable(theme):
    text = css_variables(theme)
    t = tokens(theme)
    for name, value in {**t.colours, **t.sources}.items():
        assert f"--vsw-{name.replace('_', '-')}: {value};" in text
    assert f"--vsw-rail: {t.sizes['rail']}px;" in text
    assert f"color-scheme: {theme};" in text


@given(st.lists(st.sampled_from("abcdefghij"), max_size=30))
@example(list("abcdefga"))
def test_neighbouring_sources_never_share_a_colour(names):
    slots = source_slots(tuple(names))
    assert len(slots) == len(names)
    for (a, slot_a), (b, slot_b) in itertools.pairwise(zip(names, slots, strict=True)):
        assert (slot_a == slot_b) == (a == b)


def test_a_source_keeps_its_colour():
    assert source_slots(("a", "b", "a", "c", "a")) == (0, 1, 0, 2, 0)
