"""A config is taken up again: as one change, with its sentence; a wrong one changes nothing."""

from corpus_tools.config import config_with
from workbench.actions import export_config


def test_an_export_is_opened_again_with_its_sentence_as_one_change(desk_of, corpus_folder, tmp_path):
    desk, loop = desk_of()
    session, said = desk.session, []
    desk.open(corpus_folder)
    loop.until(lambda: session.result is not None and not session.working)
    first = session.values
    session.sentence = session.sentences[5]
    session.param.update(weighting="septic", bans=("time03",), held_out=False)
    wanted = session.values
    path, _ = export_config(session, tmp_path / "mine.toml")
    session.go_to(0)
    desk.open_config("mine", lambda *told: said.append(told), tmp_path)
    assert said[-1][0] == "opened"
    assert {**session.values, "base": None} == {**wanted, "base": None}
    assert session.undo()
    assert session.values == first
    session.param.update(target_kind="text", text="the time is two")
    export_config(session, tmp_path / "text.toml")
    session.go_to(0)
    desk.open_config(tmp_path / "text.toml", lambda *told: said.append(told))
    assert session.target == ("text", "the time is two")
    loop.until(lambda: not session.working)
    before = session.values
    path.write_text(path.read_text().replace("septic", "septik").replace("[blend]", "[blend]\nshap = 1"))
    for bad, words in (
        (path, "did you mean 'shape'"),
        (tmp_path / "no.toml", "no config file"),
        ("", "type which"),
    ):
        desk.open_config(bad, lambda *told: said.append(told), tmp_path)
        assert said[-1][0] == "err"
        assert words in said[-1][1]
    assert session.values == before


def test_a_config_that_cleans_otherwise_opens_the_corpus_anew(desk_of, corpus_folder, tmp_path):
    desk, loop = desk_of()
    session = desk.session
    desk.open(corpus_folder)
    loop.until(lambda: session.result is not None and not session.working)
    was, first = session.corpus, session.values
    desk.take_config(config_with(session.config, cleaning__cutoff_hz=9.0, blend__weighting="bump"), "a.toml")
    loop.until(lambda: session.corpus is not was and session.result is not None and not session.working)
    assert session.config.cleaning.cutoff_hz == 9.0
    assert session.weighting == "bump"
    assert session.undo()
    assert session.config.cleaning.cutoff_hz == 9.0  # by which the corpus is open
    assert {**session.values, "base": None} == {**first, "base": None}
