"""Marker motion in C3D files: a residual below 0 is missing; units and rate come from the file."""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from corpus_tools.core import BoolArray, Capture, FloatArray, MotionError, atomic_file
from corpus_tools.io.c3d_layout import C3dHeader, Parameters, c3d_header, c3d_parameters, c3d_points
from corpus_tools.io.formats import MOTION_READERS, MOTION_WRITERS
from corpus_tools.io.motion_parts import Notes, capture_of, chosen_rate, unit_factor
from corpus_tools.io.writing import checked_motion

__all__ = ["read_c3d", "write_c3d"]

_EXPECTED = "a C3D file with labelled points was expected; export it again"
_DERIVED = ("ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS", "REACTIONS")
_FULL = 65535
_LABEL_BYTES = 120


@MOTION_READERS.register(".c3d")
def read_c3d(path: Path, *, rate_hz: float | None = None, units: str = "") -> Capture:
    """Read the labelled points of a C3D file; analog channels are left alone.

    Parameters
    ----------
    path : Path
    rate_hz, units
        As in :func:`~corpus_tools.io.formats.read_markers`. Unlabelled points (``*12``) and what a model
        derived (angles, forces) are left out and counted in the history. Axes stay as in the file; the
        history says which are ``right`` and ``up`` on its screen, when the file does.

    Raises
    ------
    MotionError
        It is no C3D file, is cut short, holds no points or does not say its unit.
    """
    data = path.read_bytes()
    notes: Notes = []
    try:
        header = c3d_header(data)
        parameters = c3d_parameters(data, header)
        n_frames = _frame_count(header, parameters, notes)
        positions, missing = c3d_points(
            data,
            header,
            n_frames,
            _number(parameters, "POINT:SCALE", header.scale),
            int(_number(parameters, "POINT:DATA_START", header.data_block)) % (_FULL + 1),
        )
    except MotionError as error:
        raise MotionError(f"'{path}' cannot be read as C3D: {error}; {_EXPECTED}.") from None
    factor = unit_factor(path, _text(parameters, "POINT:UNITS"), units, notes)
    rate = chosen_rate(path, _rate(header, parameters, notes), rate_hz, notes)
    positions = np.where(missing[:, :, None], np.nan, positions * factor)
    names, derived = _labels(parameters, header.n_points)
    keep = [i for i in range(header.n_points) if i not in derived]
    return capture_of(
        path,
        positions[:, keep],
        [names[i] for i in keep],
        rate,
        format="c3d",
        notes=notes,
        **_facts(parameters, len(derived)),
    )


def _number(parameters: Parameters, key: str, other: float) -> float:
    """Return a numeric parameter, or `other` when it is absent or no number."""
    value = parameters.get(key) or [other]
    return value[0] if isinstance(value[0], float) and np.isfinite(value[0]) and value[0] else other


def _text(parameters: Parameters, key: str) -> str:
    value = parameters.get(key) or [""]
    return value[0] if isinstance(value[0], str) else ""


def _rate(header: C3dHeader, parameters: Parameters, notes: Notes) -> float:
    rate = _number(parameters, "POINT:RATE", header.rate_hz)
    if abs(rate - header.rate_hz) > 1e-3 * abs(rate):
        notes.append(f"the header says {header.rate_hz:g} Hz, POINT:RATE says {rate:g} Hz, which is used.")
    return rate


