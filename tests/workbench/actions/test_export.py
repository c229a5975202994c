"""Export: only configs are replaced, nothing leaves the root, the line can be pasted."""

import shlex

import pytest

from corpus_tools.config import load_config
from corpus_tools.core import InputError, OutputError
from corpus_tools.pipeline.kept import cache_folder
from workbench.actions import (
    export_config,
    export_stem,
    exports_beside,
    inside_root,
    replay_command,
    suggested_path,
)
from workbench.state import Session


def test_a_foreign_file_is_not_overwritten(tmp_path):
    notes = tmp_path / "notes.toml"
    notes.write_text("mine = true\n")
    with pytest.raises(OutputError, match="nothing was overwritten"):
        export_config(Session(), notes)
    assert notes.read_text() == "mine = true\n"


def test_a_config_is_replaced(tmp_path):
    path, _ = export_config(Session(weighting="linear"), tmp_path / "a.toml")
    export_config(Session(weighting="septic"), path)
    assert load_config(path).blend.weighting == "septic"
    assert [p.name for p in tmp_path.iterdir()] == ["a.toml"]


@pytest.mark.parametrize("bad", ["", "   "])
def test_an_empty_path_is_refused(bad):
    with pytest.raises(InputError, match="type where"):
        export_config(Session(), bad)


def test_a_folder_is_refused(tmp_path):
    with pytest.raises(OutputError, match="is a folder"):
        export_config(Session(), tmp_path)


@pytest.mark.parametrize("name", ["x" * 5000, "é" * 150 + ".toml", "/".join(["x" * 100] * 40)])
def test_a_name_that_no_file_can_have_is_refused_and_not_repeated(tmp_path, name):
    with pytest.raises(OutputError, match="too long for a file") as caught:
        export_config(Session(), tmp_path / name)
    assert len(str(caught.value)) < 200


def test_nothing_leaves_the_root(tmp_path):
    root = tmp_path / "root"
    root.mkdir()
    (root / "link").symlink_to(tmp_path)
    for path in (tmp_path / "x.toml", root / ".." / "x.toml", root / "link" / "x.toml"):
        with pytest.raises(InputError, match="outside"):
            export_config(Session(), path, root=root)
    assert inside_root(root / "a" / "b.toml", root) == (root / "a" / "b.toml").resolve()
    assert not (tmp_path / "x.toml").exists()


def test_the_command_can_be_pasted_whatever_the_names():
    session = Session(folder="/my corpora/it's one", sentence="s one")
    parts = shlex.split(replay_command(session, "/tmp/a b.toml"))
    assert parts[:3] == ["corpus-tools", "synth", "/my corpora/it's one"]
    assert parts[parts.index("--utterance") + 1] == "s one"
    assert parts[parts.index("--config") + 1] == "/tmp/a b.toml"
    assert "--include-self" not in parts
    session.held_out = False
    assert "--include-self" in shlex.split(replay_command(session, "c.toml"))


def test_the_suggested_file_is_new(tmp_path):
    assert suggested_path(tmp_path, "blend").name == "blend.toml"
    (tmp_path / "blend.toml").touch()
    (tmp_path / "blend-2.toml").touch()
    assert suggested_path(tmp_path, "blend").name == "blend-3.toml"


def test_the_command_works_from_any_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    parts = shlex.split(replay_command(Session(folder="a corpus", sentence="s"), "c.toml"))
    assert parts[2] == str(tmp_path / "a corpus")
    assert parts[parts.index("--config") + 1] == str(tmp_path / "c.toml")


def test_exports_go_beside_the_corpus_unless_that_is_in_the_cache(tmp_path, monkeypatch):
    assert exports_beside(tmp_path / "corpus") == tmp_path.resolve() / "corpus" / "exports"
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    kept = exports_beside(cache_folder() / "demo")
    assert kept.is_relative_to(tmp_path / "data")
    assert kept.name == "exports"
    # a link into the cache leads there too
    cache_folder().mkdir(parents=True, exist_ok=True)
    (tmp_path / "link").symlink_to(cache_folder())
    assert exports_beside(tmp_path / "link" / "demo") == kept


@pytest.mark.parametrize(
    ("text", "stem"),
    [
        ("Place blue by F 2, now!", "place-blue-by-f-2-now"),
        ("../../etc/passwd", "etc-passwd"),
        ("ça va", "ca-va"),
        ("", "blend"),
        ("?!", "blend"),
        ("x" * 300, "x" * 40),
        ("one two three four five six seven eight nine ten", "one-two-three-four-five-six-seven-eight"),
    ],
)
def test_an_export_is_named_after_what_is_spoken(text, stem):
    assert export_stem(Session(target_kind="text", text=text)) == stem
    assert export_stem(Session(sentence="bbaf2n")) == "bbaf2n"
