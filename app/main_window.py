"""The window: puts the panels together and carries out the actions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PySide6.QtCore import QEvent, QObject, Qt, QTimer
from PySide6.QtGui import (
    QCloseEvent,
    QDragEnterEvent,
    QDropEvent,
    QKeyEvent,
    QShowEvent,
)
from PySide6.QtWidgets import (
    QApplication,
    QFrame,
    QHBoxLayout,
    QLabel,
    QMainWindow,
    QMessageBox,
    QScrollArea,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from app import theme
from app.actions import ACTIONS, keys_of
from app.clean.section import CleanSection
from app.curves.lane import GUTTER_PX
from app.curves.panel import CurvesPanel
from app.curves.tools import TOOLS
from app.edit_actions import EditActions
from app.file_actions import FileActions
from app.inference import Inference
from app.inspector.brush import BrushSection
from app.inspector.facts import FactsSection
from app.inspector.panel import Inspector
from app.inspector.smooth import SmoothSection
from app.inspector.value import ValueSection
from app.keeper import Keeper
from app.live.section import LiveSection
from app.menus import Menus
from app.notes.section import NotesSection
from app.notices import Notices
from app.pins.section import PinsSection
from app.playback.media import Media
from app.preview.panel import PreviewPanel
from app.preview.reference import ReferencePanel
from app.session import Change, Session
from app.settings import Settings
from app.spans.filling import Filling
from app.spans.section import SpansSection
from app.theme import GRID
from app.time_actions import TimeActions
from app.timeline.panel import SCROLL_PX, Timeline, TimeScroll
from app.transport import Transport
from engine.take import Take, timecode


class MainWindow(QMainWindow):
    """One window on one take.

    Parameters
    ----------
    take, path : what to open, and the file it came from
    settings : what is remembered
    unsaved : the folder for unsaved work; the user's own without one
    """

    def __init__(
        self,
        take: Take,
        path: Path | None = None,
        settings: Settings | None = None,
        *,
        unsaved: Path | None = None,
    ) -> None:
        super().__init__()
        self.settings = settings or Settings()
        self.colours = theme.LIGHT if self.settings.light else theme.DARK
        self.session = Session(take)
        self.keeper = Keeper(self.session, unsaved)
        self.inference = Inference(self.session)
        self.transport = Transport(self.session)
        self.media = Media(self.session, self.transport)
        self.files = FileActions(self.session, self.keeper, self.media, self.settings, self)
        self.notices = Notices()
        self.preview = PreviewPanel(self.session, self.inference)
        self.reference = ReferencePanel(self.session)
        self.curves = CurvesPanel(self.session, self.inference, self.colours)
        self.timeline = Timeline(self.session, self.colours, gutter_px=GUTTER_PX)
        self.filling = Filling(self.session)
        self.edits = EditActions(self.session, self.inference, self.curves, self.filling)
        self.time = TimeActions(self.session, self.transport, self.filling)
        self.brush, self.value = BrushSection(self.session), ValueSection(self.session)
        self.pins, self.clean = PinsSection(self.session, self.inference), CleanSection(self.session, self.inference)
        self.smoothing, self.facts = SmoothSection(self.session), FactsSection(self.session)
        self.spans = SpansSection(self.session, self.filling)
        self.live = LiveSection(self.session)
        self.notes = NotesSection(self.session)
        sections = (
            self.brush,
            self.value,
            self.pins,
            self.clean,
            self.live,
            self.smoothing,
            self.spans,
            self.facts,
            self.notes,
        )
        self.inspector = Inspector(self.session, sections)
        self._latencies_ms: list[float] = []
        self.setAcceptDrops(True)
        self.menus = Menus(self, self.settings, self._do, self.files.load)
        self.actions_by_name = self.menus.actions
        self._show_tool()
        self._lay_out()
        self._connect()
        self.setStyleSheet(theme.style_sheet(self.colours))
        self.resize(1440, 900)
        self.session.open(take, path)
        self._show_opened()

    # --- building

    def _do(self, name: str) -> None:
        owners = (self, self.files, self.edits, self.time)
        owner = next(each for each in owners if name in type(each).__dict__)
        getattr(owner, name)()

    def _lay_out(self) -> None:
        self.preview.add_beneath(self.reference)
        lanes = QFrame()
        lanes.setProperty("panel", True)
        stack = QVBoxLayout(lanes)
        stack.setContentsMargins(1, 6, 1, 4)
        stack.setSpacing(2)
        stack.addWidget(self.timeline)
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOn)
        area.setWidget(self.curves)
        stack.addWidget(area, 1)
        scroll = QHBoxLayout()
        scroll.setContentsMargins(GUTTER_PX, 0, GRID + SCROLL_PX, 0)
        scroll.addWidget(TimeScroll(self.session))
        stack.addLayout(scroll)
        split = QSplitter(Qt.Orientation.Horizontal)
        split.setHandleWidth(GRID)
        split.setChildrenCollapsible(False)
        split.addWidget(self.preview)
        split.addWidget(lanes)
        split.setStretchFactor(0, 2)
        split.setStretchFactor(1, 3)
        split.setSizes([470, 710])
        middle = QHBoxLayout()
        middle.setSpacing(GRID)
        middle.addWidget(split, 1)
        middle.addWidget(self.inspector)
        central = QWidget()
        central.setObjectName("central")
        column = QVBoxLayout(central)
        column.setContentsMargins(GRID, 0, GRID, GRID)
        column.setSpacing(GRID)
        column.addWidget(self.menus.toolbar())
        column.addWidget(self.notices)
        column.addLayout(middle, 1)
        column.addWidget(self._status())
        self.setCentralWidget(central)

    def _status(self) -> QFrame:
        bar = QFrame()
        bar.setProperty("panel", True)
        row = QHBoxLayout(bar)
        row.setContentsMargins(GRID + 2, 3, GRID + 2, 3)
        row.setSpacing(3 * GRID)
        self.status = {
            name: QLabel() for name in ("take", "rate", "length", "place", "notice", "engine", "saved", "speed")
        }
        for name, label in self.status.items():
            label.setProperty("quiet", name != "take")
            row.addWidget(label, 1 if name == "notice" else 0)
        self.status["engine"].setText("loading networks…")
        return bar

    def _connect(self) -> None:
        self.session.changed.connect(self._on_change)
        self.inference.failed.connect(self.notices.tell)
        self.inference.ready.connect(lambda: self.status["engine"].setText(""))
        for part in (self.preview, self.media, self.reference):
            part.failed.connect(self.notices.tell)
        self.preview.timed.connect(self._timed)
        self.transport.changed.connect(self._show_transport)
        self.value.close_here.connect(self.edits.close_here)
        self.value.typed.connect(self.edits.set_value)
        self.facts.again.connect(self.edits.again)
        self.smoothing.moved.connect(self.edits.preview_smoothing)
        self.smoothing.kept.connect(self.edits.smooth)
        self.smoothing.dropped.connect(self.inference.cancel)
        self.edits.cutoff_hz = self.smoothing.cutoff.value
        self.edits.told.connect(self.status["notice"].setText)
        self.time.looping = self.actions_by_name["loop"].isChecked
        self.filling.failed.connect(self.notices.tell)
        self.live.failed.connect(self.notices.tell)
        self.live.face.connect(self.preview.show_live)
        self.live.recorded.connect(self.files.open_recording)
        self.files.character_chosen.connect(self.preview.show_character)
        self.keeper.failed.connect(self.notices.tell)
        self.files.told.connect(self.notices.tell)
        self.files.opened.connect(self._show_opened)
        self.filling.changed.connect(self._show_filling)
        self.spans.refused.connect(self.notices.tell)
        self.timeline.marked.connect(self.spans.mark)
        self.spans.strip.wanted.connect(self.preview.draw_strip)
        self.preview.strip_drawn.connect(self.spans.strip.show_picture)
        self.session.undo.indexChanged.connect(self._show_undo)
        self._show_undo()
        self._show_filling()
        application = QApplication.instance()
        if application is not None:
            application.installEventFilter(self)

    def showEvent(self, event: QShowEvent) -> None:
        """Load the networks once the window can be seen."""
        super().showEvent(event)
        self.curves.setFocus()
        QTimer.singleShot(0, self.inference.warm_up)

    # --- opening and closing

    def load(self, path: Path) -> bool:
        """Open a take or a project; returns whether it is open now."""
        return self.files.load(path)

    def _show_opened(self) -> None:
        self.transport.run(0.0)
        self.notices.hide()
        self.status["notice"].setText(" ".join(self.session.take.notices))
        self._show_title()

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Accept files."""
        if event.mimeData().hasUrls():
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Open the first file that was dropped."""
        paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
        if paths:
            self.files.take_in(paths[0])

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask for unsaved edits, then end the threads."""
        if not self.files.may_lose_edits():
            event.ignore()
            return
        self.shut_down()
        event.accept()

    def shut_down(self) -> None:
        """End the threads; the window cannot be used after."""
        application = QApplication.instance()
        if application is not None:
            application.removeEventFilter(self)
        self.transport.run(0.0)
        self.session.undo.indexChanged.disconnect(self._show_undo)  # clearing itself at its end, it would still tell us
        self.keeper.close()
        self.inference.close()
        self.media.close()
        self.reference.close_reader()
        self.filling.close()
        self.live.stop()
        self.preview.close_renderer()

    # --- the window

    def fill(self) -> None:
        """Fill the chosen span, or the selection."""
        self.spans.fill()

    def note(self) -> None:
        """Type a note on the frame at the playhead."""
        self.notes.entry.setFocus()

    def _show_filling(self) -> None:
        # Enter belongs to whatever is typed into, unless there is a variant to keep
        self.actions_by_name["accept"].setEnabled(bool(self.filling.variants))
        self.actions_by_name["fill"].setEnabled(not self.filling.busy)

    def mute(self) -> None:
        """Play with or without sound."""
        self.media.mute(self.actions_by_name["mute"].isChecked())

    def _show_tool(self) -> None:
        for name in TOOLS:
            self.actions_by_name[f"{name}_tool"].setChecked(self.session.tool == name)
        self.actions_by_name["hit_exactly"].setChecked(self.session.exact)
        self.actions_by_name["rest_follows"].setChecked(self.session.follow)

    def light_theme(self) -> None:
        """Switch between dark and light."""
        self.settings.light = self.actions_by_name["light_theme"].isChecked()
        self.colours = theme.LIGHT if self.settings.light else theme.DARK
        self.setStyleSheet(theme.style_sheet(self.colours))
        self.curves.paint_with(self.colours)
        self.timeline.paint_with(self.colours)

    def show_keys(self) -> None:
        """List every key."""
        rows = "".join(
            f"<tr><td style='padding:2px 16px 2px 0'>{entry.title}</td><td>{', '.join(keys)}</td></tr>"
            for entry in ACTIONS
            if (keys := keys_of(entry, self.settings.preset))
        )
        extra = "<tr><td>See the original</td><td>hold B</td></tr>"
        self._tell("Keys", f"<table>{rows}{extra}</table>")

    def about(self) -> None:
        """Say what this is and which versions it runs on."""
        from app.about import describe

        self._tell("About Retake", describe().replace("\n", "<br>"))

    def _tell(self, title: str, text: str) -> None:
        box = QMessageBox(self)
        box.setWindowTitle(title)
        box.setText(text)
        box.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        box.open()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Show the original for as long as B is held."""
        kind = event.type()
        if kind in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease) and isinstance(event, QKeyEvent):
            plain = event.key() == Qt.Key.Key_B and event.modifiers() == Qt.KeyboardModifier.NoModifier
            if plain and self.isActiveWindow() and not event.isAutoRepeat():
                self._hold_before(kind == QEvent.Type.KeyPress)
        return False

    def _hold_before(self, held: bool) -> None:
        if held and self.preview.face.view != "Before":
            self._view_before_hold = self.preview.face.view
            self.preview.show_view("Before")
        elif not held and hasattr(self, "_view_before_hold"):
            self.preview.show_view(self._view_before_hold)
            del self._view_before_hold

    # --- showing

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.PLAYHEAD):
            self._show_place()
        if change & (Change.TAKE | Change.CURVES | Change.SAVED):
            self._show_saved()
        if change & Change.CURVES:
            self.menus.hints.hide()
        if change & Change.TOOL:
            self._show_tool()

    def _show_title(self) -> None:
        take = self.session.take
        self.setWindowTitle(f"{self.session.name}[*] - Retake")
        self.status["take"].setText(self.session.name)
        self.status["rate"].setText(f"{take.fps:g} fps")
        self.status["length"].setText(f"{len(take):,} frames · {timecode(take.duration_s, take.fps)}")
        self._show_place()
        self._show_saved()

    def _show_place(self) -> None:
        session = self.session
        self.status["place"].setText(
            f"{timecode(session.playhead / session.take.fps, session.take.fps)} · {session.playhead}"
        )

    def _show_saved(self) -> None:
        self.setWindowModified(self.session.edited)
        saved = "saved" if self.keeper.path else ""
        self.status["saved"].setText("edits not saved yet" if self.session.edited else saved)

    def _show_undo(self, *_: int) -> None:
        stack = self.session.undo
        for name, able, text in (
            ("undo", stack.canUndo(), stack.undoText()),
            ("redo", stack.canRedo(), stack.redoText()),
        ):
            action = self.actions_by_name[name]
            action.setEnabled(able)
            action.setText(f"{name.capitalize()} {text}".strip())
            action.setToolTip(f"{action.text()}  ({action.shortcut().toString()})")

    def _show_transport(self) -> None:
        self.actions_by_name["play"].setChecked(self.transport.playing)
        self.actions_by_name["play"].setIconText("❚❚" if self.transport.playing else "▶")

    def _timed(self, spent_ms: float) -> None:
        self._latencies_ms = [*self._latencies_ms[-19:], spent_ms]
        self.status["speed"].setText(f"drag → preview {np.median(self._latencies_ms):.0f} ms")
