"""What cleaning did to a corpus, in numbers: gaps, outliers, slips, head motion, noise, timing."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from corpus_tools.cleaning import CleanedCorpus, HeadMotion, marker_gaps, measurement_sd_mm
from corpus_tools.core import Capture, FrameFlag, atomic_folder, counted
from corpus_tools.pipeline.cleaning_page import cleaning_page, found_in
from corpus_tools.pipeline.lacking import offset_advice
from corpus_tools.pipeline.reading import Progress, RawCorpus, silent
from corpus_tools.speech import closure_offset

__all__ = ["cleaning_lines", "cleaning_report", "write_cleaning"]

DIGITS = 4


def _round(value: float) -> float | None:
    return round(float(value), DIGITS) if np.isfinite(value) else None


def _head(motion: HeadMotion) -> dict[str, Any]:
    known = motion.residual_mm[motion.fitted]
    return {
        "residual_median_mm": _round(np.median(known)),
        "residual_largest_mm": _round(known.max()),
        "residual_largest_frame": int(np.nanargmax(motion.residual_mm)),
        "scale_median": _round(np.median(motion.scale[motion.fitted])),
        "frames_without_fit": int((~motion.fitted).sum()),
        "residual_mm": [_round(r) for r in motion.residual_mm],
    }


def _gaps(raw: Capture, clean: Capture) -> dict[str, Any]:
    flags = clean.flags
    assert flags is not None
    runs = [run for found in marker_gaps(raw).values() for run in found]
    fillers = [s.as_dict().get("gaps", "") for s in clean.history if s.name == "fill_gaps"]
    return {
        "gaps": len(runs),
        "longest_gap_s": _round(max((b - a + 1 for a, b in runs), default=0) / raw.rate_hz),
        "fillers": ", ".join(str(f) for f in fillers if f),
        "filled_samples": int(((flags & FrameFlag.FILLED) > 0).sum()),
        "doubtful_samples": int(((flags & FrameFlag.DOUBTFUL) > 0).sum()),
        "flagged_by_frame": [_round(v) for v in clean.flagged.mean(axis=1)],
    }


def _row(name: str, raw: Capture, cleaned: CleanedCorpus, index: int) -> dict[str, Any]:
    clean, outliers = cleaned.captures[index], cleaned.outliers[index]
    sd_mm = cleaned.sd_mm[index]
    flags = clean.flags
    assert flags is not None
    filled = (flags & FrameFlag.FILLED) > 0
    noise = measurement_sd_mm(cleaned.head_motion[index].stabilise(raw.positions_mm))
    swaps = [] if outliers is None else outliers.swaps
    return {
        "id": name,
        "n_frames": clean.n_frames,
        "rate_hz": clean.rate_hz,
        **_gaps(raw, clean),
        "spikes": 0 if outliers is None else int(outliers.spiked.sum()),
        "swaps": [{"first": a, "last": b, "markers": [raw.names[i], raw.names[j]]} for a, b, i, j in swaps],
        "slips": [
            {
                "marker": "head" if s.marker < 0 else raw.names[s.marker],
                "frame": s.frame,
                "time_s": _round(clean.times_s[s.frame]),
                "size_mm": _round(s.size_mm),
            }
            for s in cleaned.slips[index]
        ],
        "noise_mm": _round(np.median(noise[noise > 0])) if (noise > 0).any() else 0.0,
        "filled_sd_largest_mm": _round(sd_mm[filled].max()) if filled.any() else 0.0,
        "head": _head(cleaned.head_motion[index]),
    }


def cleaning_report(raw: RawCorpus, cleaned: CleanedCorpus, progress: Progress = silent) -> dict[str, Any]:
    """Return what cleaning found and did, by recording and in all; worst recordings first.

    The offset between sound and motion is estimated (from lip closures against the phones) and shown; it is
    never applied: ``advice`` has the line of corpus.toml that would.

    Parameters
    ----------
    raw : RawCorpus
    cleaned : CleanedCorpus
        From :func:`~corpus_tools.pipeline.reading.clean_corpus` of the same recordings.
    progress : callable
        ``progress(fraction, what)``; may raise to cancel.
    """
    rows = []
    for index, (name, capture) in enumerate(zip(raw.names, raw.captures, strict=True)):
        progress(0.8 * index / len(raw.names), f"describing {name}")
        rows.append(_row(name, capture, cleaned, index))
    progress(0.8, "closures against the sound")
    offset = closure_offset(cleaned.captures, raw.utterances, raw.phones)
    rows.sort(key=lambda r: (-_badness(r), r["id"]))
    return {
        "corpus": raw.description.name,
        "summary": {
            "recordings": len(rows),
            "frames": sum(r["n_frames"] for r in rows),
            "gaps": sum(r["gaps"] for r in rows),
            "filled_samples": sum(r["filled_samples"] for r in rows),
            "doubtful_samples": sum(r["doubtful_samples"] for r in rows),
            "spikes": sum(r["spikes"] for r in rows),
            "swaps": sum(len(r["swaps"]) for r in rows),
            "slips": sum(len(r["slips"]) for r in rows),
            "head_residual_median_mm": _round(np.median([r["head"]["residual_median_mm"] for r in rows])),
            "head_scale_sd": _round(cleaned.scale_sd),
        },
        "audio_offset_s": None if offset is None else _round(round(offset, 3) + 0.0),
        "audio_offset_applied_s": raw.description.audio_offset_s,
        "advice": offset_advice(raw.description, offset, raw.captures[0].rate_hz),
        "skipped": raw.skipped,
        "recordings": rows,
    }


def _badness(row: dict[str, Any]) -> float:
    return float(row["doubtful_samples"] + row["spikes"] + 100 * (len(row["swaps"]) + len(row["slips"])))


def cleaning_lines(report: dict[str, Any]) -> list[str]:
    """Return a report as lines for people."""
    s, offset = report["summary"], report["audio_offset_s"]
    lines = [
        f"{report['corpus']}: {counted(s['recordings'], 'recording')}; {found_in(s)}.",
        f"Head: residual {s['head_residual_median_mm']:.2f} mm (median), scale spread "
        f"{100 * (s['head_scale_sd'] or 0):.2f} %.",
    ]
    if offset is not None:
        lines.append(
            f"Sound and motion: lips close best when the motion is moved by {1000 * offset + 0.0:.0f} ms "
            "(not applied)."
        )
    lines += [f"Advice: set '{line}' in corpus.toml." for line in report["advice"]]
    for row in report["recordings"]:
        for slip in row["slips"]:
            what = f"{slip['marker']} slipped by {slip['size_mm']:.1f} mm at {slip['time_s']:.2f} s"
            lines.append(f"  {row['id']}: {what}.")
        for swap in row["swaps"]:
            lines.append(
                f"  {row['id']}: {' and '.join(swap['markers'])} were exchanged in frames "
                f"{swap['first']}-{swap['last']}."
            )
    return lines


def write_cleaning(out: Path, report: dict[str, Any]) -> None:
    """Write ``cleaning.json`` and ``report.html`` (no scripts, no other files; it opens anywhere)."""
    with atomic_folder(out) as folder:
        text = json.dumps(report, ensure_ascii=False, indent=1, allow_nan=False)
        (folder / "cleaning.json").write_text(text + "\n", encoding="utf-8")
        (folder / "report.html").write_text(cleaning_page(report), encoding="utf-8")
