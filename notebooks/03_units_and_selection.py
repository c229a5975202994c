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
# # Units and selection
#
# Which pieces of captured speech are there, and which of them speak a sentence? Paper A takes sentences,
# words, syllables and diphones as units and chooses the longest first. Here every run of phones is a
# unit, found by one index (where a syllable begins is told by rules of the language: in English the longest
# onset that a word may begin with), and a second search weighs what the longest-first rule does not see: how
# well neighbours fit.

# %%
import os
import tempfile
from pathlib import Path

import holoviews as hv
import numpy as np
import pandas as pd

from corpus_tools.config import Config, config_with
from corpus_tools.core import Selection
from corpus_tools.demo import simulate_corpus
from corpus_tools.fragments import coverage, unit_views
from corpus_tools.io import init_corpus
from corpus_tools.pipeline import align_units, blend_units, open_corpus, select_units

hv.extension("bokeh", inline=True)

# %% [markdown]
# ## A corpus
#
# The GRID recordings when the environment variable `SPEECH_CORPORA` names a folder that holds them, and a
# small *simulated* corpus when it does not.

# %%
folder = tempfile.TemporaryDirectory(prefix="units-")
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
views = unit_views(corpus.inventory)
pd.Series({k: v for k, v in views.as_dict().items() if isinstance(v, int)}, name="units").to_frame()

# %% [markdown]
# ## What the corpus can say
#
# Diphones, from the centre of one phone to the centre of the next, are the smallest units. A row is the
# first phone, a column the second; the number says how often the pair was recorded. A sentence all of
# whose diphones are there is put together without anything standing in.

# %%
report = coverage(corpus.inventory, [corpus.utterance(name) for name in corpus.names])
pairs = [(a, b, n) for (a, b), n in views.diphones.items()]
hv.HeatMap(pairs, ["first phone", "second phone"], "recorded").opts(
    width=720, height=560, xrotation=90, tools=["hover"], colorbar=True, cmap="Blues", clim=(0, None)
)

# %%
pd.DataFrame(
    {
        "recording": u.name,
        "covered by the others": f"{100 * u.share:.0f} %",
        "sentence": corpus.utterance(u.name).text,
    }
    for u in sorted(report.utterances, key=lambda u: u.share)[:8]
)

# %% [markdown]
# ## Two searches
#
# *Greedy* is paper A's: the longest unit from the left, told apart by timing and context. *Viterbi* finds
# the path of least total cost, joins included. The recording itself is held out of both.

# %%
target = max((corpus.utterance(name) for name in corpus.names), key=lambda u: len(u.phones))
methods = {m: config_with(Config(), selection__method=m) for m in ("greedy", "viterbi")}
chosen = {m: select_units(corpus, target, config, [target.name]) for m, config in methods.items()}

pd.DataFrame(
    {
        "method": method,
        "phones": " ".join(target.labels[c.first : c.last + 1]),
        "unit": c.unit.key,
        "target cost": round(c.costs.target_total, 2),
        "join cost": round(c.costs.join_total, 2),
        "stands in": ", ".join(f"{used} for {wanted}" for _, wanted, used in c.backoff),
    }
    for method, selection in chosen.items()
    for c in selection.chosen
)

# %% [markdown]
# Where does the cost come from? Greedy leaves fewer joins, Viterbi cheaper ones.


# %%
def terms(selection: Selection) -> dict[str, float]:
    """Return the sum of every term of the cost."""
    pairs = [pair for c in selection.chosen for pair in (*c.costs.target, *c.costs.join)]
    return {name: sum(v for n, v in pairs if n == name) for name in dict.fromkeys(n for n, _ in pairs)}


costs = pd.DataFrame({method: terms(selection) for method, selection in chosen.items()}).fillna(0.0)
bars = [(term, method, costs.loc[term, method]) for method in costs for term in costs.index]
hv.Bars(bars, ["term", "method"], "cost").opts(width=720, height=300, stacked=False, xrotation=30)

# %% [markdown]
# ## Your own choice
#
# What the search turned down is kept with its cost. A *ban* takes a unit away, a *pin* puts one in its
# place; both are written in a config as they are written here.

# %%
longest = max(chosen["viterbi"].chosen, key=lambda c: c.last - c.first)
pd.DataFrame({"unit": r.unit.key, "cost": round(r.costs.total, 2)} for r in longest.rejected[:6])

# %%
banned = config_with(methods["viterbi"], overrides__bans=(longest.unit.key,))
without = select_units(corpus, target, banned, [target.name])
[c.unit.key for c in without.chosen]

# %% [markdown]
# A ban never makes a sentence cheaper, and the least-cost path is never dearer than the longest-first
# one. How the joins compare in the motion itself, before blending:

# %%
gaps = {}
for method, config in methods.items():
    trajectory = blend_units(corpus, target, align_units(corpus, target, chosen[method], config), config)
    gaps[method] = [join.gap_mm for join in trajectory.joins]
pd.DataFrame(
    {"method": m, "joins": len(g), "mean gap, mm": np.mean(g) if g else 0.0} for m, g in gaps.items()
).round(2)

# %%
total = {method: selection.total_cost for method, selection in chosen.items()}
assert total["viterbi"] <= total["greedy"] + 1e-9
assert len(chosen["greedy"].chosen) <= len(chosen["viterbi"].chosen)
assert without.total_cost >= total["viterbi"] - 1e-9
assert longest.unit not in {c.unit for c in without.chosen}
