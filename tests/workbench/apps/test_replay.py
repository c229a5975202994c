"""What the page exports, the command line makes again: the same bytes of motion."""

import shlex
import subprocess
import sys

import numpy as np
import pytest

from corpus_tools.pipeline import write_motion
from workbench.actions import ban_unit, export_config, replay_command, swap_unit
from workbench.state import Session, Stages


@pytest.mark.slow
def test_the_exported_line_makes_the_same_bytes_of_motion(opened, corpus_folder, tmp_path):
    session = Session(folder=str(corpus_folder))
    session.opened(opened)
    session.param.update(weighting="raised-cosine", shape=0.3, overlap_s=0.09, mesh="female")
    stages = Stages()
    session.accept(1, stages.run(session.request()))
    plain = [c.unit.key for c in session.result.selection.chosen]
    session.select(len(plain) // 2)
    ban_unit(session)
    session.accept(2, stages.run(session.request()))
    swap_unit(session, 1)
    result = stages.run(session.request())
    assert [c.unit.key for c in result.selection.chosen] != plain
    path, _ = export_config(session, tmp_path / "tuned.toml")
    line = replay_command(session, path)
    words = shlex.split(line)
    assert words[0] == "corpus-tools"
    command = [sys.executable, "-c", "from corpus_tools.cli.main import run; run()", *words[1:]]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    made = tmp_path / f"{session.sentence}_out"
    write_motion(tmp_path / "page.npz", result.trajectory)
    assert (made / "motion.npz").read_bytes() == (tmp_path / "page.npz").read_bytes()
    vertices = np.load(made / "mesh.npz")["vertices_mm"]
    assert vertices.shape[1] == result.head.mesh.n_vertices


@pytest.mark.slow
def test_a_typed_sentence_is_replayed_with_its_pins(opened, corpus_folder, tmp_path):
    session, stages = Session(folder=str(corpus_folder)), Stages()
    session.opened(opened)
    session.param.update(target_kind="text", text="the time is 9:30, isn't it", overlap_s=0.08)
    session.accept(1, stages.run(session.request()))
    assert session.result.request.exclude == ()
    session.select(1)
    swap_unit(session, 1)
    result = stages.run(session.request())
    path, _ = export_config(session, tmp_path / "typed.toml")
    words = shlex.split(replay_command(session, path))
    command = [sys.executable, "-c", "from corpus_tools.cli.main import run; run()", *words[1:]]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    write_motion(tmp_path / "page.npz", result.trajectory)
    assert (tmp_path / "text_out" / "motion.npz").read_bytes() == (tmp_path / "page.npz").read_bytes()
