import pytest

from corpus_tools.config import Config, config_with, write_config
from corpus_tools.io import find_recordings, read_description
from tests.cli.answers import last_json, refused


@pytest.fixture
def one(simulated_corpus):
    return find_recordings(read_description(simulated_corpus))[0].id


def test_warps_compares_both_warps_and_both_ways_of_resampling(tool, simulated_corpus, one):
    code, out, err = tool("warps", simulated_corpus, "--utterance", one, "--json")
    assert code == 0, err
    found = last_json(out)
    assert found["utterance"] == one
    ways = {(w["warp"], w["resampling"]): w for w in found["ways"]}
    assert len(ways) == 4
    assert ways["linear", "inverse"]["rms_mm"] == 0
    assert all(w["cond"] < 1e12 for w in found["ways"])
    assert all(one not in s["source"] for s in found["stretches"])  # held out
    lines = out.splitlines()
    assert sum(line.startswith(("linear", "pchip")) for line in lines) == 4
    assert any(
        line.startswith("Most stretched") and found["stretches"][0]["source"] in line for line in lines
    )


def test_warps_takes_what_synth_takes_and_refuses_in_a_sentence(tool, simulated_corpus, one):
    refused(tool("warps", simulated_corpus), "--text", "--utterance", "--labels")
    refused(tool("warps", simulated_corpus, "--utterance", "nobody"), "nobody")


def test_a_class_of_phones_has_a_weighting_of_its_own(tool, simulated_corpus, one, tmp_path):
    """The config reaches the joins; what fits no join of the utterance is refused."""
    file = tmp_path / "c.toml"
    write_config(file, config_with(Config(), blend__weighting_at=("open=linear", "0=septic:0.5")))
    code, _, err = tool(
        "synth", simulated_corpus, "--utterance", one, "--config", file, "--out", tmp_path / "o"
    )
    assert code == 0, err
    write_config(file, config_with(Config(), blend__weighting_at=("99=linear",)))
    refused(
        tool("synth", simulated_corpus, "--utterance", one, "--config", file, "--out", tmp_path / "p"),
        "join 99",
    )
    assert not (tmp_path / "p").exists()
