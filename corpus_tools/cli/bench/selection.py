"""Finding units among very many: the index and both searches."""

from __future__ import annotations

from corpus_tools.cli.bench.rows import BENCHMARKS, Ground, Row
from corpus_tools.core import Recording, Tier, Utterance
from corpus_tools.fragments import build_inventory
from corpus_tools.pipeline import OpenCorpus
from corpus_tools.synthesis import prepare_selection, select_greedy, select_viterbi

__all__ = ["measure_selection"]

N_PHONES = 30
INDEX_BARS_MS = {100_000: 100.0, 1_000_000: 1500.0}
SEARCH_BARS_MS = {100_000: 30.0, 1_000_000: 100.0}


def _recordings(corpus: OpenCorpus, n_phones: int) -> list[Recording]:
    """Return the corpus over and over under new names, about `n_phones` phones in all."""
    found: list[Recording] = []
    count = 0
    while count < n_phones:
        for r in corpus.recordings:
            name = f"{r.name}-{len(found)}"
            found.append(Recording(Utterance(name, r.utterance.text, r.utterance.phones), r.capture))
            count += len(r.utterance.phones)
            if count >= n_phones:
                break
    return found


def _target(ground: Ground) -> Utterance:
    phones = ground.longest.phones.intervals[:N_PHONES]
    return Utterance("target", "", Tier("phones", phones))


@BENCHMARKS.register("selection")
def measure_selection(ground: Ground) -> list[Row]:
    """Measure at 1e5 phones, with --full at 1e6 too."""
    rows: list[Row] = []
    for n_phones in (100_000, 1_000_000) if ground.full else (100_000,):
        rows += _at_size(ground, n_phones)
    return rows


def _at_size(ground: Ground, n_phones: int) -> list[Row]:
    corpus, target = ground.corpus, _target(ground)
    recordings = _recordings(corpus, round(ground.scale * n_phones))
    build = ground.best_ms(lambda: build_inventory(recordings))
    model = prepare_selection(build_inventory(recordings), corpus.phones)
    greedy = ground.best_ms(lambda: select_greedy(model, target))
    viterbi = ground.best_ms(lambda: select_viterbi(model, target))
    size, bar = f"{model.inventory.n_phones:.1e} phones", SEARCH_BARS_MS[n_phones]
    what = f"{len(target.phones)}-phone target, {size}"
    return [
        Row(f"index of {size}", build, bar=INDEX_BARS_MS[n_phones]),
        Row(f"greedy, {what}", greedy, bar=bar),
        Row(f"viterbi, {what}", viterbi, bar=bar, peer="greedy", peer_measured=greedy),
    ]
