"""TextGrids survive a round trip whatever stands in their labels, and broken ones are refused by name."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from corpus_tools.core import InputError, Interval, LabelError, Labels, Point, PointTier, Tier
from corpus_tools.io import read_labels, write_textgrid

FORMATS = ("long", "short", "json")
# words that praatio searches for, quotes, IPA, blanks, line ends: all may stand in a label
TRAPS = [
    "",
    " ",
    '"',
    '""',
    'say "hi"',
    "item [1]:",
    "intervals [2]:",
    '"IntervalTier"',
    "IntervalTier",
    "TextTier",
]
TRAPS += [
    'class = "TextTier"',
    "xmin = 3",
    "<exists>",
    "size = 2",
    "a\nb",
    " ʃ̩ˈæ ",
    "a\u2028b",
    "é",
    "日本",
    "\\",
    "7",
]
TEXTS = st.one_of(
    st.sampled_from(TRAPS),
    st.text(st.characters(exclude_categories=("Cs",), exclude_characters="\r"), max_size=6),
)


@st.composite
def labels_of_any_kind(draw):
    end = draw(st.floats(1, 1e4))
    names = draw(st.lists(TEXTS, min_size=1, max_size=3, unique=True))
    tiers = []
    for name in names:
        inner = draw(st.lists(st.floats(0, end), max_size=5, unique=True))
        if draw(st.booleans()):
            tiers.append(PointTier(name, tuple(Point(t + 0.0, draw(TEXTS)) for t in inner)))
            continue
        edges = [0.0]
        edges += [t for t in sorted(inner) if 1e-5 < t < end - 1e-5]
        edges = [a for a, b in zip(edges, [*edges[1:], end], strict=True) if b - a > 1e-5 or a == 0.0]
        edges = [0.0, *edges[1:], end]
        spans = itertools.pairwise(edges)
        tiers.append(Tier(name, tuple(Interval(a, b, draw(TEXTS)) for a, b in spans)))
    return Labels(tuple(tiers), 0.0, end)


def file_for(folder, form):
    return folder / ("a.json" if form == "json" else "a.TextGrid")


def row(*texts, name="phones", end=1.0):
    width = end / len(texts)
    spans = [Interval(k * width, (k + 1) * width, t) for k, t in enumerate(texts)]
    return Tier(name, tuple(spans))


@pytest.mark.parametrize("form", FORMATS)
@given(labels=labels_of_any_kind())
@example(labels=Labels((PointTier("p", (Point(0.1, 'say "hi"'), Point(0.2, ""))),), 0.0, 1.0))
@example(labels=Labels((row(*TRAPS), row('"TextTier"', "x", name='"IntervalTier"')), 0.0, 1.0))
@example(labels=Labels((Tier("a", (Interval(0, 1e-5, "q"), Interval(1e-5, 1.0, "r"))),), 0.0, 1.0))
@example(labels=Labels((PointTier("none", ()), row("x")), 0.0, 1.0))
def test_what_is_written_is_read(tmp_path_factory, form, labels):
    path = file_for(tmp_path_factory.mktemp("round"), form)
    write_textgrid(path, labels, form)
    assert read_labels(path) == labels
    first = path.read_bytes()
    write_textgrid(path, read_labels(path), form)
    assert path.read_bytes() == first


def test_the_long_format_is_praats(tmp_path):
    labels = Labels((row("", 'A"', end=0.5), PointTier("pitch", (Point(0.25, "120"),))), 0.0, 0.5)
    write_textgrid(tmp_path / "a.TextGrid", labels)
    assert (tmp_path / "a.TextGrid").read_bytes().decode() == (
        'File type = "ooTextFile"\nObject class = "TextGrid"\n\nxmin = 0 \nxmax = 0.5 \n'
        "tiers? <exists> \nsize = 2 \nitem []: \n    item [1]:\n"
        '        class = "IntervalTier" \n        name = "phones" \n        xmin = 0 \n        xmax = 0.5 \n'
        "        intervals: size = 2 \n"
        '        intervals [1]:\n            xmin = 0 \n            xmax = 0.25 \n            text = "" \n'
        "        intervals [2]:\n            xmin = 0.25 \n            xmax = 0.5 \n"
        '            text = "A""" \n'
        '    item [2]:\n        class = "TextTier" \n        name = "pitch" \n        xmin = 0 \n'
        "        xmax = 0.5 \n        points: size = 1 \n"
        '        points [1]:\n            number = 0.25 \n            mark = "120" \n'
    )


