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
# # A first synthesis
#
# A sentence that is kept out of the corpus is spoken by fragments of the other recordings. We look at the
# fragments, watch the head, change the weighting function g(u) that blends one fragment into the next, and
# keep the settings in a file from which the same motion comes again.

# %%
import os
import tempfile
from pathlib import Path

import holoviews as hv
import numpy as np
import pandas as pd
import panel as pn

from corpus_tools.config import Config, config_diff, config_with, load_config, write_config
from corpus_tools.demo import simulate_corpus
from corpus_tools.io import init_corpus
from corpus_tools.mesh import signed_lip_aperture_mm
from corpus_tools.pipeline import (
    align_units,
    animate,
    blend_units,
    open_corpus,
    prepare_head,
    synthesise,
)
from workbench.views.speaking_head import move_head, show_head
from workbench.views.transport import Transport

pn.extension(inline=True)

# %% [markdown]
# ## A corpus
#
# A corpus is a folder with a `corpus.toml` that says where the recordings are and how to read them.
# `init_corpus` writes it for recordings that exist; they stay where they are. Here we take the GRID
# recordings when the environment variable `SPEECH_CORPORA` names a folder that holds them, and a small
# *simulated* corpus when it does not.

# %%
folder = tempfile.TemporaryDirectory(prefix="first-synthesis-")
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
    simulate_corpus(work / "corpus", n_sentences=14)
corpus = open_corpus(work / "corpus")
f"{len(corpus.names)} recordings, {corpus.inventory.n_phones} phones, {len(corpus.markers)} markers"

# %% [markdown]
# ## The fragments that speak a sentence
#
# The target utterance is what is said in the first recording that has a p, b or m: its phones and their
# times. `exclude` keeps that recording out, so nothing of it can be used. Each fragment runs from the
# centre of its first phone to the centre of its last; neighbours share the phone where they meet.

# %%
target = next(
    r.utterance for r in corpus.recordings if set(r.utterance.labels) & set(corpus.phones.bilabials)
)
config = Config()
head = prepare_head(corpus, config.deform.mesh, config)
synthesis = synthesise(corpus, target, config, head, exclude=[target.name])

pd.DataFrame(
    {
        "phones": " ".join(target.labels[chosen.first : chosen.last + 1]),
        "from the sentence": corpus.utterance(chosen.unit.recording).text,
        "recording": chosen.unit.recording,
        "cost": round(chosen.costs.total, 2),
        "stands in": ", ".join(f"{used} for {wanted}" for _, wanted, used in chosen.backoff),
    }
    for chosen in synthesis.selection.chosen
)

# %% [markdown]
# Where two fragments meet, they are blended. The gap is how far they lie apart before that; the percentile
# says where the peak acceleration around the join stands among those of natural speech in this corpus.

# %%
pd.DataFrame(
    {
        "time, s": round(join.time_s, 3),
        "phone": join.phone,
        "overlap, s": round(join.overlap_s, 3),
        "gap, mm": round(join.gap_mm, 2),
        "natural percentile": round(join.natural_percentile, 1),
    }
    for join in synthesis.trajectory.joins
)

# %% [markdown]
# ## The head
#
# The view is drawn by the browser: drag to turn the head, press play to hear the sentence and see it move.
# Only the displacements of the markers are sent; the patches (or the basis) of the deformer, which the view
# holds, make the skin of them.

# %%
view = show_head(head, synthesis.animation, session="first")
transport = Transport(session="first")
transport.load(target, corpus.phones)
pn.Column(view, transport, width=760)

# %% [markdown]
# ## Another g(u)
#
# g(u) weighs the left fragment from 1 to 0 over the overlap. Only blending and what follows it need to run
# again, and the head above moves with the new function at once. A straight line has corners at both ends of
# the overlap, and a longer overlap mixes more of two different mouth shapes.

# %%
pieces = align_units(corpus, target, synthesis.selection, config)
changed = config_with(config, blend__weighting="linear", blend__overlap_s=0.03)
apertures = {}
for name, settings in {"as it was": config, "short and straight": changed}.items():
    motion = animate(head, blend_units(corpus, target, pieces, settings))
    frames = head.binding.apply(motion.targets_mm, rigid=motion.rigid)
    apertures[name] = signed_lip_aperture_mm(frames, head.mesh)
move_head(view, head, motion)

# %% [markdown]
# Away from the joins nothing changes, so the whole sentence would show two lines on top of each other: we
# look at the join where they differ most, and below at the difference over the whole sentence. Measured is
# the opening between the lips of the *mesh*; that of the captured *markers* is another number, for they sit
# on the skin around the lips.

# %%
difference = apertures["short and straight"] - apertures["as it was"]
joins_s = np.array([join.time_s for join in synthesis.trajectory.joins])
at_s = joins_s[np.argmin(np.abs(joins_s - motion.times_s[np.abs(difference).argmax()]))]
near = np.abs(motion.times_s - at_s) <= 0.15
size = hv.opts.Curve(width=760, height=220, tools=["hover"])

curves = hv.Overlay(
    [
        hv.Curve((motion.times_s[near], aperture[near]), "time, s", "mesh lip aperture, mm", label=name)
        for name, aperture in apertures.items()
    ]
).opts(size, hv.opts.Overlay(legend_position="top", title=f"around the join at {at_s:.2f} s"))
change = hv.Curve((motion.times_s, difference), "time, s", "change of mesh lip aperture, mm").opts(size)
joins = hv.Overlay([hv.VLine(t).opts(color="gray", line_dash="dotted", line_width=1) for t in joins_s])
pn.Column(pn.pane.HoloViews(curves), pn.pane.HoloViews(change * joins))

# %%
pd.DataFrame(config_diff(config, changed), columns=["setting", "before", "after"])

# %% [markdown]
# ## Keeping it
#
# A config file holds every value, also those that are at their default, so it still means the same when a
# default changes. `corpus-tools synth CORPUS --utterance NAME --config FILE --out OUT` replays it.

# %%
write_config(work / "tuned.toml", changed)
again = synthesise(corpus, target, load_config(work / "tuned.toml"), head, exclude=[target.name])
print((work / "tuned.toml").read_text(encoding="utf-8"))

# %% [markdown]
# The mouth moves differently with the other g(u), and the file gives exactly that motion again.

# %%
difference_mm = np.abs(difference).max()
first = blend_units(corpus, target, pieces, changed)
assert difference_mm > 0.05, f"g(u) changed the mesh lip aperture by {difference_mm:.3f} mm only"
assert np.array_equal(again.trajectory.values_mm, first.values_mm)
assert all(chosen.unit.recording != target.name for chosen in again.selection.chosen)
