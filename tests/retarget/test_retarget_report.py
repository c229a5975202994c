"""The evidence on a retarget counts folds and places outside where they were made."""

import numpy as np
import pytest

from corpus_tools.mesh import bundled_head
from corpus_tools.retarget import choose_smoothing, prepare_retarget, retarget_report

NAMES = tuple(bundled_head().markers)


def ready(smoothing):
    male, base = bundled_head("male"), bundled_head("base")
    return prepare_retarget(
        male.vertices_mm[[male.markers[n] for n in NAMES]], NAMES, base, smoothing=smoothing
    )


@pytest.fixture(scope="module")
def exact():
    return ready(0.0)


def test_at_rest_an_exact_warp_misses_nothing_and_leaves_nothing_out(exact):
    found = retarget_report(exact, np.repeat(exact.neutral_mm[None], 700, axis=0))
    assert found.residual_most_mm < 1e-6
    assert found.outside == 0.0
    assert 0 < found.points <= 300 * len(NAMES)
    assert found.folded == found.points // len(NAMES) * exact.folds().n_folded
    assert found.least_det == pytest.approx(exact.folds().least_det)


def test_the_share_outside_is_that_of_the_markers_that_left(exact):
    frame = exact.neutral_mm.copy()
    gone = [NAMES.index(n) for n in ("chin1", "chin4", "nose2")]
    frame[gone] += [0.0, 0.0, 400.0]
    assert retarget_report(exact, frame[None]).outside == pytest.approx(3 / len(NAMES))


def test_smoothing_leaves_a_residual_where_it_is_most():
    smooth = ready(1.0)
    found = retarget_report(smooth, smooth.neutral_mm[None])
    away = np.linalg.norm(smooth.warp(smooth.neutral_mm) - smooth.rest_mm, axis=1)
    assert found.residual_most_mm == pytest.approx(away.max())
    assert found.residual_marker == NAMES[int(away.argmax())]
    assert 0 < found.residual_rms_mm < found.residual_most_mm


def test_a_fold_is_counted():
    neutral = ready(0.0).neutral_mm
    base = bundled_head()
    swapped = neutral.copy()
    a, b = NAMES.index("nose1"), NAMES.index("lip_out3")
    swapped[[a, b]] = swapped[[b, a]]
    folded = prepare_retarget(swapped, NAMES, base, smoothing=0.0)
    assert retarget_report(folded, swapped[None]).folded > 0


def test_auto_takes_what_misses_left_out_landmarks_least(exact):
    auto = ready("auto")
    assert auto.warp.smoothing == choose_smoothing(exact.neutral_mm, exact.rest_mm)
    least = retarget_report(auto, exact.neutral_mm[None]).left_out_rms_mm
    for other in (exact, ready(1e-1)):
        assert least <= retarget_report(other, exact.neutral_mm[None]).left_out_rms_mm
