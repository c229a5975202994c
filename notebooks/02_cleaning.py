# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Cleaning a capture
#
# A capture shows the head's own motion, hides markers now and then, and shows some where they cannot be. We
# take these apart one by one, hide a marker that was seen and fill it again, and look at the report that
# `corpus-tools clean` writes.

# %%
import os
import tempfile
from pathlib import Path

import holoviews as hv
import numpy as np
import pandas as pd
import panel as pn

from corpus_tools.cleaning import GAP_FILLERS, face_model, fill_gaps, rehearse, remove_head_motion
from corpus_tools.core import Capture
from corpus_tools.demo import simulate_corpus
from corpus_tools.io import init_corpus
from corpus_tools.pipeline import (
    clean_corpus,
    cleaning_report,
    read_corpus,
    reference_columns,
    write_cleaning,
)

pn.extension(inline=True)

# %% [markdown]
# ## Recordings
#
# Those of GRID whose names begin with l ("lay ...") when the environment variable `SPEECH_CORPORA` names a
# folder that holds them, a small *simulated* corpus when it does not.

# %%
folder = tempfile.TemporaryDirectory(prefix="cleaning-")
work = Path(folder.name)
recordings = os.environ.get("SPEECH_CORPORA")
if recordings:
    grid = Path(recordings).absolute() / "grid_s1"
    init_corpus(
        work / "corpus",
        motion=f"{grid}/markers73/l{{id}}.npz",
        audio=f"{grid}/wav/l{{id}}.wav",
        labels=f"{grid}/textgrid/l{{id}}.TextGrid",
        settings={"frame_time": "centre", "head_scale": "true"},
    )
else:
    simulate_corpus(work / "corpus", n_sentences=8)
raw = read_corpus(work / "corpus")
cleaned = clean_corpus(raw)
f"{len(raw.names)} recordings at {raw.captures[0].rate_hz:g} Hz, {len(raw.captures[0].names)} markers"

# %% [markdown]
# ## The head
#
# The head markers of every frame are fitted to the mean shape of the head, doubting those that lie off. What
# is left of them is the residual of the frame; a jig that slips is told apart because the face moves against
# it as a whole.

# %%
worst = max(range(len(raw.names)), key=lambda i: np.nanmax(cleaned.head_motion[i].residual_mm))
motion, capture = cleaned.head_motion[worst], raw.captures[worst]
residual = hv.Curve((capture.times_s, motion.residual_mm), "time, s", "residual of the head, mm")
pn.pane.HoloViews(residual.opts(width=760, height=220, tools=["hover"]))

# %% [markdown]
# ## A gap that is known
#
# In the head-stabilised space we hide a lip marker that was seen for 0.2 s and fill it in every way.
# `rehearse` hides other stretches of that length first: it tells which filler does best, and how wide its
# band must be.

# %%
columns = reference_columns(raw.description, raw.captures[0])
scaled = raw.description.head_scale
still = [remove_head_motion(c, cleaned.reference_mm, columns, scaled)[0] for c in raw.captures]
rate_hz = still[0].rate_hz
n = round(0.2 * rate_hz)
marker = still[0].names.index("lip_in2") if "lip_in2" in still[0].names else 40


def all_seen(capture: Capture) -> bool:
    """Return whether the marker is seen throughout the middle of a recording."""
    middle = capture.n_frames // 2
    return bool(np.isfinite(capture.positions_mm[middle - 2 * n : middle + 2 * n, marker]).all())


chosen = next(i for i, c in enumerate(still) if all_seen(c))
first = still[chosen].n_frames // 2
positions = np.array(still[chosen].positions_mm)
truth = positions[first : first + n, marker].copy()
positions[first : first + n, marker] = np.nan
holed = Capture(positions, rate_hz, still[chosen].names, start_s=still[chosen].start_s)
known = [*still[:chosen], holed, *still[chosen + 1 :]]
model = face_model(known)
rehearsals = rehearse([holed], model)

errors_mm, filled = {}, {}
for method in ["auto", *(m for m in GAP_FILLERS if m != "kalman")]:
    filled[method] = fill_gaps(holed, method, model=model, rehearsals=rehearsals)
    there = filled[method][0].positions_mm[first : first + n, marker]
    errors_mm[method] = float(np.sqrt(((there - truth) ** 2).sum(axis=1).mean()))
pd.DataFrame({"error, mm": errors_mm}).round(3)

# %%
around = slice(first - 2 * n, first + 3 * n)
times = holed.times_s[around]
best, sd_mm = filled["auto"]
height, band = best.positions_mm[around, marker, 1], 1.645 * sd_mm[around, marker]
was = still[chosen].positions_mm[around, marker, 1]
pictures = [
    hv.Area((times, height - band, height + band), vdims=["low", "high"], label="90 % band").opts(alpha=0.3),
    hv.Curve((times, height), "time, s", "height, mm", label="filled"),
    hv.Curve((times, was), label="as it was").opts(line_dash="dashed"),
]
pn.pane.HoloViews(hv.Overlay(pictures).opts(width=760, height=260, legend_position="top"))

# %% [markdown]
# ## The report
#
# The same as `corpus-tools clean CORPUS --out OUT` writes: one page that opens anywhere, and its numbers as
# JSON. The offset between sound and motion is estimated and shown, and never applied by itself.

# %%
report = cleaning_report(raw, cleaned)
write_cleaning(work / "report", report)
shown = ["id", "gaps", "filled_samples", "doubtful_samples", "spikes", "noise_mm"]
pd.DataFrame(report["recordings"])[shown].head(8)

# %% [markdown]
# The other markers tell where the hidden one was, the choice made in rehearsal is among the best ways, and
# nothing is left unfilled.

# %%
assert errors_mm["auto"] < 1.0, f"the gap was filled {errors_mm['auto']:.2f} mm off"
assert errors_mm["auto"] <= 1.5 * min(errors_mm.values()) + 0.05, errors_mm
assert all(np.isfinite(c.positions_mm).all() for c in cleaned.captures)
assert sum((c.flags & 2 > 0).sum() for c in cleaned.captures) == report["summary"]["filled_samples"]
assert "<script" not in (work / "report/report.html").read_text(encoding="utf-8")
