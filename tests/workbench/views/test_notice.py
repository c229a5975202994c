"""Notices and the inspector escape what comes from files, and always stand beside a sign."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Costs, UnitRef
from workbench.state import FragmentDetails, Option, Options, Session
from workbench.views.history_list import compare_html, history_html
from workbench.views.inspector import bans_html, details_html, options_html
from workbench.views.notice import NOTICE_KINDS, notice_html

HOSTILE = "<img src=x onerror=alert(1)>"


@pytest.mark.parametrize("kind", [k for k, sign in NOTICE_KINDS.items() if sign])
def test_colour_is_never_the_only_sign(kind):
    assert NOTICE_KINDS[kind] in notice_html(kind, "what")


@given(st.text(alphabet="<>&'\"ab`", max_size=20))
def test_texts_are_escaped(text):
    made = notice_html("err", text, text, text, [text])
    for tag in ("<img", "<script", "<a", "<b>"):
        assert tag not in made
    assert made.count("<div") == 1


def details(**changes):
    values = dict(
        index=1,
        n_fragments=3,
        slot=1,
        source="a1",
        text="place red",
        phones="P L EY",
        first_s=0.5,
        last_s=0.9,
        costs=(("timing", 0.4), ("position", 0.2)),
        total=0.6,
        of_all=8.0,
        backoff=(),
        join={
            "time": 0.7,
            "overlap": 0.12,
            "inertial": 0.0,
            "phone": "EY",
            "gap": 1.5,
            "percentile": 97.0,
            "ratio": 1.4,
            "gap_mm_s": 20.0,
            "before": "b2",
            "before_text": "bin blue",
            "before_slot": 0,
        },
    )
    return FragmentDetails(**{**values, **changes})


def test_inspector_shows_source_costs_join_and_rejected():
    made = details_html(details(), "light")
    for text in ("a1", "place red", "Fragment 2 of 3", "0.40", "0.60", "0.120 s", "1.50 mm", "b2", "1.40 ×"):
        assert text in made
    assert "▲ above p95" in made
    assert "✓ natural" in details_html(details(join={**details().join, "ratio": 0.4}), "light")


def options():
    costs = Costs((("timing", 0.4),), (("position", 0.2),))
    units = [UnitRef("a1", 0, 2), UnitRef(HOSTILE, 3, 4)]
    return Options(tuple(Option(4, 4 + u.last - u.first, u, costs) for u in units))


def shown_options(pinned, tried):
    return options_html(
        options(), lambda name: f"said in {name}", pinned, tried, lambda unit: 0.1 * unit.first
    )


def test_alternatives_are_rows_that_act_and_escape_what_files_say():
    made = shown_options(True, False)
    assert "<img" not in made
    assert re.findall(r'<td class="num">([\d.]+)</td>', made)[:2] == ["0.00", "0.40"]
    assert re.findall(r'<td class="num">([\d.]+)</td>', made)[-1] == "0.20"
    assert made.count('data-action="swap"') == 2
    assert "2 ph." in made
    assert "Unpin" in made
    assert ["Keep <" in shown_options(True, tried) for tried in (False, True)] == [False, True]
    assert "<img" not in bans_html((HOSTILE,))
    assert bans_html(()) == ""


def test_the_history_escapes_what_was_typed():
    session = Session()
    session.begin_history()
    session.text = HOSTILE
    assert "<img" not in history_html(session)
    assert history_html(session).count('data-action="go"') == 2
    assert compare_html(session) == ""


def test_inspector_escapes_what_files_say():
    made = details_html(details(source=HOSTILE, text=HOSTILE), "dark")
    assert "<img" not in made


def test_first_fragment_has_no_join_before_it():
    assert "begins here" in details_html(details(index=0, join=None), "light")
    assert "No fragment selected" in details_html(None, "light")