def _frame_count(header: C3dHeader, parameters: Parameters, notes: Notes) -> int:
    """Return the number of frames; the header counts to 65535 only, longer files say it in parameters."""
    if not header.n_points:
        raise MotionError("it holds no points, only analog channels or nothing")
    stated = int(_number(parameters, "POINT:FRAMES", 0.0)) % (_FULL + 1)
    if header.last_frame == _FULL or header.n_frames < 1:
        ends = [parameters.get(f"TRIAL:ACTUAL_{w}_FIELD", []) for w in ("START", "END")]
        pairs = [[float(v) for v in e[:2]] for e in ends if len(e) >= 2 and not isinstance(e[0], str)]
        if len(pairs) == 2:
            first, last = (int(a) % (_FULL + 1) + int(b) % (_FULL + 1) * (_FULL + 1) for a, b in pairs)
            if last >= first:
                return last - first + 1
        long = _number(parameters, "POINT:LONG_FRAMES", 0.0)
        if long >= 1:
            return int(long)
    if header.n_frames < 1 or not (header.last_frame or header.first_frame or stated):
        raise MotionError(f"it holds no frames (first {header.first_frame}, last {header.last_frame})")
    if stated and stated != header.n_frames:
        notes.append(f"the header says {header.n_frames} frames, which are read; POINT:FRAMES says {stated}.")
    return header.n_frames


def _all_texts(parameters: Parameters, key: str) -> list[str]:
    """Return a list of texts with its continuations: LABELS, LABELS2, LABELS3 (255 entries each)."""
    pattern = re.compile(re.escape(key) + r"(\d*)")
    found = [(int(m[1] or 1), v) for k, v in parameters.items() if (m := pattern.fullmatch(k))]
    return [t for _, value in sorted(found, key=lambda f: f[0]) for t in value if isinstance(t, str)]


def _labels(parameters: Parameters, n_points: int) -> tuple[list[str], set[int]]:
    """Return a label for every point, blank where there is none, and which points are no positions."""
    labels = (_all_texts(parameters, "POINT:LABELS") + [""] * n_points)[:n_points]
    derived = {name for kind in _DERIVED for name in _all_texts(parameters, f"POINT:{kind}") if name}
    return labels, {i for i, name in enumerate(labels) if name in derived}


def _facts(parameters: Parameters, n_derived: int) -> dict[str, str]:
    facts = {"derived_left_out": f"{n_derived} angles, forces or powers"} if n_derived else {}
    for key, word in (("POINT:X_SCREEN", "right"), ("POINT:Y_SCREEN", "up")):
        axis = _text(parameters, key).strip("+").lower()
        if axis.strip("-") in ("x", "y", "z"):
            facts[word] = axis
    return facts


@MOTION_WRITERS.register("c3d")
def write_c3d(path: str | Path, positions_mm: FloatArray, names: Sequence[str], rate_hz: float) -> None:
    """Write marker motion as C3D: float32 mm, y up, missing points with residual -1; the same bytes always.

    Raises
    ------
    MotionError
        The arrays are no motion, or a name cannot stand in a C3D file.
    OutputError
        The file cannot be written.
    """
    import ezc3d  # type: ignore[import-untyped]  # 50 ms: only when something is written

    positions, labels = checked_motion(path, positions_mm, names, rate_hz)
    for name in labels:
        if len(name.encode()) > _LABEL_BYTES or name.startswith("*") or "\0" in name:
            raise MotionError(
                f"Cannot write '{path}': the marker name '{name[:40]}' cannot stand in a C3D file (at most "
                f"{_LABEL_BYTES} bytes, not beginning with *); rename it."
            )
    missing: BoolArray = np.asarray(np.isnan(positions).any(axis=2))
    points = np.ones((4, len(labels), len(positions)))
    points[:3] = np.where(missing[:, :, None], np.nan, positions).transpose(2, 1, 0)
    file = ezc3d.c3d()
    point = file["parameters"]["POINT"]
    point["UNITS"]["value"], point["RATE"]["value"], point["LABELS"]["value"] = ["mm"], [rate_hz], labels
    file.add_parameter("POINT", "X_SCREEN", "+X")
    file.add_parameter("POINT", "Y_SCREEN", "+Y")
    file["data"]["points"] = points
    file["data"]["meta_points"]["residuals"] = np.where(missing, -1.0, 0.0).T[None]
    with atomic_file(path) as temporary, tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "motion.c3d"  # ezc3d writes to names with this suffix alone
        file.write(str(made))
        shutil.copyfile(made, temporary)
