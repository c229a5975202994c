"""What real captures show is left as it is: rates of flags, above all on lips that speak."""

from dataclasses import replace

import numpy as np
import pytest

from corpus_tools.cleaning import (
    face_model,
    find_outliers,
    find_slips,
    reference_shape,
    remove_head_motion,
    usual_spread_mm,
)
from corpus_tools.io import read_markers


def looked_through(captures, columns):
    model = face_model(captures)
    spread = usual_spread_mm(captures, model)
    outliers = [find_outliers(c, model, spread) for c in captures]
    return outliers, [find_slips(c, model, columns) for c in captures]


def still(captures, prefix, allow_scale):
    columns = [i for i, n in enumerate(captures[0].names) if n.lower().startswith(prefix)]
    reference = reference_shape(captures, columns, allow_scale)
    return [remove_head_motion(c, reference, columns, allow_scale)[0] for c in captures], columns


def per_million(outliers, captures):
    seen = sum(np.isfinite(c.positions_mm).all(axis=2).sum() for c in captures)
    return 1e6 * sum(o.doubted.sum() for o in outliers) / seen


def test_lips_that_speak_are_never_flagged(corpora):
    """203 sentences at 25 frames a second: a few blinks count as spikes (13 of 1.1 million samples)."""
    captures = [read_markers(f) for f in sorted((corpora / "grid_s1" / "markers73").glob("*.npz"))]
    captures, columns = still(captures, "head", True)
    outliers, slips = looked_through(captures, columns)
    mouth = [i for i, r in enumerate(captures[0].regions) if r in ("lip_out", "lip_in", "chin", "cheek")]
    assert sum(o.doubted[:, mouth].sum() for o in outliers) == 0
    assert per_million(outliers, captures) < 25
    assert sum(len(o.swaps) for o in outliers) == 0
    assert sum(len(s) for s in slips) <= 3


@pytest.mark.parametrize("name", ["Jaw", "Cheeks", "Eyebrows", "Nose"])
def test_faces_that_are_moved_on_purpose_are_hardly_flagged(corpora, name):
    capture = read_markers(corpora / "animface_mocap" / f"{name}MoCap.npz")
    captures, columns = still([capture], "forehead", False)
    outliers, slips = looked_through(captures, columns)
    assert per_million(outliers, captures) < 400
    assert outliers[0].swaps == ()
    assert slips == [()]


def test_a_rigid_box_in_a_capture_with_gaps(corpora):
    capture = read_markers(corpora / "pyomeca_c3d" / "markers_analogs.c3d")
    captures, columns = still([capture], "boite", False)
    outliers, _ = looked_through(captures, columns)
    assert per_million(outliers, captures) < 1500
    assert outliers[0].swaps == ()


@pytest.mark.parametrize("name", ["Subject_01", "Subject_02"])
def test_posed_faces_between_long_gaps(corpora, name):
    """Their file has no unit: the face is made 130 mm wide."""
    capture = read_markers(corpora / "blenderface" / f"{name}.csv", rate_hz=30.0)
    positions = np.asarray(capture.positions_mm)
    capture = replace(
        capture, positions_mm=positions * 130.0 / np.ptp(np.nanmedian(positions[..., 0], axis=0))
    )
    outliers, _ = looked_through([capture], [])
    assert per_million(outliers, [capture]) < 3000, per_million(outliers, [capture])
