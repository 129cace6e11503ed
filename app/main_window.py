"""The window: puts the panels together and carries out the actions."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import QEvent, QObject, Qt, QTimer
from PySide6.QtGui import QAction, QCloseEvent, QDragEnterEvent, QDropEvent, QKeyEvent, QKeySequence, QShowEvent
from PySide6.QtWidgets import (
    QApplication,
    QFileDialog,
    QFrame,
    QHBoxLayout,
    QLabel,
    QMainWindow,
    QMessageBox,
    QSplitter,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from app import theme
from app.actions import ACTIONS, MENUS, TOOLBAR
from app.curves.lane import GUTTER_PX
from app.curves.panel import CurvesPanel
from app.inference import Inference
from app.inspector.panel import Inspector
from app.notices import Notices
from app.preview.panel import PreviewPanel
from app.session import Change, Session
from app.settings import Settings
from app.theme import GRID
from app.timeline.panel import Timeline, TimeScroll
from app.transport import Transport
from engine.controls import CONTROLS
from engine.errors import EngineError
from engine.formats import FORMATS, read_take, write_take
from engine.take import Take, runs, timecode

EASE_FRAMES = 5
HINTS = "Drag any curve up or down: the face follows.   Hatched: frames the tracker lost.   Space plays."


class MainWindow(QMainWindow):
    """One window on one take.

    Parameters
    ----------
    take, path : what to open, and the file it came from
    settings : what is remembered
    """

    def __init__(self, take: Take, path: Path | None = None, settings: Settings | None = None) -> None:
        super().__init__()
        self.settings = settings or Settings()
        self.colours = theme.LIGHT if self.settings.light else theme.DARK
        self.session = Session(take)
        self.inference = Inference(self.session)
        self.transport = Transport(self.session)
        self.notices = Notices()
        self.preview = PreviewPanel(self.session, self.inference)
        self.curves = CurvesPanel(self.session, self.inference, self.colours)
        self.timeline = Timeline(self.session, self.colours, gutter_px=GUTTER_PX)
        self.inspector = Inspector(self.session)
        self._latencies_ms: list[float] = []
        self._saved_view = ""
        self.setAcceptDrops(True)
        self._make_actions()
        self._lay_out()
        self._connect()
        self.setStyleSheet(theme.style_sheet(self.colours))
        self.resize(1440, 900)
        self.show_take(take, path)

    # --- building

    def _make_actions(self) -> None:
        self.actions_by_name: dict[str, QAction] = {}
        for entry in ACTIONS:
            action = QAction(entry.title, self, checkable=entry.checkable)
            action.setShortcuts([QKeySequence(key) for key in entry.keys])
            action.triggered.connect(lambda _=False, name=entry.name: getattr(self, name)())
            self.actions_by_name[entry.name] = action
        for title in MENUS:
            menu = self.menuBar().addMenu(title)
            for entry in ACTIONS:
                if entry.menu == title:
                    menu.addAction(self.actions_by_name[entry.name])
            if title == "File":
                self._recent = menu.addMenu("Open recent")
                self._recent.aboutToShow.connect(self._fill_recent)
        self.actions_by_name["drag_tool"].setChecked(True)
        self.actions_by_name["light_theme"].setChecked(self.settings.light)

    def _toolbar(self) -> QFrame:
        bar = QFrame()
        bar.setProperty("panel", True)
        row = QHBoxLayout(bar)
        row.setContentsMargins(GRID, 6, GRID, 6)
        row.setSpacing(4)
        entries = {entry.name: entry for entry in ACTIONS}
        self.buttons: dict[str, QToolButton] = {}
        for number, group in enumerate(TOOLBAR):
            if number:
                line = QFrame()
                line.setProperty("line", True)
                line.setFixedWidth(1)
                row.addSpacing(4)
                row.addWidget(line)
                row.addSpacing(4)
            for name in group:
                entry, button = entries[name], QToolButton()
                button.setDefaultAction(self.actions_by_name[name])
                button.setText(entry.short)
                key = f"  ({entry.keys[0]})" if entry.keys else ""
                button.setToolTip(entry.title + key)
                button.setAccessibleName(entry.title)
                row.addWidget(button)
                self.buttons[name] = button
        row.addStretch(1)
        self.hints = QLabel(HINTS)
        self.hints.setProperty("quiet", True)
        row.addWidget(self.hints)
        row.addStretch(1)
        return bar

    def _lay_out(self) -> None:
        lanes = QFrame()
        lanes.setProperty("panel", True)
        stack = QVBoxLayout(lanes)
        stack.setContentsMargins(1, 6, 1, 4)
        stack.setSpacing(2)
        stack.addWidget(self.timeline)
        stack.addWidget(self.curves, 1)
        scroll = QHBoxLayout()
        scroll.setContentsMargins(GUTTER_PX, 0, GRID, 0)
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
        column.addWidget(self._toolbar())
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
        self.status = {name: QLabel() for name in ("take", "rate", "length", "place", "engine", "saved", "speed")}
        for name, label in self.status.items():
            label.setProperty("quiet", name != "take")
            if name == "engine":
                row.addStretch(1)
            row.addWidget(label)
        self.status["engine"].setText("loading networks…")
        return bar

    def _connect(self) -> None:
        self.session.changed.connect(self._on_change)
        self.inference.failed.connect(self.notices.tell)
        self.inference.ready.connect(lambda: self.status["engine"].setText(""))
        self.preview.failed.connect(self.notices.tell)
        self.preview.timed.connect(self._timed)
        self.transport.changed.connect(self._show_transport)
        self.inspector.close_here.connect(self.close_here)
        self.inspector.value_typed.connect(self.set_value)
        self.session.undo.indexChanged.connect(self._show_undo)
        self._show_undo()
        application = QApplication.instance()
        if application is not None:
            application.installEventFilter(self)

    def showEvent(self, event: QShowEvent) -> None:
        """Load the networks once the window can be seen."""
        super().showEvent(event)
        QTimer.singleShot(0, self.inference.warm_up)

    # --- opening and saving

    def show_take(self, take: Take, path: Path | None) -> None:
        """Open a take in place of the one that is open."""
        self.transport.run(0.0)
        self.session.open(take, path)
        self.notices.hide()
        for notice in take.notices:
            self.notices.tell(notice)
        self._show_title()

    def load(self, path: Path, *_: object) -> bool:
        """Open a file; what is open stays as it was where the file cannot be read."""
        try:
            take = read_take(path)
        except EngineError as error:
            self.notices.tell(error.sentence, error.advice)
            return False
        if not self._may_lose_edits():
            return False
        self.settings.remember(path)
        self.show_take(take, path)
        return True

    def _may_lose_edits(self) -> bool:
        if not self.session.edited:
            return True
        kinds = QMessageBox.StandardButton
        answer = QMessageBox.question(
            self,
            "Unsaved edits",
            f"{self.session.name} has edits that are not saved.",
            kinds.Save | kinds.Discard | kinds.Cancel,
        )
        return answer == kinds.Discard or (answer == kinds.Save and self.save())

    def open_take(self) -> None:
        """Choose a file to open."""
        endings = " ".join(f"*{ending}" for entry in FORMATS for ending in entry.endings)
        name, _ = QFileDialog.getOpenFileName(self, "Open a take", "", f"Takes ({endings})")
        if name:
            self.load(Path(name))

    def save(self) -> bool:
        """Write to the file it was saved to before; the recording itself is never overwritten unasked."""
        if self._saved_view and self.session.path is not None:
            return self._write(self.session.path)
        return self.save_as()

    def save_as(self) -> bool:
        """Choose a file and write the take."""
        current = self.session.path or Path(f"{self.session.take.name}.csv")
        suggestion = str(current.with_name(f"{current.stem}_edited.csv"))
        name, _ = QFileDialog.getSaveFileName(self, "Save the take", suggestion, "Live Link Face CSV (*.csv)")
        return bool(name) and self._write(Path(name))

    def _write(self, path: Path) -> bool:
        path = path if path.suffix else path.with_suffix(".csv")
        try:
            write_take(self.session.take, path)
        except EngineError as error:
            self.notices.tell(error.sentence, error.advice)
            return False
        self.session.path, self._saved_view = path, str(path)
        self.session.undo.setClean()
        self.settings.remember(path)
        self._show_title()
        return True

    def _fill_recent(self) -> None:
        self._recent.clear()
        for name in self.settings.recent:
            entry = self._recent.addAction(Path(name).name)
            entry.setToolTip(name)
            entry.triggered.connect(partial(self.load, Path(name)))
        self._recent.setEnabled(bool(self.settings.recent))

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Accept files."""
        if event.mimeData().hasUrls():
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Open the first file that was dropped."""
        paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
        if paths:
            self.load(paths[0])

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask for unsaved edits, then end the threads."""
        if not self._may_lose_edits():
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
        self.inference.close()
        self.preview.close_renderer()

    # --- editing

    def undo(self) -> None:
        """Take back the last step."""
        if not self.inference.busy:
            self.session.undo.undo()

    def redo(self) -> None:
        """Do the step that was taken back again."""
        if not self.inference.busy:
            self.session.undo.redo()

    def cancel(self) -> None:
        """Drop the drag under way."""
        self.curves.tool.cancel()

    def close_here(self) -> None:
        """Bring lips or eyelids together on the selection, or around the playhead."""
        control = CONTROLS[self.session.lane]
        if control.name == "lips_vertical" or control.area == "eyelids":
            self._set_control(0.0, f"close {control.title}")

    def set_value(self, value_mm: float) -> None:
        """Set the active control at the playhead, or over the selection, to a value."""
        self._set_control(value_mm, f"set {CONTROLS[self.session.lane].title} to {value_mm:g} mm")

    def _set_control(self, value_mm: float, title: str) -> None:
        from engine.editing import ask

        session = self.session
        if self.inference.busy:
            return
        frames = session.selection or (session.playhead, session.playhead + 1)
        ease_frames = EASE_FRAMES if session.selection else session.radius_frames
        name = CONTROLS[session.lane].name
        start, asked = ask(session.controls, name, frames, "set", value_mm, ease_frames=ease_frames)
        self.inference.ask(start, asked)
        self.inference.finish(title)

    def wider_brush(self) -> None:
        """Let the brush move more frames."""
        self.session.set_brush(radius_frames=round(self.session.radius_frames * 1.25) + 1)

    def narrower_brush(self) -> None:
        """Let the brush move fewer frames."""
        self.session.set_brush(radius_frames=round(self.session.radius_frames / 1.25) - 1)

    def drag_tool(self) -> None:
        """Work with the Drag tool."""
        self.actions_by_name["drag_tool"].setChecked(True)

    # --- time

    def play(self) -> None:
        """Play or pause."""
        self.transport.toggle()

    def play_forwards(self) -> None:
        """Play forwards, faster each time."""
        self.transport.faster(1)

    def play_backwards(self) -> None:
        """Play backwards, faster each time."""
        self.transport.faster(-1)

    def stop(self) -> None:
        """Stand still."""
        self.transport.run(0.0)

    def loop(self) -> None:
        """Begin again at the end, or stop there."""
        self.transport.set_loop(self.actions_by_name["loop"].isChecked())

    def next_frame(self) -> None:
        """Go one frame on."""
        self.session.move_playhead(self.session.playhead + 1)

    def previous_frame(self) -> None:
        """Go one frame back."""
        self.session.move_playhead(self.session.playhead - 1)

    def first_frame(self) -> None:
        """Go to the beginning."""
        self.session.move_playhead(0)

    def last_frame(self) -> None:
        """Go to the end."""
        self.session.move_playhead(len(self.session.take) - 1)

    def next_span(self) -> None:
        """Go to the next span."""
        later = [a for a, _ in runs(self.session.take.lost) if a > self.session.playhead]
        if later:
            self.session.move_playhead(later[0])

    def previous_span(self) -> None:
        """Go to the span before."""
        earlier = [a for a, _ in runs(self.session.take.lost) if a < self.session.playhead]
        if earlier:
            self.session.move_playhead(earlier[-1])

    def set_in(self) -> None:
        """Let the selection begin at the playhead."""
        _, stop = self.session.selection or (0, len(self.session.take))
        self.session.select((self.session.playhead, max(stop, self.session.playhead + 1)))

    def set_out(self) -> None:
        """Let the selection end at the playhead."""
        start, _ = self.session.selection or (0, 0)
        self.session.select((min(start, self.session.playhead), self.session.playhead + 1))

    def clear_selection(self) -> None:
        """Select nothing."""
        self.session.select(None)

    # --- the view

    def frame_all(self) -> None:
        """Show the whole take."""
        self.session.set_view(0.0, len(self.session.take) - 1.0)

    def zoom_in(self) -> None:
        """Show fewer frames around the playhead."""
        self.session.zoom_view(1.5, self.session.playhead)

    def zoom_out(self) -> None:
        """Show more frames around the playhead."""
        self.session.zoom_view(1 / 1.5, self.session.playhead)

    def next_lane(self) -> None:
        """Work on the next curve."""
        self.session.choose_lane(self.session.lane + 1)

    def previous_lane(self) -> None:
        """Work on the curve before."""
        self.session.choose_lane(self.session.lane - 1)

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
            f"<tr><td style='padding:2px 16px 2px 0'>{entry.title}</td><td>{', '.join(entry.keys)}</td></tr>"
            for entry in ACTIONS
            if entry.keys
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
            self.hints.hide()

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
        self.status["saved"].setText("edited" if self.session.edited else "saved" if self._saved_view else "")

    def _show_undo(self, *_: int) -> None:
        stack = self.session.undo
        for name, able, text in (
            ("undo", stack.canUndo(), stack.undoText()),
            ("redo", stack.canRedo(), stack.redoText()),
        ):
            action = self.actions_by_name[name]
            action.setEnabled(able)
            action.setText(f"{name.capitalize()} {text}".strip())
            button = self.buttons[name]
            button.setText("↶" if name == "undo" else "↷")
            button.setToolTip(f"{action.text()}  ({action.shortcut().toString()})")

    def _show_transport(self) -> None:
        self.actions_by_name["play"].setChecked(self.transport.playing)
        self.buttons["play"].setText("❚❚" if self.transport.playing else "▶")

    def _timed(self, spent_ms: float) -> None:
        self._latencies_ms = [*self._latencies_ms[-19:], spent_ms]
        self.status["speed"].setText(f"drag → preview {np.median(self._latencies_ms):.0f} ms")
