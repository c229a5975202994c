"""The first page: a sentence of the corpus, the fragments that speak it, g(u), the moving head, export."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import panel as pn

from corpus_tools.config import ConfigBase
from corpus_tools.core import counted
from workbench.actions import (
    CorpusCache,
    Desk,
    Gate,
    Journal,
    ban_unit,
    export_stem,
    exports_beside,
    heard,
    suggested_path,
    swap_unit,
    toggle_pin,
)
from workbench.state import Session, resume
from workbench.views.bar import AppBar
from workbench.views.controls import Controls
from workbench.views.export_box import ExportBox
from workbench.views.fragment_inspector import FragmentInspector
from workbench.views.latest import AfterPainted
from workbench.views.settings_panel import PRESETS, SettingsPanel
from workbench.views.shell import Shell
from workbench.views.transport import Transport
from workbench.views.welcome import Welcome
from workbench.views.work_board import BlendBoard

__all__ = ["DASHBOARDS", "BlendPage"]

DASHBOARDS = [{"id": "corpus", "label": "Corpus"}, {"id": "blend", "label": "Blend"}]
"""What the rail shows: only what exists."""

_STATUS_KEYS = [
    "play",
    "next_join",
    "next_unit",
    "pin",
    "ban",
    "hear",
    "sides",
    "curve",
    "overlap",
    "undo",
    "help",
]
_clocks = itertools.count(1)


class BlendPage:
    """One browser tab: session, desk and views, wired together.

    Parameters
    ----------
    cache : CorpusCache
        Shared by the tabs of a server.
    make_demo : callable
        ``make_demo(progress) -> folder`` of the simulated starter corpus.
    export_folder : path or None
        Where configs are written unless another place is typed; None: beside the open corpus.
    deliver : callable
        Runs an action where this tab's parameters may be set; not called before the browser has the page.
    fill : bool
        Fill the window; False in a notebook cell.
    begin : str
        Dashboard that is shown first.
    home : str
        What the server shows at first; a tab that is reloaded goes on where it was at this home.
    config : (config, name of its file), optional
        Taken over when the first corpus has been opened.
    """

    def __init__(
        self,
        cache: CorpusCache,
        make_demo: Callable[[Callable[[float, str], None]], Path],
        export_folder: Path | None,
        deliver: Callable[[Callable[[], None]], None],
        fill: bool = True,
        begin: str = "blend",
        home: str = "",
        config: tuple[ConfigBase, str] | None = None,
    ) -> None:
        self._begin, self._make_on_arrival = begin, False
        self.session = Session(config[0] if config is not None else None)
        self._gate = Gate(deliver)
        self.desk = Desk(self.session, cache, self._gate)
        self.journal = Journal(self.session, home, self._gate)
        if config is not None:
            self.desk.when_opened = lambda: self._first_config(*config)
        self._make_demo = make_demo
        self._picking = False
        clock = f"page-{next(_clocks)}"
        self.controls = Controls(self.session)
        self.bar = AppBar(
            self.session,
            self.controls,
            on_corpus=lambda: self.show("corpus"),
            on_speak=lambda: self._gate.asked(self._speak_text),
        )
        self._plays_next = False
        self.transport = Transport(session=clock, theme=self.session.theme, margin=0)
        self.board = BlendBoard(self.session, self.controls, clock, self.desk.cancel)
        self.board.board.on_tab = lambda tab, earlier: self._gate.asked(lambda: self._came(tab, earlier))
        self.desk.after_head = AfterPainted(self.board.face.mesh_view.line, self._gate)
        self.inspector = FragmentInspector(self.session, self._hear)
        self._export_folder = export_folder
        self.export = ExportBox(
            self.controls,
            on_export=self._export,
            on_open=lambda path, done: self.desk.open_config(path, done, self.exports),
        )
        self.welcome = Welcome(
            self.session,
            self.controls,
            on_open=self.desk.open,
            on_demo=self.open_demo,
            on_cancel=self.desk.cancel,
            on_back=lambda: self.show("blend"),
            on_speak=self._speak,
        )
        self.shell = Shell(
            on_key=lambda action, index: self._gate.asked(lambda: self._key(action, index)),
            on_rail=lambda name: self._gate.asked(lambda: self.show(name)),
            # a change before the document is known to be there would be taken for sent with it
            on_ready=lambda: pn.state.onload(lambda: deliver(self.arrived)),
            bar=self.bar.__panel__(),
            transport=self.transport,
            work=self.board.__panel__(),
            start=self.welcome.__panel__(),
            starting=True,
            inspector=self.inspector.pane,
            inspector_foot=pn.Column(
                SettingsPanel(self.session, self.controls).__panel__(),
                self.export.__panel__(),
                sizing_mode="stretch_width",
                margin=0,
            ),
            dashboards=DASHBOARDS,
            active="corpus",
            status_keys=_STATUS_KEYS,
            session=clock,
            theme=self.session.theme,
            fill=fill,
        )
        self._watch()
        self._status()

    def _watch(self) -> None:
        watch = self.session.param.watch
        watch(self._theme, "theme")
        watch(self._status, ["status", "working", "result", "corpus", "fraction", "message", "check_doing"])
        watch(self._corpus, "corpus")
        watch(self._opening, "status")
        watch(self._sound, "result")
        watch(self._not_spoken, ["message", "target_kind", "corpus"])
        watch(self._suggest, ["corpus", "target_kind", "sentence", "text"])

    def arrived(self) -> None:
        """Take up what was done while the page was on its way: the browser has it."""
        self._gate.open()
        wanted, self._make_on_arrival = self._make_on_arrival, False
        if wanted and self.session.status == "opening":  # not when Esc came first
            self.open_demo()

    def _first_config(self, config: ConfigBase, name: str) -> None:
        """Begin with the pins and the sentence of a config, by which the corpus was opened."""
        self.desk.when_opened = lambda: None
        self.desk.take_config(config, name)
        self.session.begin_history()

    def _came(self, tab: str, earlier: str) -> None:
        """Go on where a tab was before it was reloaded."""
        record = self.journal.begin(tab, earlier)
        session = self.session
        if record is None or len(session.history.entries) > 1:
            self.journal.note()
            return

        def go_on() -> None:
            self.desk.when_opened = lambda: None
            if session.folder == record["folder"]:
                resume(session, record)

        open_now = session.corpus is not None and session.status == "ready"
        if open_now and session.folder == record["folder"]:
            go_on()
        else:
            self.desk.when_opened = go_on
            if not self._make_on_arrival and session.folder != record["folder"]:
                self.desk.open(record["folder"])

    def show(self, dashboard: str) -> None:
        """Show the corpus page or the blend page; without a corpus, open or on its way, only the first."""
        have = self.session.corpus is not None or self.session.status == "opening"
        blend = dashboard == "blend" and have
        self.shell.param.update(starting=not blend, active="blend" if blend else "corpus")
        if not blend:
            self.desk.check()

    def _speak_text(self) -> None:
        """Play the typed text: now when it is there, else as soon as it is."""
        result, request = self.session.result, self.session.request()
        if result is not None and request is not None and result.request.same_target(request):
            self.transport.play()
        else:
            self._plays_next = self.session.working or not self.session.message  # refused: nothing will come

    def _not_spoken(self, *events: Any) -> None:
        """Forget what Enter asked for: the text was refused, or left; another must not play by itself."""
        if any(event.new for event in events):
            self._plays_next = False

    def _speak(self, recording: str) -> None:
        self.session.param.update(target_kind="recording", sentence=recording)
        self.show("blend")

    def open(self, folder: Path) -> None:
        """Open a corpus, and show the dashboard to begin with meanwhile."""
        self.desk.open(folder)
        self.show(self._begin)

    def open_demo(self) -> None:
        """Make and open the simulated starter corpus."""
        self.desk.make_and_open(self._make_demo)
        self.show(self._begin)

    def open_demo_later(self) -> None:
        """Make the simulated corpus when the browser has the page: until then the page goes first."""
        self._make_on_arrival = True
        self.session.begin_opening("")
        self.show(self._begin)

    def _corpus(self, event: Any) -> None:
        if event.new is not None:
            self.shell.page_title = f"{event.new.description.name} – blend"
            self.show(self._begin)
            self._begin = "blend"

    @property
    def exports(self) -> Path | None:
        """Folder that configs are written to unless another is typed; None without a corpus."""
        corpus = self.session.corpus
        beside = exports_beside(corpus.description.folder) if corpus is not None else None
        return self._export_folder or beside

    def _export(self, path: str, replace: bool, done: Callable[[str, str, str], None]) -> None:
        def said(kind: str, text: str, where: str) -> None:
            done(kind, text, where)
            self._suggest()

        if path == self.export.suggested:  # it may have been written since, by another tab
            self._suggest()
            path = self.export.suggested
        self.desk.export(path, said, self.exports, replace)

    def _suggest(self, *events: Any) -> None:
        """Suggest a file for what is spoken that does not exist yet."""
        if self.exports is not None:
            self.export.suggest(str(suggested_path(self.exports, export_stem(self.session))))

    def _opening(self, event: Any) -> None:
        if event.new in ("empty", "error"):
            self.show("corpus")

    def _theme(self, event: Any) -> None:
        self.shell.theme = self.transport.theme = event.new

    def _sound(self, event: Any) -> None:
        result, old = event.new, event.old
        if result is not None and self.export.kind == "err":  # what it complains of may be mended
            self.export.show("", "")
        if result is None:
            self.transport.load_sound(None, 0.0)
        elif old is None or not old.request.same_target(result.request):
            plays, self._plays_next = self._plays_next and bool(result.request.text), False
            self.transport.load(result.utterance, result.request.corpus.phones, plays)

    def _hear(self, option: int | None) -> None:
        sound = heard(self.session, option)
        if sound is not None:
            self.transport.hear(sound)

    def _play_fragment(self) -> None:
        result, selected = self.session.result, self.session.selected
        if result is None:
            return
        shown = self.board.lane.score["fragments"]
        if selected < len(shown):
            self.transport.play(shown[selected]["start"], shown[selected]["end"])

    def _key(self, action: str, index: int) -> None:
        if action == "curve":
            if index < len(PRESETS) and self.session.mode == "crossfade":
                self.session.weighting = list(PRESETS.values())[index]
        elif action in self.commands:
            self.commands[action]()

    @property
    def commands(self) -> dict[str, Callable[[], object]]:
        """What keys do that reach the server: action -> command."""
        session = self.session
        return {
            "previous_sentence": lambda: session.step_sentence(-1),
            "next_sentence": lambda: session.step_sentence(1),
            "next_unit": lambda: swap_unit(session, 1),
            "previous_unit": lambda: swap_unit(session, -1),
            "pin": lambda: toggle_pin(session),
            "ban": lambda: ban_unit(session),
            "hear": lambda: self._hear(None),
            "play_selection": self._play_fragment,
            "sides": session.swap_sides,
            "undo": session.undo,
            "redo": session.redo,
            "export": self.export.submit,
            "theme": self.bar.toggle_theme,
            "view": self.board.switch_view,
            "camera": self.board.reset_camera,
            "cancel": self.desk.cancel,
        }

    def _status(self, *events: Any) -> None:
        s = self.session
        left = "No corpus open"
        if s.corpus is not None:
            skipped = len(s.corpus.skipped)
            left = f"✓ {s.corpus.description.name}: {counted(len(s.corpus.names), 'recording')}"
            left += f", ▲ {skipped} left out" if skipped else ""
        measured = ""
        if s.result is not None and s.result.ran:
            measured = f"{', '.join(s.result.ran)} in <b>{s.result.elapsed_ms:.0f} ms</b>"
        jobs = "idle"
        if s.status == "opening":
            jobs = f"opening, {100 * s.fraction:.0f} %"
        elif s.working:
            jobs = "computing · Esc cancels"
        elif s.check_doing:
            jobs = "checking the corpus"
        self.shell.param.update(status_text=left, measured=measured, jobs_text=jobs)

    def close(self) -> None:
        """End this tab's work."""
        self.desk.close()
        self.journal.close()
