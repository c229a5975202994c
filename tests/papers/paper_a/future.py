"""Paper A section 8, "Conclusions": what it leaves to the future and we built."""

import itertools

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from corpus_tools.core import UnitRef
from corpus_tools.fragments import build_inventory
from corpus_tools.synthesis import linked_utterance, prepare_selection, select_greedy, select_viterbi
from corpus_tools.synthesis.sound_joins import join_sounds
from tests.strategies.inventories import (
    SmallPhoneSet,
    corpora,
    covered_target,
    recording,
    simulated_recordings,
    utterance,
    with_sounds,
)


def model_of(recordings):
    return prepare_selection(build_inventory(recordings), SmallPhoneSet(), n_components=3)


def gap(model, selection) -> float:
    """Return how far apart the postures are that neighbours have where they are joined, summed."""
    rows = [model.inventory.rows(c.unit) for c in selection.chosen]
    at = [(left[-1], right[0]) for left, right in itertools.pairwise(rows)]
    place = model.joins.position
    return float(sum(np.linalg.norm(place[left] - place[right]) for left, right in at))


@given(corpora(least=4), st.integers(0, 1000))
def test_units_of_like_boundary_conditions_are_preferred(recordings, seed):
    """ "units with given boundary conditions, i.e. similarity in the overlapping blend period"

    A search that looks at nothing else leaves no wider gaps than the longest first do.
    """
    model = model_of(recordings)
    target = covered_target(recordings, np.random.default_rng(seed))
    only_joins = {"duration": 0.0, "context": 0.0, "velocity": 0.0, "per_join": 0.0, "flagged": 0.0}
    best = select_viterbi(model, target, prune=None, **only_joins)
    first = select_greedy(model, target, **only_joins)
    assert gap(model, best) <= gap(model, first) + 1e-9


@settings(max_examples=12)
@given(st.integers(0, 1000), st.floats(0.1, 5))
def test_units_of_sound_and_motion_are_chosen_together(seed, weight):
    """ "to select both audio and visual units"

    The more the joins of the sound count, the better they are, and a target may take the times and the sound
    of its units.
    """
    model = model_of(with_sounds(simulated_recordings(8, seed), seed))
    target = covered_target(list(model.inventory.recordings), np.random.default_rng(seed))
    heard = join_sounds(model.inventory)
    totals = []
    for sound in (0.0, weight):
        chosen = select_viterbi(model, target, prune=None, sound=sound)
        rows = [model.inventory.rows(c.unit) for c in chosen.chosen]
        pairs = [(a[-1], b[0]) for a, b in itertools.pairwise(rows)]
        totals.append(sum(float(np.linalg.norm(heard[a] - heard[b])) for a, b in pairs))
    assert totals[1] <= totals[0] + 1e-9
    linked = linked_utterance(target, chosen, model.inventory)
    assert linked.labels == target.labels
    assert linked.audio is not None
    assert abs(linked.audio.duration_s - linked.duration_s) < 0.001


def test_backoff_merges_captured_fragments_with_what_stands_in():
    """ "the use of backoff techniques": a diphone that was never captured is not the end of synthesis."""
    model = model_of([recording("a", ["SIL", "P", "A", "SIL"]), recording("b", ["SIL", "A", "D", "SIL"])])
    chosen = select_greedy(model, utterance("t", ["SIL", "B", "A", "T", "SIL"])).chosen
    assert [c.unit for c in chosen] == [UnitRef("a", 0, 2), UnitRef("b", 1, 3)]
    assert [stand_in for c in chosen for _, _, stand_in in c.backoff] == ["P", "D"]
