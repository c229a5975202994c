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
# # Retargetting and Bezier induced deformations
#
# 66 markers of an actor have to move a head of another shape with thousands of vertices. Paper A does it
# in two steps: a volume warp, by radial basis functions from the actor's neutral pose to that of the
# head, moves the markers into the head's space; a surface of Bezier triangles over the markers carries
# the skin (equation 3).

# %%
import tempfile
from pathlib import Path

import holoviews as hv
import numpy as np
import pandas as pd
import panel as pn
from scipy.spatial.distance import cdist

from corpus_tools.config import Config
from corpus_tools.demo import simulate_corpus
from corpus_tools.mesh import (
    DEFORMERS,
    Binding,
    bundled_head,
    bundled_morph_mm,
    signed_lip_aperture_mm,
    skin_regions,
)
from corpus_tools.mesh.regions import SkinRegion
from corpus_tools.pipeline import animate, open_corpus, prepare_head, synthesise
from workbench.views.speaking_head import show_head
from workbench.views.transport import Transport

pn.extension(inline=True)
hv.extension("bokeh", inline=True)

# %% [markdown]
# ## One capture, many heads
#
# The sentence is spoken once, by fragments of a small *simulated* corpus, and retargetted to four of the
# bundled heads. What the warp leaves at the markers, and whether it folds space anywhere, is checked for
# each.

# %%
folder = tempfile.TemporaryDirectory(prefix="retarget-")
simulate_corpus(Path(folder.name) / "corpus", n_sentences=6)
corpus = open_corpus(Path(folder.name) / "corpus")
config = Config()
target = corpus.utterance(corpus.names[0])
heads = {name: prepare_head(corpus, name, config) for name in ("base", "elder", "baby", "cartoon")}
first = synthesise(corpus, target, config, heads["base"], [target.name])
motions = {name: animate(head, first.trajectory) for name, head in heads.items()}
frames = {n: heads[n].binding.apply(m.targets_mm, rigid=m.rigid) for n, m in motions.items()}
apertures = {n: signed_lip_aperture_mm(f, heads[n].mesh) for n, f in frames.items()}
pd.DataFrame(
    {
        "head": name,
        "vertices": head.mesh.n_vertices,
        "places where the warp folds": head.retargeter.folds().n_folded,
        "widest opening, mm": apertures[name].max(),
        "deepest crossing of the lips, mm": min(0.0, apertures[name].min()),
    }
    for name, head in heads.items()
).round(2)

# %%
times = first.trajectory.times_s
hv.Overlay(
    [hv.Curve((times, a), "time, s", "mesh lip aperture, mm", label=n) for n, a in apertures.items()]
).opts(hv.opts.Curve(width=760, height=280, tools=["hover"]), hv.opts.Overlay(legend_position="right"))

# %%
view = show_head(heads["elder"], motions["elder"], session="heads")
transport = Transport(session="heads")
transport.load(target, corpus.phones)
pn.Column(view, transport, width=760)

# %% [markdown]
# ## Which deformer?
#
# The bundled head has face units of its own: shapes that an artist made. Put the markers where a unit
# puts them, and ask each deformer for the rest of the skin. The truth is the unit itself.

# %%
mesh = bundled_head()
names = tuple(mesh.markers)
at = [mesh.markers[n] for n in names]
bindings = {name: bind(mesh, names) for name, bind in DEFORMERS.items()}
regions = skin_regions(mesh)
lips = regions == SkinRegion.LIPS
units = {"jawOpen": 0.5, "mouthPucker": 0.8, "mouthSmileLeft": 0.8, "mouthUpperUpLeft": 0.8}


def error(binding: Binding, unit: str, amount: float, part: np.ndarray) -> float:
    """Return what a deformer leaves of a unit, as a share of the unit's own motion, rms."""
    truth = amount * bundled_morph_mm(unit)
    moved = binding.apply((mesh.vertices_mm[at] + truth[at])[None], {}, np.float64)[0] - mesh.vertices_mm
    return float(np.sqrt(((moved - truth)[part] ** 2).sum() / (truth[part] ** 2).sum()))


near = cdist(mesh.vertices_mm, mesh.vertices_mm[at]).min(axis=1) < 12.0
parts = {
    "lips": lips,
    "skin within 12 mm of a marker": near & (regions == SkinRegion.FACE) & mesh.part_mask("skin"),
}
errors = pd.DataFrame(
    [
        {"part": where, "unit": unit, **{n: error(b, unit, amount, part) for n, b in bindings.items()}}
        for where, part in parts.items()
        for unit, amount in units.items()
    ]
).set_index(["part", "unit"])
errors.round(3)

# %% [markdown]
# With markers as dense as on these lips the three lie close together, and direct displacement by radial
# basis functions is the nearest on this head. What the patches give beside that: a surface with one normal
# at every place, also with the mouth wide open, and offsets along that normal, so that the shape of the
# head goes with it.

# %% [markdown]
# ## The lips are apart
#
# The lower lip is pulled down by 8 mm while the upper one stays. No vertex of the upper lip may follow.

# %%
below = [i for i, n in enumerate(names) if n in ("lip_in5", "lip_in6", "lip_in7", "lip_out8", "lip_out9")]
pulled = mesh.vertices_mm[at].copy()
pulled[below, 1] -= 8.0
upper = mesh.lip_pairs[:, 0]
followed = {
    name: float(np.abs(b.apply(pulled[None], {}, np.float64)[0, upper] - mesh.vertices_mm[upper]).max())
    for name, b in bindings.items()
}
pd.Series(followed, name="upper lip moved, mm").to_frame().round(6)

# %%
assert all(head.retargeter.folds().n_folded == 0 for head in heads.values())
assert all(a.min() > -0.5 for a in apertures.values()), "lips pass through each other"
assert errors.loc["lips", "bid"].max() < 0.25, errors
assert followed["bid"] < 1e-6
