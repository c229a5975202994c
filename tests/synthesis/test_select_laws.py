"""Laws that hold for every corpus and target, drawn at random."""

import itertools

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from corpus_tools.core import NoUnitError, Selection
from corpus_tools.fragments import build_inventory, coverage
from corpus_tools.synthesis import prepare_selection, select_greedy, select_viterbi
from corpus_tools.synthesis.backoff import find_candidates
from corpus_tools.synthesis.chosen import path_cost
from corpus_tools.synthesis.target import prepare_target
from corpus_tools.synthesis.viterbi import viterbi_path
from tests.strategies.inventories import SmallPhoneSet, corpora, covered_target, targets

SEARCHES = [select_greedy, select_viterbi]
WEIGHTS = (
    *("duration", "context", "position", "stress", "backoff", "flagged"),
    *("join", "velocity", "acceleration", "aperture", "per_join"),
)


def model_of(recordings):
    return prepare_selection(build_inventory(recordings), SmallPhoneSet(), n_components=4)


def select(search, model, target, **keywords) -> Selection:
    try:
        return search(model, target, **keywords)
    except NoUnitError:
        assume(False)
        raise


@st.composite
def weights(draw):
    return {name: draw(st.sampled_from([0.0, 0.3, 1.0, 4.0])) for name in WEIGHTS}


@pytest.mark.parametrize("search", SEARCHES)
@given(recordings=corpora(least=4), target=targets())
def test_units_cover_the_target_and_neighbours_share_a_phone(search, recordings, target):
    model = model_of(recordings)
    selection = select(search, model, target)
    phones = {r.name: r.utterance.labels for r in recordings}
    edges = [c.first for c in selection.chosen] + [selection.chosen[-1].last]
    assert edges[0] == 0
    assert edges[-1] == len(target.labels) - 1
    for chosen, end in zip(selection.chosen, edges[1:], strict=True):
        assert chosen.last == end
        assert chosen.unit.last - chosen.unit.first == chosen.last - chosen.first > 0
        spoken = phones[chosen.unit.recording][chosen.unit.first : chosen.unit.last + 1]
        wanted = target.labels[chosen.first : chosen.last + 1]
        differ = [
            (chosen.first + i, w, s) for i, (w, s) in enumerate(zip(wanted, spoken, strict=True)) if w != s
        ]
        assert list(chosen.backoff) == differ


@pytest.mark.parametrize("prune", [None, 1, 2, 5])
@given(recordings=corpora(least=4), target=targets(), weights=weights())
def test_the_cheapest_path_is_never_dearer_than_longest_first(prune, recordings, target, weights):
    model = model_of(recordings)
    greedy = select(select_greedy, model, target, **weights)
    viterbi = select_viterbi(model, target, prune=prune, **weights)
    assert viterbi.total_cost <= greedy.total_cost + 1e-6


@given(corpora(least=2, most=5), targets(), weights())
def test_without_pruning_no_path_at_all_is_cheaper(recordings, target, weights):
    model = model_of(recordings)
    encoded = prepare_target(model, target, **weights)
    candidates = find_candidates(model, encoded) if _coverable(model, encoded) else None
    assume(candidates is not None and np.prod([len(r) for r in candidates.rows]) <= 3000)
    found = path_cost(model, encoded, viterbi_path(model, encoded, candidates, prune=None))
    least = min(path_cost(model, encoded, np.array(p)) for p in itertools.product(*candidates.rows))
    assert found == pytest.approx(least, abs=1e-6)


def _coverable(model, target):
    try:
        find_candidates(model, target)
    except NoUnitError:
        return False
    return True


@pytest.mark.parametrize("search", SEARCHES)
@given(recordings=corpora(least=4), target=targets(), weights=weights())
def test_itemised_costs_add_up_to_the_cost_of_the_path(search, recordings, target, weights):
    model = model_of(recordings)
    selection = select(search, model, target, **weights)
    rows = [model.inventory.rows(c.unit) for c in selection.chosen]
    path = np.concatenate([np.arange(first, last) for first, last in rows])
    total = path_cost(model, prepare_target(model, target, **weights), path)
    assert selection.total_cost == pytest.approx(total)
    assert selection.chosen[0].costs.join == ()


@given(corpora(least=3), st.integers(0, 1000))
def test_longest_first_has_the_fewest_joins_and_so_has_a_great_price_on_joins(recordings, seed):
    target = covered_target(recordings, np.random.default_rng(seed))
    model = model_of(recordings)
    greedy = select_greedy(model, target)
    priced = select_viterbi(model, target, per_join=1e6, prune=3)
    assert greedy.n_joins == priced.n_joins == fewest_units(recordings, target.labels) - 1


