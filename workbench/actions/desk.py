"""One person's desk: opens corpora, keeps the result up to date with the settings, exports; no Panel."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from corpus_tools.config import ConfigBase, config_with
from corpus_tools.core import WorkbenchError
from corpus_tools.pipeline import OpenCorpus, corpus_provenance
from workbench.actions.corpora import CorpusCache, opened_by
from workbench.actions.export import export_config, export_target, read_config, replay_command, spoken_of
from workbench.actions.jobs import Job, LatestJob
from workbench.state import (
    EDITABLE,
    CorpusFacts,
    Effects,
    Result,
    Session,
    Stages,
    compute_effects,
    corpus_facts,
)

__all__ = ["Desk"]


def _with_opening(config: ConfigBase, other: ConfigBase) -> ConfigBase:
    """Return a config with what the corpus is opened by taken from another."""
    return config_with(
        config,
        **{f"cleaning__{key}": value for key, value in other.cleaning.model_dump().items()},
        selection__components=other.selection.components,
        closure__components=other.closure.components,
        alignment__rate_hz=other.alignment.rate_hz,
    )


class Desk:
    """Ties a session to the work behind it.

    Whatever changes in the session (sentence, a setting) starts a job; the newest request wins, and results
    of older ones never replace newer ones. Two desks share nothing but the cache of opened corpora.

    Parameters
    ----------
    session : Session
    cache : CorpusCache
    deliver : callable
        ``deliver(action)`` runs ``action()`` where the session's parameters may be set.
    """

    def __init__(
        self, session: Session, cache: CorpusCache, deliver: Callable[[Callable[[], None]], None]
    ) -> None:
        self.session = session
        self.cache = cache
        self.stages = Stages()
        self._wanted_sentence: str | None = None
        self.when_opened: Callable[[], None] = lambda: None
        """Called when a corpus has been opened, before anything of it is shown."""
        self._check_of: OpenCorpus | None = None
        self._opening: LatestJob[OpenCorpus] = LatestJob(
            deliver, self._opened, self._not_opened, self._progress
        )
        self._deliver = deliver
        self._asked = 0
        self._moved: tuple[int, Result] | None = None
        self.after_head: Callable[[Callable[[], None]], None] = deliver
        """Runs the newest of some actions when the head has moved and the drag pauses."""
        self._results: LatestJob[Result] = LatestJob(
            deliver, self._arrived, self._refused, idle=lambda: deliver(self._rested)
        )
        self._effects: LatestJob[Effects] = LatestJob(deliver, self._measured, lambda number, sentence: None)
        self._recordings: LatestJob[Result | None] = LatestJob(
            deliver, self._found_recorded, lambda number, sentence: None
        )
        self._others: LatestJob[Result] = LatestJob(deliver, self._compared, lambda number, sentence: None)
        self._heads = Stages()  # of its own: a head in the making must not keep the first one waiting
        self._casts: LatestJob[tuple[Result, ...]] = LatestJob(deliver, self._cast, self._refused_cast)
        self._checks: LatestJob[CorpusFacts] = LatestJob(
            deliver, self._checked, self._not_checked, self._checking
        )
        self._exports: LatestJob[tuple[Path, bool]] = LatestJob(deliver, self._exported, self._not_exported)
        self._on_export: Callable[[str, str, str], None] = lambda kind, text, where: None
        session.param.watch(self._recompute, ["corpus", *EDITABLE])
        session.param.watch(self._after, ["result", "kept", "side"])
        session.param.watch(self._others_speak, ["result", "beside"])

    def open(self, folder: str | Path, sentence: str | None = None) -> None:
        """Open a corpus in the background; the session shows progress, the corpus, or why it could not."""
        self._wanted_sentence = sentence
        self.session.begin_opening(str(folder))
        config = self.session.config
        self._opening.submit(lambda job: self.cache.open(folder, job.progress, config), cancel_running=True)

    def make_and_open(self, make: Callable[[Callable[[float, str], None]], Path]) -> None:
        """Make a corpus (the simulated one), then open it; both with progress and cancel.

        Parameters
        ----------
        make : callable
            ``make(progress) -> folder``.
        """
        self._wanted_sentence = None
        self.session.begin_opening("")
        config = self.session.config

        def work(job: Job) -> OpenCorpus:
            folder = make(lambda f, w: job.progress(0.6 * f, w))
            return self.cache.open(folder, lambda f, w: job.progress(0.6 + 0.4 * f, w), config)

        self._opening.submit(work, cancel_running=True)

    @property
    def busy(self) -> bool:
        """Whether anything is opened, computed or exported."""
        return any(jobs.busy for jobs in (self._opening, self._results, self._exports))

    def cancel(self) -> None:
        """Stop opening, or drop the results that are under way."""
        if self.session.status == "opening":
            self._opening.cancel()
            self.session.opening_cancelled()
        else:
            self._results.cancel()

    def close(self) -> None:
        """End all work; the tab is gone."""
        for jobs in (
            self._opening,
            self._results,
            self._effects,
            self._recordings,
            self._others,
            self._casts,
            self._checks,
            self._exports,
        ):
            jobs.close()

    def _progress(self, number: int, fraction: float, what: str) -> None:
        if self.session.status == "opening":
            self.session.param.update(fraction=min(1.0, max(0.0, fraction)), doing=what)

    def _opened(self, number: int, corpus: OpenCorpus) -> None:
        if self.session.status != "opening":
            return
        self.session.folder = self.session.folder or str(corpus.description.folder)
        try:
            self.session.opened(corpus, self._wanted_sentence)
            self.when_opened()
        except WorkbenchError as error:
            self.session.opening_failed(str(error))

    def _not_opened(self, number: int, sentence: str) -> None:
        self.session.opening_failed(sentence)

    def _arrived(self, number: int, result: Result) -> None:
        """Move the head at once; what else there is to show of a result waits until the head is drawn."""
        if not self.session.move(number, result):
            return
        self._moved, shown = (number, result), self.session.result
        follows = shown is not None and shown.request.same_target(result.request)
        (self.after_head if follows else self._deliver)(self._show)

    def _show(self) -> None:
        """Show all there is to show of the newest result; a drag may be at the next one already."""
        moved, self._moved = self._moved, None
        if moved is None:
            return
        self.session.accept(*moved)
        if moved[0] == self._asked:
            self.session.working = False

    def _rested(self) -> None:
        if self._moved is None and not self._results.busy:
            self.session.working = False

    def _refused(self, number: int, sentence: str) -> None:
        self.session.refuse(number, sentence)

    def _recompute(self, *events: Any) -> None:
        try:
            request = self.session.request()
        except WorkbenchError as error:
            self.session.message = str(error)
            return
        if request is None:
            self._results.cancel()
            self.session.param.update(message="", working=False, moving=None, result=None)
            return
        other_target = any(e.name in ("corpus", "sentence", "text", "target_kind") for e in events)
        self.session.working = True
        self._asked = self._results.submit(
            lambda job: self.stages.run(request, job.check), cancel_running=other_target
        )

    def _after(self, *events: Any) -> None:
        """Measure what the plots show of a result, and compute setting A where it is another one."""
        session, result = self.session, self.session.result
        if result is None:
            session.param.update(effects=None, other=None, recorded=None)
            return
        held = session.recorded
        if held is None or held.head is not result.head or not held.request.same_target(result.request):
            self._recordings.submit(lambda job: self.stages.recorded(result), cancel_running=True)
        if session.effects is None or not session.effects.fits(result):
            self._effects.submit(lambda job: compute_effects(result), cancel_running=True)
        wanted = session.request_of_a()
        shown = session.other.request if session.other is not None else None
        if wanted is None:
            session.other = None
        elif shown is None or not shown.same_target(wanted) or shown.config != wanted.config:
            self._others.submit(lambda job: self.stages.run(wanted, job.check), cancel_running=True)

    def _measured(self, number: int, effects: Effects) -> None:
        if self.session.result is not None and effects.fits(self.session.result):
            self.session.effects = effects

    def _found_recorded(self, number: int, recorded: Result | None) -> None:
        result = self.session.result
        if recorded is None or (result is not None and recorded.request.same_target(result.request)):
            self.session.recorded = recorded

    def _compared(self, number: int, other: Result) -> None:
        wanted = self.session.request_of_a()
        if wanted is not None and wanted.same_target(other.request) and wanted.config == other.request.config:
            self.session.other = other

    def check(self) -> None:
        """Check the open corpus in the background, unless that was done, for `session.facts`."""
        session, corpus = self.session, self.session.corpus
        if corpus is None or self._check_of is corpus:
            return
        self._check_of = corpus
        session.param.update(facts=None, check_doing="reading", check_trouble="")
        self._checks.submit(lambda job: corpus_facts(corpus, job.progress), cancel_running=True)

    def _checking(self, number: int, fraction: float, what: str) -> None:
        self.session.check_doing = f"{what}, {100 * fraction:.0f} %"

    def _checked(self, number: int, facts: CorpusFacts) -> None:
        self.session.check_doing = ""
        if facts.corpus is self.session.corpus:
            self.session.facts = facts

    def _not_checked(self, number: int, sentence: str) -> None:
        self._check_of = None
        self.session.param.update(check_doing="", check_trouble=sentence)

    def _others_speak(self, *events: Any) -> None:
        """Let the heads beside the first speak the same motion."""
        session, result = self.session, self.session.result
        names = tuple(session.beside)
        if result is None or not names:
            self._casts.cancel()
            session.cast = ()
            return

        def work(job: Job) -> tuple[Result, ...]:
            made = []
            for name in names:
                job.check()
                made.append(self._heads.on_head(result, name))
            return tuple(made)

        self._casts.submit(work, cancel_running=True)

    def _cast(self, number: int, cast: tuple[Result, ...]) -> None:
        session = self.session
        wanted = [r.head.mesh.name for r in cast] == list(session.beside)
        if wanted and session.result is not None and cast[0].trajectory is session.result.trajectory:
            session.cast = cast

    def _refused_cast(self, number: int, sentence: str) -> None:
        self.session.param.update(beside=[], message=sentence)

    def take_config(self, config: ConfigBase, name: str) -> None:
        """Take over a config, and what it says was spoken, as one change; corpus and pins must be there.

        Where it cleans otherwise, the corpus is opened anew first.

        Parameters
        ----------
        config : config
        name : str
            Of its file, for the history.
        """
        session = self.session

        def take() -> None:
            session.take_config(config, spoken_of(config, session), f"config {name}")

        if opened_by(config) == opened_by(session.config):
            take()
            return
        before = session.values
        base = _with_opening(session.config, config)

        def again() -> None:
            self.when_opened = lambda: None
            session.restore({**before, "base": base})
            session.begin_history()
            take()

        session.base, self.when_opened = base, again
        self.open(session.folder)

    def open_config(
        self, path: str | Path, done: Callable[[str, str, str], None], beside: Path | None = None
    ) -> None:
        """Take over a config file; parameters and what `done` is told as of :meth:`export`."""
        if self.session.corpus is None:
            done("err", "Open a corpus first: a config says how it is spoken.", "")
            return
        try:
            config = read_config(path, self.cache.root, beside)
        except WorkbenchError as error:
            done("err", str(error), "")
            return
        self.take_config(config, Path(str(path).strip()).name)
        done("opened", "", str(path).strip())

    def export(
        self,
        path: str | Path,
        done: Callable[[str, str, str], None],
        beside: Path | None = None,
        replace: bool = False,
    ) -> None:
        """Write the config in the background.

        Parameters
        ----------
        path : path
            File to write.
        done : callable
            ``done(kind, text, where)``: ("ok", the line that replays it, the file written),
            ("there", one sentence, the config that was not replaced) or ("err", one sentence, "").
        beside : path, optional
            Folder that a path which is not absolute counts from.
        replace : bool
            Replace a config that is there.
        """
        self._on_export = done
        corpus = self.session.corpus
        if corpus is None or self.session.request() is None:
            told = "There is nothing to export yet: open a corpus, and pick or type a sentence first."
            done("err", told, "")
            return

        def work(job: Job) -> tuple[Path, bool]:
            provenance = corpus_provenance(corpus)
            job.check()
            target = export_target(path, self.cache.root, beside)
            if target.exists() and not replace:
                return target, False
            return export_config(self.session, target, provenance, self.cache.root)[0], True

        self._exports.submit(work)

    def _exported(self, number: int, made: tuple[Path, bool]) -> None:
        path, written = made
        if written:
            self._on_export("ok", replay_command(self.session, path), str(path))
        else:
            self._on_export("there", f"'{path}' is there already; export again to replace it.", str(path))

    def _not_exported(self, number: int, sentence: str) -> None:
        self._on_export("err", sentence, "")
