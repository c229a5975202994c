"""What every test shares: one thread, private cache folders, marks by folder, and the real recordings."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path

# before numpy is imported: sums in one order, and no fight over the cores
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import pytest
from hypothesis import HealthCheck, settings

TESTS = Path(__file__).parent
IN_CI = os.environ.get("CI", "").lower() in {"1", "true"}

# folder of tests/ -> the marks that everything in it gets
MARKS_BY_FOLDER = {
    "real": ("real", "slow"),
    "browser": ("browser", "slow"),
    "render": ("render", "slow"),
    "notebooks": ("slow",),
    "benchmarks": ("slow",),
}

# fixture -> the folder whose marks a test gets that asks for it, wherever it stands
MARKS_BY_FIXTURE = {"corpora": "real", "offscreen": "render"}

_common = {
    "deadline": None,
    "database": None,
    "suppress_health_check": [HealthCheck.too_slow],
}
# the same examples on every machine; HYPOTHESIS_PROFILE=thorough looks for new ones
settings.register_profile("quick", max_examples=25, derandomize=True, **_common)
settings.register_profile("thorough", max_examples=500, **_common)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "quick"))


def pytest_configure(config: pytest.Config) -> None:
    """Give the run its own cache, config and data folders, so that it neither sees nor leaves anything."""
    root = Path(tempfile.mkdtemp(prefix="visual-speech-tests-"))
    for variable in ("XDG_CACHE_HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME"):
        folder = root / variable.lower()
        folder.mkdir()
        os.environ[variable] = str(folder)
    config.add_cleanup(lambda: shutil.rmtree(root, ignore_errors=True))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark tests by the folder they stand in, and by the recordings or the drawing that they ask for."""
    for item in items:
        folder = item.path.relative_to(TESTS).parts[0] if item.path.is_relative_to(TESTS) else ""
        asked = {MARKS_BY_FIXTURE.get(name, "") for name in getattr(item, "fixturenames", ())}
        for mark in {m for source in {folder, *asked} for m in MARKS_BY_FOLDER.get(source, ())}:
            item.add_marker(mark)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item):
    """Turn a skip into a failure where nothing is allowed to be missing."""
    report = yield
    if report.skipped and not hasattr(report, "wasxfail") and (reason := skip_forbidden(item.keywords)):
        report.outcome = "failed"
        report.longrepr = f"{item.nodeid} was skipped, {reason}: {report.longrepr}"
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector):
    """Do the same for a whole module that skips itself."""
    report = yield
    in_real = collector.path.is_relative_to(TESTS / "real")
    if report.outcome == "skipped" and in_real and (reason := skip_forbidden({"real"})):
        report.outcome = "failed"
        report.longrepr = f"{collector.nodeid} was skipped, {reason}: {report.longrepr}"
    return report


def skip_forbidden(marks) -> str:
    """Say why a test with these marks may not be skipped; an empty string when it may."""
    if "real" in marks and os.environ.get("SPEECH_CORPORA"):
        return "though SPEECH_CORPORA names the recordings"
    if IN_CI and ("browser" in marks or "render" in marks):
        return "though continuous integration must have a browser and off-screen VTK"
    return ""


@pytest.fixture(scope="session")
def corpora() -> Path:
    """Return the folder of real recordings that SPEECH_CORPORA names; skip when it is unset."""
    named = os.environ.get("SPEECH_CORPORA")
    if not named:
        pytest.skip("SPEECH_CORPORA names no folder with real recordings")
    folder = Path(named)
    if not folder.is_dir():
        pytest.fail(f"SPEECH_CORPORA names '{folder}', which is not a folder.")
    return folder


@pytest.fixture(scope="session")
def offscreen() -> None:
    """Skip, with the package that is missing, where VTK draws nothing without a screen."""
    from corpus_tools.render import probe_offscreen

    if not (status := probe_offscreen()).ok:
        pytest.skip(status.reason)


@pytest.fixture(scope="session")
def project() -> Path:
    """Return the root of the checkout."""
    return TESTS.parent


@pytest.fixture(scope="session")
def simulated_corpus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a simulated corpus; tests must not write into it."""
    from corpus_tools.demo import simulate_corpus

    folder = tmp_path_factory.mktemp("corpus") / "simulated"
    simulate_corpus(folder, n_sentences=14)
    return folder


@pytest.fixture(scope="session")
def opened_corpus(simulated_corpus: Path):
    """Return the simulated corpus, opened with the default config; it is read-only."""
    from corpus_tools.pipeline import open_corpus

    return open_corpus(simulated_corpus)