@pytest.mark.parametrize("form", FORMATS)
def test_blanks_stay_and_holes_become_blanks(tmp_path, form):
    holed = Labels((Tier("phones", (Interval(0.2, 0.4, "AH"), Interval(0.4, 0.5, ""))),), 0.0, 1.0)
    write_textgrid(file_for(tmp_path, form), holed, form)
    tier = read_labels(file_for(tmp_path, form)).tier("phones")
    assert [(i.start_s, i.end_s, i.text) for i in tier] == [
        (0.0, 0.2, ""),
        (0.2, 0.4, "AH"),
        (0.4, 0.5, ""),
        (0.5, 1.0, ""),
    ]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("form", FORMATS)
def test_praats_encodings_and_line_ends(tmp_path, encoding, line_end, form):
    labels = Labels((row("ʃ", "", "ɔɪ"), PointTier("p", (Point(0.5, "né"),))), 0.0, 1.0)
    path = file_for(tmp_path, form)
    write_textgrid(path, labels, form)
    mark = {"utf-16-le": b"\xff\xfe", "utf-16-be": b"\xfe\xff"}.get(encoding, b"")
    path.write_bytes(mark + path.read_text("utf-8").replace("\n", line_end).encode(encoding))
    assert read_labels(path) == labels


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("last", ["interval", "point", "empty"])
def test_cut_anywhere_it_is_refused_or_whole(tmp_path, form, last):
    # a cut between the halves of a doubled quote that ends the file leaves a valid file: no reader can tell
    points = () if last == "empty" else (Point(0.25, "x"), Point(0.75, "yz"))
    tiers = [row("AH", "", "long label"), PointTier("p", points)]
    labels = Labels(tuple(tiers if last != "interval" else tiers[::-1]), 0.0, 1.0)
    path = file_for(tmp_path, form)
    write_textgrid(path, labels, form)
    data = path.read_bytes()
    refused = 0
    for n in range(len(data)):
        path.write_bytes(data[:n])
        try:
            assert read_labels(path) == labels, f"cut at {n}"
        except InputError as error:
            refused += path.name in str(error)
    assert refused >= len(data) - 3  # only blanks and the last line end may be missing


HEAD = 'File type = "ooTextFile"\nObject class = "TextGrid"\n\n0\n1\n<exists>\n'
BROKEN = {
    "another file": ("a.TextGrid", b"RIFF....WAVEfmt ", "ooTextFile"),
    "binary": ("a.TextGrid", bytes(range(256)) * 4, "TextGrid"),
    "no text": ("a.TextGrid", b"\xff\xfe\x00", "TextGrid"),
    "another object": (
        "a.TextGrid",
        b'File type = "ooTextFile"\nObject class = "Pitch 1"\n\n0\n1\n',
        "'TextGrid'",
    ),
    "no tiers": ("a.TextGrid", HEAD.encode() + b"0\n", "TextGrid"),
    "overlap": (
        "a.TextGrid",
        HEAD.encode() + b'1\n"IntervalTier"\n"ph"\n0\n1\n2\n0\n0.6\n"a"\n0.5\n1\n"b"\n',
        "starts at 0.5 s",
    ),
    "no length": (
        "a.TextGrid",
        HEAD.encode() + b'1\n"IntervalTier"\n"ph"\n0\n1\n1\n0.5\n0.5\n"a"\n',
        "ends at 0.5",
    ),
    "outside": (
        "a.TextGrid",
        HEAD.encode() + b'1\n"TextTier"\n"p"\n0\n1\n1\n1.5\n"a"\n',
        "1.5 s lies outside",
    ),
    "same names": (
        "a.TextGrid",
        HEAD.encode() + b'2\n"TextTier"\n"p"\n0\n1\n0\n"TextTier"\n"p"\n0\n1\n0\n',
        "two tiers are called 'p'",
    ),
    "negative, short": (
        "a.TextGrid",
        HEAD.encode() + b'1\n"TextTier"\n"p"\n-1\n1\n1\n-0.5\n"a"\n',
        "below 0 s",
    ),
    "more than said": (
        "a.TextGrid",
        HEAD.encode() + b'1\n"TextTier"\n"p"\n0\n1\n1\n0.1\n"a"\n0.2\n"b"\n',
        "has 1 labels and holds 2",
    ),
    "latin-1": (
        "a.TextGrid",
        HEAD.encode() + b'1\n"TextTier"\n"\xe9"\n0\n1\n0\n',
        "(it is neither UTF-8 nor",
    ),
    "a size of 5000 digits": (
        "a.TextGrid",
        HEAD.encode() + b'1\n"TextTier"\n"p"\n0\n1\n' + b"9" * 5000 + b"\n",
        "(a number in it is too long)",
    ),
    "a word for a size": (
        "a.TextGrid",
        HEAD.encode() + b'1\n"TextTier"\n"p"\n0\n1\nmany\n',
        "holds 0 whole ones",
    ),
    "a quotation mark in a label": (
        "a.TextGrid",
        HEAD.replace("0\n1\n", "xmin = 0\nxmax = 1\n").replace("<", "tiers? <").encode()
        + b'size = 1\nitem []:\n    item [1]:\n        class = "TextTier"\n        name = "p"\n'
        + b"        xmin = 0\n"
        + b"        xmax = 1\n        points: size = 1\n        points [1]:\n            number = 0.5\n"
        + b'            mark = "say "hi" now"\n',
        "a quotation mark within a label is not doubled",
    ),
    "a word for a time": (
        "a.json",
        b'{"xmin":0,"xmax":"end","tiers":[]}',
        "('end' stands where a number was expected)",
    ),
    "JSON with 5000 digits": ("a.json", b'{"xmin":' + b"9" * 5000 + b"}", "it is no JSON with xmin"),
    "JSON of another kind": ("a.json", b'{"a": 1}', "praatio"),
    "JSON list": ("a.json", b"[1, 2]", "TextGrid"),
    "deep JSON": ("a.json", b'{"xmin":0,"xmax":1,"tiers":' + b"[" * 100_000, "TextGrid"),
    "JSON with a number for a label": (
        "a.json",
        b'{"xmin":0,"xmax":1,"tiers":[{"class":"TextTier","name":"p","xmin":0,"xmax":1,"entries":[[0.5,3]]}]}',
        "no text",
    ),
    "JSON with no time": (
        "a.json",
        b'{"xmin":0,"xmax":1,"tiers":[{"class":"TextTier","name":"p","xmin":0,"xmax":1,"entries":[[NaN,"a"]]}]}',
        "outside the range",
    ),
    "JSON without end": (
        "a.json",
        b'{"xmin":0,"xmax":Infinity,"tiers":[{"class":"TextTier","name":"p","xmin":0,"xmax":1,"entries":[]}]}',
        "range",
    ),
}


