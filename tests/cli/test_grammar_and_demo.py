"""``corpus-tools grammar`` and ``corpus-tools demo``: sentences in, a simulated corpus out, mistakes told."""

import json

import pytest

from corpus_tools.demo import time_grammar
from corpus_tools.io import find_recordings, load_capture, read_description
from tests.cli.answers import last_json

MINE = """
[grammar]
prompt = ["who", "what"]
who = ["bob", "ann"]
what = ["sings", "naps"]
[lexicon]
bob = "B AA B"
ann = "AE N"
sings = "S IH NG Z"
naps = "N AE P S"
"""


@pytest.fixture
def mine(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(MINE)
    return path


def test_list_prints_every_sentence_or_the_first(tool, mine):
    code, out, _ = tool("grammar", "list")
    assert code == 0
    assert out.splitlines() == list(time_grammar().texts())
    assert tool("grammar", "list", mine)[1].splitlines() == ["bob sings", "bob naps", "ann sings", "ann naps"]
    found = json.loads(tool("grammar", "list", "time", "--limit", "3", "--json")[1])
    assert found == {"grammar": "time", "size": 2880, "sentences": list(time_grammar().texts())[:3]}


def test_sample_is_the_same_for_the_same_seed(tool):
    one, two, other = (tool("grammar", "sample", "--n", "20", "--seed", s)[1].splitlines() for s in "112")
    assert one == two != other
    assert len(set(one)) == 20
    assert set(one) <= set(time_grammar().texts())


def test_cover_tells_what_each_sentence_adds_and_the_coverage(tool, mine):
    data = json.loads(tool("grammar", "cover", mine, "--n", "4", "--json")[1])
    added = [d for row in data["sentences"] for d in row["adds"]]
    assert len(added) == len(set(added)) == data["diphones"]
    assert data["coverage"] == 1.0
    assert {"SIL-B", "B-S", "N-N", "S-SIL"} <= set(added)
    code, out, _ = tool("grammar", "cover", "--n", "6", "--seed", "3")
    assert code == 0
    *rows, last = out.splitlines()
    assert len(rows) == 12
    shares = [float(row.split()[1]) for row in rows[::2]]
    assert shares == sorted(shares)
    assert last.endswith("of the grammar 'time' in 6 sentences.")


@pytest.mark.parametrize(
    ("args", "word"),
    [
        (("list", "gone.toml"), "gone.toml"),
        (("list", "--limit", "0"), "--limit 0"),
        (("sample", "--n", "0"), "from 1 to 2880"),
        (("sample", "--n", "2881"), "from 1 to 2880"),
        (("cover", "--n", "-1"), "--n -1"),
        (("sample", "--seed", "-1"), "--seed"),
        (("recite",), "recite"),
    ],
)
def test_a_mistake_costs_one_sentence(tool, args, word):
    code, out, err = tool("grammar", *args)
    assert (code, out) == (2, "")
    assert word in err
    assert err.count("\n") == 1


def test_demo_makes_a_corpus_of_the_asked_size_and_layout(tool, tmp_path):
    folder = tmp_path / "demo"
    code, out, _ = tool("demo", folder, "--sentences", "2", "--layout", "outer-lips", "--json")
    assert code == 0
    assert "2 simulated recordings, spoken by the embedded voice" in out
    assert last_json(out) == {
        "corpus": str(folder),
        "recordings": 2,
        "simulated": True,
        "voice": "espeak",
    }
    description = read_description(folder)
    files = find_recordings(description)
    assert [f.id for f in files] == ["time01", "time02"]
    assert len(load_capture(description, files[0]).names) == 65


@pytest.mark.parametrize(
    ("args", "word"),
    [
        (("--sentences", "0"), "1 to 2880"),
        (("--sentences", "2881"), "1 to 2880"),
        (("--layout", "inner"), "outer-lips"),
    ],
)
def test_a_demo_that_cannot_be_made_leaves_nothing(tool, tmp_path, args, word):
    code, _, err = tool("demo", tmp_path / "demo", *args)
    assert code == 2
    assert word in err
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_taken_is_refused(tool, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    code, _, err = tool("demo", tmp_path, "--sentences", "1")
    assert code == 2
    assert "is there already" in err
    assert [p.name for p in tmp_path.iterdir()] == ["mine.txt"]
