"""Upper-face markers that hardly move help to find the head; those that move, or are often hidden, do not."""

from __future__ import annotations

import numpy as np
from strategies.talking import FACE, HEAD, talk, with_head_motion

from corpus_tools.cleaning import clean_captures, reference_shape
from corpus_tools.cleaning.head_support import supporting_columns
from corpus_tools.core import Capture

NAMES = (*HEAD, *FACE)
COLUMNS = [NAMES.index(n) for n in HEAD]
STEADY = [NAMES.index(n) for n in ("brow0", "nose5", "cheek0", "cheek1")]
LIPS = [NAMES.index(n) for n in NAMES if n.startswith(("lip", "chin"))]


def spoken(n=6, slip_mm=0.0):
    """Return recordings with the head moving, and where their markers truly were; some jigs slip half way."""
    rng = np.random.default_rng(1)
    made, truth = [], []
    for index, recording in enumerate(talk(n)):
        still = np.array(recording.capture.positions_mm)
        truth.append(still.copy())
        if index % 2:
            still[len(still) // 2 :, : len(HEAD)] += slip_mm * np.array([0.3, 0.8, 0.5])
        still += rng.normal(0, 0.1, still.shape)
        made.append(with_head_motion(Capture(still, recording.capture.rate_hz, NAMES), rng))
    return made, truth


def changed(captures, change):
    return [Capture(change(np.array(c.positions_mm)), c.rate_hz, c.names) for c in captures]


def support(captures, **options):
    reference = reference_shape(captures, COLUMNS, False)
    return supporting_columns(captures, reference, COLUMNS, False, **options)


def test_markers_that_stay_on_the_head_are_found_and_lips_and_chin_never():
    captures, _ = spoken()
    assert support(captures) == STEADY
    assert support(captures, steady_mm=1e-6) == []
    assert support(captures, steady_mm=1e6) == STEADY


def test_a_brow_that_moves_does_not_support():
    captures, _ = spoken()
    brow = NAMES.index("brow0")

    def raised(positions):
        positions[10:40, brow] += [0, 5, 0]
        return positions

    assert support(changed(captures, raised)) == [i for i in STEADY if i != brow]


def test_a_marker_that_is_often_hidden_does_not_support():
    captures, _ = spoken()
    nose = NAMES.index("nose5")

    def hidden(positions):
        positions[::10, nose] = np.nan
        return positions

    assert support(changed(captures, hidden)) == [i for i in STEADY if i != nose]


def error(captures, truth, head_support):
    """Return the rms error of lips and chin after one rotation for all recordings, mm."""
    cleaned = clean_captures(captures, COLUMNS, allow_scale=False, head_support=head_support)
    made = np.concatenate([c.positions_mm[:, LIPS].reshape(-1, 3) for c in cleaned.captures])
    wanted = np.concatenate([t[:, LIPS].reshape(-1, 3) for t in truth])
    a, b = made - made.mean(axis=0), wanted - wanted.mean(axis=0)
    u, _, v = np.linalg.svd(a.T @ b)
    return float(np.sqrt(((a @ (u @ v) - b) ** 2).sum(axis=1).mean()))


def test_a_slipping_jig_moves_the_mouth_less():
    captures, truth = spoken(slip_mm=1.5)
    alone, supported = error(captures, truth, False), error(captures, truth, True)
    assert supported < 0.75 * alone
    assert supported < 0.6


def test_a_jig_that_is_exact_loses_little():
    """Every marker of this face lies 0.7 mm off from recording to recording; the jig is known to 0.1 mm."""
    captures, truth = spoken()
    assert error(captures, truth, True) < error(captures, truth, False) + 0.15


def test_where_nothing_is_steady_the_head_markers_stay_alone():
    captures, _ = spoken()

    def shaken(positions):
        positions[:, len(HEAD) :] += np.random.default_rng(3).normal(0, 3, positions[:, len(HEAD) :].shape)
        return positions

    moved = changed(captures, shaken)
    with_help, alone = (
        clean_captures(moved, COLUMNS, allow_scale=False, head_support=on) for on in (True, False)
    )
    for a, b in zip(with_help.captures, alone.captures, strict=True):
        np.testing.assert_array_equal(a.positions_mm, b.positions_mm)
        assert dict(a.history[0].settings)["markers"] == ",".join(HEAD)
