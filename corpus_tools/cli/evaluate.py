"""``corpus-tools evaluate``: methods judged on sentences that they never saw."""

from __future__ import annotations

import contextlib
import datetime
import platform
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

import corpus_tools
from corpus_tools.cli.common import PATH, check_out_folder, emit_json, progress_bar, say
from corpus_tools.core import InputError
from corpus_tools.evaluate import (
    METRICS,
    Evaluation,
    Fold,
    Table,
    evaluate,
    k_folds,
    leave_one_out,
    one_split,
    tabulate,
    value_text,
    write_evaluation,
)
from corpus_tools.methods import METHODS, Variant, parse_variant
from corpus_tools.pipeline import (
    CorpusSource,
    Progress,
    RawCorpus,
    code_hash,
    joined_corpora,
    library_versions,
    one_thread,
    read_corpus,
)

__all__ = ["register"]

USUAL_FOLDS = 5
SHOWN = (
    "rmse",
    "r_aperture",
    "dtw",
    "dynamic_range",
    "frechet",
    "bilabial_closure",
    "join_peak",
    "word_rmse",
)


def _variants(methods: str | None) -> list[Variant]:
    texts = [m for m in (methods or ",".join(METHODS)).split(",") if m.strip()]
    variants = [parse_variant(text) for text in texts]
    if not variants:
        raise InputError(f"--methods names no method. Known: {', '.join(METHODS)}.")
    labels = [v.label for v in variants]
    if twice := next((x for x in labels if labels.count(x) > 1), None):
        raise InputError(f"--methods names '{twice}' twice; name each method once.")
    return variants


def _split(
    corpus: Path, test_corpus: Path | None, folds: int | None, alone: bool, seed: int, progress: Progress
) -> tuple[CorpusSource, tuple[Fold, ...], str]:
    """Return the recordings, which of them are tested together, and how that is called."""
    known: list[int] = []

    def read() -> RawCorpus:
        report = (lambda fraction, what: None) if known else progress  # the bar does not run back
        raw = read_corpus(corpus, report, keep_sound=False)
        known[:] = [len(raw.names)]
        if test_corpus is None:
            return raw
        return joined_corpora(raw, read_corpus(test_corpus, report, keep_sound=False))

    source = CorpusSource(read)
    names, tested = source.names[: known[0]], source.names[known[0] :]
    if test_corpus is not None:
        return source, one_split(names, tested), f"test corpus of {len(tested)} sentences"
    if alone:
        return source, leave_one_out(names, seed), "leave-one-out"
    n = USUAL_FOLDS if folds is None else folds
    return source, k_folds(names, n, seed), f"{n} folds"


def _tell_fold(number: int, n: int) -> None:
    """Say on stderr that a fold begins, where no bar is drawn."""
    if sys.stderr is not None and not sys.stderr.isatty():
        with contextlib.suppress(OSError):  # whoever reads it may be gone
            sys.stderr.write(f"fold {number} of {n}, {100 * (number - 1) / n:.0f} % done\n")
            sys.stderr.flush()


def _about(source: CorpusSource, how: str, variants: Sequence[Variant], seed: int) -> dict[str, Any]:
    return {
        "corpus": source.description.name,
        "split": how,
        "seed": seed,
        "methods": {v.label: {**v.method.settings, **v.changes} for v in variants},
        "left_out": source.skipped,
        "program": {"version": corpus_tools.__version__, "code_sha256": code_hash()},
        "libraries": library_versions(),
    }


def _tuned_lines(result: Evaluation) -> Iterator[str]:
    for method, found in result.tuned.items():
        if len(found) > USUAL_FOLDS:
            yield f"{method}: the weights found on each of {len(found)} training parts are in table.json."
            continue
        for number, weights in enumerate(found, 1):
            told = ", ".join(f"{name} {value:g}" for name, value in weights.items() if value)
            yield f"{method} found on training part {number}: {told}."


