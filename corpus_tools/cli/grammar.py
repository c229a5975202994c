"""``corpus-tools grammar list|sample|cover``: the sentences of a limited domain, and which to record."""

from __future__ import annotations

import itertools
from typing import Annotated, Any

import numpy as np
import typer

from corpus_tools.cli.common import emit_json, say
from corpus_tools.core import InputError, counted
from corpus_tools.demo import Cover, greedy_cover, load_grammar, pool_of

__all__ = ["register"]

Source = Annotated[
    str,
    typer.Argument(
        metavar="G",
        help="'time' (paper A, section 4), or a TOML file with [grammar] (prompt = names of slots, a list of "
        "alternatives each; '' leaves a slot out) and [lexicon] (word = 'PH ON ES'; words that it lacks are "
        "asked of the voice).",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Another seed is another choice.")]


def _number(name: str, value: int, most: int) -> int:
    if not 1 <= value <= most:
        raise InputError(f"{name} {value}: a number from 1 to {most} was expected.")
    return value


def list_(
    grammar: Source = "time",
    limit: Annotated[int | None, typer.Option("--limit", help="Only the first so many.")] = None,
    json_: Json = False,
) -> None:
    """List the sentences of a grammar, one a line; all of them unless --limit says less."""
    chosen = load_grammar(grammar)
    n = chosen.size if limit is None else min(_number("--limit", limit, 10**9), chosen.size)
    texts = itertools.islice(chosen.texts(), n)
    if json_:
        emit_json({"grammar": chosen.name, "size": chosen.size, "sentences": list(texts)})
        return
    for text in texts:
        say(text)


def sample(
    grammar: Source = "time",
    n: Annotated[int, typer.Option("--n", help="How many sentences.")] = 10,
    seed: Seed = 0,
    json_: Json = False,
) -> None:
    """Print different sentences at random; the same seed gives the same."""
    chosen = load_grammar(grammar)
    texts = chosen.sample(_number("--n", n, chosen.size), np.random.default_rng(seed))
    if json_:
        emit_json({"grammar": chosen.name, "size": chosen.size, "seed": seed, "sentences": texts})
        return
    for text in texts:
        say(text)


def _rows(cover: Cover) -> list[dict[str, Any]]:
    return [
        {"sentence": s.text, "adds": ["-".join(d) for d in added], "covered": covered}
        for s, added, covered in zip(cover.sentences, cover.added, cover.covered, strict=True)
    ]


def cover(
    grammar: Source = "time",
    n: Annotated[int, typer.Option("--n", help="At most so many sentences.")] = 30,
    seed: Seed = 0,
    json_: Json = False,
) -> None:
    """Choose sentences that cover the diphones of a grammar, best first; say what each adds.

    Once all are covered the rest is chosen so that each diphone comes as often as possible.
    """
    chosen = load_grammar(grammar)
    found = greedy_cover(
        pool_of(chosen, np.random.default_rng(seed)), _number("--n", n, min(chosen.size, 10_000))
    )
    rows = _rows(found)
    share = rows[-1]["covered"] / found.total
    if json_:
        emit_json(
            {"grammar": chosen.name, "size": chosen.size, "diphones": found.total, "coverage": share}
            | {"sentences": rows}
        )
        return
    for place, row in enumerate(rows, 1):
        percent = 100 * row["covered"] / found.total
        say(f"{place:3d}  {percent:5.1f} %  +{len(row['adds']):<3d} {row['sentence']}")
        say(f"                     {' '.join(row['adds']) or 'nothing new'}")
    total, sentences = counted(found.total, "diphone"), counted(len(rows), "sentence")
    say(f"{rows[-1]['covered']} of {total} of the grammar '{chosen.name}' in {sentences}.")


def register(app: typer.Typer) -> None:
    """Enter the group of commands in the app."""
    what = "List, sample and cover the sentences of a limited domain."
    group = typer.Typer(help=what, no_args_is_help=True, rich_markup_mode=None)
    group.command("list")(list_)
    group.command("sample")(sample)
    group.command("cover")(cover)
    app.add_typer(group, name="grammar")