def fewest_units(recordings, phones):
    """Count the units of the shortest cover by trying every span against the text of every recording."""
    texts = [" " + " ".join(r.utterance.labels) + " " for r in recordings]
    least = [0] + [len(phones)] * (len(phones) - 1)
    for last in range(1, len(phones)):
        for first in range(last):
            span = " " + " ".join(phones[first : last + 1]) + " "
            if any(span in text for text in texts):
                least[last] = min(least[last], least[first] + 1)
    return least[-1]


@pytest.mark.parametrize("search", SEARCHES)
@given(recordings=corpora(least=4), target=targets(), data=st.data())
def test_what_is_held_out_or_banned_is_not_used(search, recordings, target, data):
    model = model_of(recordings)
    names = [r.name for r in recordings]
    out = data.draw(st.sets(st.sampled_from(names), max_size=2))
    ban = data.draw(st.sampled_from(names))
    first = select(search, model, target, exclude=out, bans=[ban])
    units = [(c.unit, c.rejected) for c in first.chosen]
    used = {u.recording for unit, others in units for u in (unit, *(o.unit for o in others))}
    assert not used & {*out, ban}
    unit = data.draw(st.sampled_from([c.unit for c in first.chosen]))
    again = select(search, model, target, exclude=out, bans=[ban, unit])
    for other in again.chosen:
        apart = other.unit.last <= unit.first or other.unit.first >= unit.last
        assert other.unit.recording != unit.recording or apart


@pytest.mark.parametrize("search", SEARCHES)
@given(recordings=corpora(least=4), target=targets(), data=st.data())
def test_a_pinned_alternative_is_used_and_costs_what_was_said(search, recordings, target, data):
    model = model_of(recordings)
    selection = select(search, model, target)
    place = data.draw(st.sampled_from(selection.chosen))
    assume(place.rejected)
    other = data.draw(st.sampled_from(place.rejected))
    last = place.first + other.unit.last - other.unit.first
    assert last <= place.last
    pins = [(c.first, c.last, c.unit) for c in selection.chosen if c.last <= place.first]
    again = search(model, target, pins=[*pins, (place.first, last, other.unit)], bans=[other.unit])
    holder = next(c for c in again.chosen if c.first <= place.first and last <= c.last)
    assert holder.unit.recording == other.unit.recording
    assert holder.unit.first - holder.first == other.unit.first - place.first
    if (holder.first, holder.last) == (place.first, last):
        assert holder.costs.total == pytest.approx(other.costs.total)


@pytest.mark.parametrize("search", SEARCHES)
@given(recordings=corpora(least=4), target=targets())
def test_alternatives_are_others_the_longest_first_then_the_cheapest(search, recordings, target):
    model = model_of(recordings)
    for chosen in select(search, model, target, n_rejected=4).chosen:
        units = [r.unit for r in chosen.rejected]
        ranks = [(u.first - u.last, r.costs.total) for u, r in zip(units, chosen.rejected, strict=True)]
        assert len(units) <= 4
        assert ranks == sorted(ranks)
        starts = {(u.recording, u.first) for u in (chosen.unit, *units)}
        assert len(starts) == len(units) + 1


@pytest.mark.parametrize("search", SEARCHES)
@given(recordings=corpora(least=2), target=targets())
def test_no_stand_in_is_used_where_the_diphone_is_there(search, recordings, target):
    model = model_of(recordings)
    (covered,) = coverage(model.inventory, [target], leave_one_out=False).utterances
    missing = covered.missing
    if missing:
        with pytest.raises(NoUnitError) as error:
            search(model, target, allow_backoff=False)
        assert error.value.diphones == missing
    selection = select(search, model, target)
    replaced = {i for c in selection.chosen for i, _, _ in c.backoff}
    pairs = list(itertools.pairwise(target.labels))
    near_missing = {i for k, pair in enumerate(pairs) if pair in missing for i in (k, k + 1)}
    assert replaced <= near_missing
    assert bool(replaced) == bool(missing)


@pytest.mark.parametrize("search", SEARCHES)
@given(recordings=corpora(least=4), target=targets())
def test_the_order_of_recordings_changes_nothing(search, recordings, target):
    one = select(search, model_of(recordings), target)
    other = search(model_of(recordings[::-1]), target)
    assert one == other