def _tell(table: Table, result: Evaluation, out: Path) -> None:
    shown = [m for m in SHOWN if any((method, m) in table.values for method in table.methods)]
    headers = [f"{m} {METRICS[m].unit}".strip() for m in shown]
    width = max(len(m) for m in table.methods)
    say("  ".join([" " * width, *(f"{header:>8}" for header in headers)]))
    for method in table.methods:
        texts = (value_text(table.values.get((method, m))) for m in shown)
        row = (f"{text:>{max(8, len(header))}}" for text, header in zip(texts, headers, strict=True))
        say("  ".join([f"{method:<{width}}", *row]))
    say("Read error and realism together: 'natural' and 'repetition' are what speech itself scores, the")
    say("latter only in words that are said again (word_rmse). –: nothing to say. Without unit: a ratio.")
    for line in _tuned_lines(result):
        say(line)
    if failures := len(result.failures):
        say(f"▲ {failures} times a method could not speak a sentence: left out of its row (table.json).")
    say(f"{len(METRICS)} metrics with intervals: {out / 'report.html'}, {out / 'table.csv'}")


@one_thread
def _run(
    corpus: Path,
    out: Path,
    test_corpus: Path | None,
    folds: int | None,
    alone: bool,
    variants: Sequence[Variant],
    seed: int,
) -> tuple[Table, dict[str, Any], Evaluation]:
    with progress_bar("reading") as progress:
        source, split, how = _split(
            corpus, test_corpus, folds, alone, seed, lambda f, w: progress(0.03 * f, w)
        )
        result = evaluate(
            source,
            split,
            variants,
            seed=seed,
            progress=lambda f, w: progress(0.03 + 0.94 * f, w),
            on_fold=_tell_fold,
        )
        progress(0.97, "resampling sentences")
        table = tabulate(result, seed)
        about = _about(source, how, variants, seed)
        now = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
        run = {"date": now, "host": platform.node(), "system": platform.platform()}
        write_evaluation(out, result, table, about, run)
    return table, about, result


def evaluate_(
    corpus: Annotated[Path, typer.Argument(**PATH, help="Corpus folder, as 'corpus-tools init' made it.")],
    out: Annotated[
        Path, typer.Option("--out", **PATH, help="Folder for table.csv, sentences.csv, report.html, ...")
    ],
    folds: Annotated[
        int | None, typer.Option("--folds", help=f"Parts, each held out once ({USUAL_FOLDS}).")
    ] = None,
    alone: Annotated[
        bool, typer.Option("--leave-one-out", help="Hold out each recording alone (slow: fits as often).")
    ] = False,
    test_corpus: Annotated[
        Path | None,
        typer.Option("--test-corpus", **PATH, help="Learn from CORPUS, test on this one."),
    ] = None,
    methods: Annotated[
        str | None,
        typer.Option(
            "--methods",
            help=f"By comma: {', '.join(METHODS)}; settings after a colon, as in "
            "viterbi:mode=inertial+remove_bias=off; viterbi:weights=tuned finds its weights on the training "
            "part. All methods by default.",
        ),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of folds, resamples and repetitions.")] = 0,
    json_: Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")] = False,
) -> None:
    """Judge methods on held-out sentences: error, realism, closures and joins, with intervals over sentences.

    Everything is learned from the other folds alone; a tested recording gives its phones and their times.

    Example: corpus-tools evaluate WORK --folds 5 --methods dominance-phone,greedy,viterbi --out OUT
    """
    if sum((folds is not None, alone, test_corpus is not None)) > 1:
        raise InputError("--folds, --leave-one-out and --test-corpus exclude each other; give one of them.")
    variants = _variants(methods)
    check_out_folder(out, corpus)
    if test_corpus is not None:
        check_out_folder(out, test_corpus)
    table, about, result = _run(corpus, out, test_corpus, folds, alone, variants, seed)
    _tell(table, result, out)
    if json_:
        rows = [
            {"method": a, "metric": m, "value": e.value, "low": e.low, "high": e.high, "n": e.n}
            for (a, m), e in table.values.items()
        ]
        emit_json({"out": str(out), "split": about["split"], "sentences": table.n_sentences, "values": rows})


def register(app: typer.Typer) -> None:
    """Enter the command in the app."""
    app.command("evaluate")(evaluate_)
