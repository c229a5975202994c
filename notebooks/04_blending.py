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
# # Blending
#
# Two fragments that were captured on different days never meet exactly. Paper A blends them where they
# overlap with a weighting function g(u), which goes from 1 to 0 (equation 2). Which function, over how
# long, and what does it do to the motion? The measure is the peak acceleration around the join, over that
# of natural stretches.

# %%
import os
import tempfile
from pathlib import Path

import holoviews as hv
import numpy as np
import pandas as pd

from corpus_tools.config import Config, config_with
from corpus_tools.core import Utterance
from corpus_tools.demo import simulate_corpus
from corpus_tools.io import init_corpus
from corpus_tools.pipeline import align_units, blend_units, open_corpus, select_units
from corpus_tools.speech import lip_aperture_mm
from corpus_tools.synthesis import WEIGHTINGS, AlignedPieces, effect_curves, lip_contacts, narrowed, weighting

hv.extension("bokeh", inline=True)

# %% [markdown]
# ## A sentence with joins
#
# From GRID when the environment variable `SPEECH_CORPORA` names a folder that holds it, and from a small
# *simulated* corpus when it does not. The sentence's own recording is held out.

# %%
folder = tempfile.TemporaryDirectory(prefix="blending-")
work = Path(folder.name)
recordings = os.environ.get("SPEECH_CORPORA")
if recordings:
    grid = Path(recordings).absolute() / "grid_s1"
    init_corpus(
        work / "corpus",
        motion=f"{grid}/markers73/{{id}}.npz",
        audio=f"{grid}/wav/{{id}}.wav",
        labels=f"{grid}/textgrid/{{id}}.TextGrid",
        settings={"frame_time": "centre", "head_scale": "true"},
    )
else:
    simulate_corpus(work / "corpus", n_sentences=9)
corpus = open_corpus(work / "corpus")
config = Config()


def prepared(name: str) -> tuple[Utterance, AlignedPieces]:
    """Return the target and the aligned fragments that speak a recording's sentence without it."""
    target = corpus.utterance(name)
    return target, align_units(corpus, target, select_units(corpus, target, config, [name]), config)


target, pieces = max((prepared(name) for name in corpus.names[:8]), key=lambda p: len(p[1].pieces))
f"“{target.text}” from {len(pieces.pieces)} fragments"

# %% [markdown]
# ## Weighting functions (figure 3)
#
# All of them weigh the left fragment from 1 to 0. They differ in how smoothly they leave 1 and reach 0: a
# corner there is a jump in velocity.

# %%
u = np.linspace(0, 1, 201)
curves = [hv.Curve((u, weighting(name)(u)), "u", "g(u)", label=name) for name in WEIGHTINGS]
hv.Overlay(curves).opts(
    hv.opts.Curve(width=760, height=320, tools=["hover"]), hv.opts.Overlay(legend_position="right")
)

# %% [markdown]
# ## What they do at this sentence's joins
#
# For every function and every longest overlap, the mean over the joins. 1 is the 95th percentile of
# natural stretches: below it a join is no sharper than speech itself.

# %%
overlaps_s = (0.02, 0.04, 0.06, 0.09, 0.12, 0.18)
names = {name: {} for name in WEIGHTINGS if name != "user"}
measured = effect_curves(*narrowed(pieces, corpus.natural), names, overlaps_s, rule="shared-phone")
mean = pd.DataFrame({c.weighting: np.nanmean(c.ratios, axis=1) for c in measured}, index=overlaps_s)
hv.Overlay(
    [
        hv.Curve(
            (1000 * mean.index, mean[name]),
            "longest overlap, ms",
            "mean of the joins ÷ natural p95",
            label=name,
        )
        for name in mean
    ]
).opts(hv.opts.Curve(width=760, height=340, tools=["hover"]), hv.opts.Overlay(legend_position="right"))

# %% [markdown]
# Length counts more than shape, and it saturates: the overlap never exceeds the phone that both fragments
# share. In a very short phone the straight line is even the calmest, as every other g has to be steeper
# in its middle. *Inertial* joins do not cross-fade at all: the difference of the fragments in position
# and velocity dies away on both sides.

# %%
settings = {
    "linear, 33 ms": config_with(config, blend__weighting="linear", blend__overlap_s=0.033),
    "smootherstep, 120 ms": config,
    "inertial": config_with(config, blend__mode="inertial"),
}
motions = {name: blend_units(corpus, target, pieces, c) for name, c in settings.items()}
pd.DataFrame(
    {
        "joins": name,
        "worst join ÷ natural p95": max(motion.peak_ratios),
        "mean": float(np.mean(motion.peak_ratios)),
        "contacts of the lips made": sum(
            c.made for c in lip_contacts(corpus.lips, motion, target, corpus.phones)
        ),
    }
    for name, motion in motions.items()
).round(2)

# %%
times = motions["inertial"].times_s
join = max(motions["linear, 33 ms"].joins, key=lambda j: j.peak_ratio)
near = np.abs(times - join.time_s) < 0.2
hv.Overlay(
    [
        hv.Curve(
            (times[near], lip_aperture_mm(m.values_mm, m.names)[near]), "time, s", "lip aperture, mm", label=n
        )
        for n, m in motions.items()
    ]
).opts(
    hv.opts.Curve(width=760, height=280, tools=["hover"]),
    hv.opts.Overlay(legend_position="top", title=f"around {join.phone}, {join.time_s:.2f} s"),
)

# %% [markdown]
# ## Lips that should be closed
#
# A blend of two closed mouths need not be closed. After any blending the lips are brought together in p b
# m and held there, and the lower lip goes to the teeth in f v, along the change that is likeliest for
# this face.

# %%
left = blend_units(corpus, target, pieces, config_with(config, closure__project=False))
contacts = {
    name: lip_contacts(corpus.lips, motion, target, corpus.phones)
    for name, motion in {"as blended": left, "brought together": motions["smootherstep, 120 ms"]}.items()
}
pd.DataFrame(
    {
        "motion": name,
        "phone": c.phone,
        "at, s": c.time_s,
        "from contact, mm": c.nearest_mm,
        "held, s": c.held_s,
    }
    for name, found in contacts.items()
    for c in found
).round(3)

# %%
sharpness = {name: float(np.mean(motion.peak_ratios)) for name, motion in motions.items()}
assert sharpness["inertial"] < sharpness["smootherstep, 120 ms"] < sharpness["linear, 33 ms"], sharpness
assert all(c.made for c in contacts["brought together"])
assert sum(c.made for c in contacts["as blended"]) <= len(contacts["brought together"])
