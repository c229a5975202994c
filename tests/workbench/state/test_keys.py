"""The key table: no key acts twice, every row can be shown."""

from collections import Counter

from workbench.state import key_label, key_table


def test_no_key_stands_twice():
    counts = Counter(key for row in key_table() for key in row.keys)
    assert [k for k, n in counts.items() if n > 1] == []


def test_actions_are_unique_and_described():
    rows = key_table()
    assert len({r.id for r in rows}) == len(rows)
    assert all(r.label and r.short and r.caption for r in rows)


def test_captions():
    captions = {r.id: r.caption for r in key_table()}
    assert captions["curve"] == "1–9"
    assert captions["from_start"] == "Shift Space"
    assert captions["zoom_in"] == "+"
    assert captions["undo"] == "Ctrl Z"
    assert captions["next_unit"] == "Alt ↓"
    assert key_label("j") == "J"


def test_scopes_divide_the_table():
    assert set(key_table("transport")) | set(key_table("blend")) == set(key_table())