@pytest.mark.parametrize("what", BROKEN)
def test_a_broken_file_is_named_in_one_sentence(tmp_path, what):
    name, data, words = BROKEN[what]
    (tmp_path / name).write_bytes(data)
    with pytest.raises(LabelError) as caught:
        read_labels(tmp_path / name)
    message = str(caught.value)
    assert str(tmp_path / name) in message
    assert words in message
    assert "\n" not in message
    assert not any(w in message for w in ("literal", "int()", "sys.", "digits", "codec", "Error")), message
    assert (tmp_path / name).read_bytes() == data


def test_a_negative_time_of_the_long_format_never_loses_its_sign(tmp_path):
    path = tmp_path / "a.TextGrid"
    write_textgrid(path, Labels((PointTier("p", (Point(0.5, "-0.5"),)),), 0.0, 1.0))
    assert read_labels(path).tiers[0].points == (Point(0.5, "-0.5"),)
    path.write_text(path.read_text().replace("number = 0.5", "number = -0.5"))
    with pytest.raises(LabelError, match="below 0 s"):
        read_labels(path)


@pytest.mark.parametrize(
    ("labels", "words"),
    [
        (Labels((), 0.0, 1.0), "no tiers"),
        (Labels((row("a"), row("b")), 0.0, 1.0), "two tiers"),
        (Labels((row("a"),), 0.0, 0.5), "outside the range"),
        (Labels((row("a"),), -1.0, 1.0), "range"),
        (Labels((PointTier("p", (Point(float("nan"), "a"),)),), 0.0, 1.0), "outside the range"),
        (Labels((row("\ud800"),), 0.0, 1.0), "Unicode"),
    ],
)
@pytest.mark.parametrize("form", FORMATS)
def test_what_no_textgrid_can_hold_is_not_written(tmp_path, labels, words, form):
    with pytest.raises(LabelError, match=words) as caught:
        write_textgrid(tmp_path / "a.TextGrid", labels, form)
    assert "a.TextGrid" in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_an_unknown_format_is_refused(tmp_path):
    with pytest.raises(InputError, match="did you mean 'short'"):
        write_textgrid(tmp_path / "a.TextGrid", Labels((row("a"),), 0.0, 1.0), "shrot")
