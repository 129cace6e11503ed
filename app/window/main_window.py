"""The window: puts the panels together and carries out the actions."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent, QMoveEvent, QShowEvent
from PySide6.QtWidgets import (
    QApplication,
    QFrame,
    QHBoxLayout,
    QMainWindow,
    QScrollArea,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from app import theme
from app.actions.edit import EditActions
from app.actions.file import FileActions
from app.actions.marks import MarkActions
from app.actions.media import MediaActions
from app.actions.menus import Menus
from app.actions.settings import SettingsActions
from app.actions.time import TimeActions
from app.actions.view import ViewActions
from app.actions.viseme import VisemeActions
from app.clean.section import CleanSection
from app.curves.panel import CurvesPanel
from app.curves.places import GUTTER_PX
from app.curves.tools import TOOLS
from app.importing.line import ImportLine
from app.inspector.brush import BrushSection
from app.inspector.facts import FactsSection
from app.inspector.flags import FlagsSection
from app.inspector.media import MediaSection
from app.inspector.panel import Inspector
from app.inspector.smooth import SmoothSection
from app.inspector.value import ValueSection
from app.live.section import LiveSection
from app.notes.section import NotesSection
from app.pins.section import PinsSection
from app.playback.media import Media
from app.playback.transport import Transport
from app.preview.panel import PreviewPanel
from app.preview.reference import ReferencePanel
from app.retarget.actions import RetargetActions
from app.review.actions import ReviewActions
from app.session import MEDIA, Change, Session
from app.session.flagging import Flagging
from app.session.inference import Inference
from app.session.keeper import Keeper
from app.settings import Settings
from app.spans.filling import Filling
from app.spans.section import SpansSection
from app.theme import GRID
from app.timeline.panel import SCROLL_PX, Timeline, TimeScroll
from app.widgets.text import PlainText, caption, tip, title
from app.window.contexts import Contexts
from app.window.focus import Focus
from app.window.keyboard import Keyboard
from app.window.missing import MissingMedia
from app.window.notices import Notices
from app.window.screen import DESIGNED, stay_on_screen
from app.window.status import StatusBar
from engine.assets import DEMO_TAKE
from engine.formats.livelink.importing import imported
from engine.take import Take


class MainWindow(QMainWindow):
    """One window on one take.

    Parameters
    ----------
    take, path : what to open, and the file it came from
    settings : what is remembered
    unsaved : the folder for unsaved work; the user's own without one
    """

    _framed = False  # whether room was made for the desktop's frame

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
        self.colours = theme.palette(self.settings.theme)
        self.session = Session(take)
        self.keeper = Keeper(self.session, unsaved)
        self.inference = Inference(self.session)
        self.transport = Transport(self.session)
        self.media = Media(self.session, self.transport, settings=self.settings)
        self.files = FileActions(self.session, self.keeper, self.media, self.settings, self)
        self.sound = MediaActions(self.session, self.media, self)
        self.status = StatusBar(self.session, self.keeper, self.files.opening, self.media)
        self.notices, self.missing = Notices(), MissingMedia()
        self.importing = ImportLine(self.session)
        self.preview = PreviewPanel(self.session, self.inference)
        self.reference = ReferencePanel(self.session)
        self.curves = CurvesPanel(self.session, self.inference, self.colours)
        self.timeline = Timeline(self.session, self.colours, gutter_px=GUTTER_PX)
        self.filling = Filling(self.session)
        self.edits = EditActions(self.session, self.inference, self.curves, self.filling)
        self.flagging = Flagging(self.session)
        self.visemes = VisemeActions(self.session, self.timeline.visemes, self)
        self.time = TimeActions(self.session, self.transport, self.filling)
        self.brush, self.value = BrushSection(self.session), ValueSection(self.session)
        self.pins, self.clean = PinsSection(self.session, self.inference), CleanSection(self.session, self.inference)
        self.smoothing, self.facts = SmoothSection(self.session), FactsSection(self.session)
        self.spans = SpansSection(self.session, self.filling)
        self.live = LiveSection(self.session, self.keeper.folder)
        self.keeper.kept.connect(lambda contents: self.live.settle(contents.original))
        self.attached = MediaSection(self.session)
        self.notes = NotesSection(self.session)
        self.flags = FlagsSection(self.session)
        self.marks, self.views = MarkActions(self.session, self.notes, self.spans), ViewActions(self.preview)
        self.retarget, self.review = RetargetActions(self.session, self), ReviewActions(self.session, self)
        sections = (
            self.brush,
            self.value,
            self.pins,
            self.clean,
            self.live,
            *self.retarget.sections,
            self.smoothing,
            self.spans,
            self.review.section,
            self.facts,
            self.flags,
            self.notes,
            self.attached,
        )
        self.inspector = Inspector(self.session, sections)
        self.closed = False  # once its threads have ended
        self._plain_text = PlainText(self)
        self.setAcceptDrops(True)
        self.menus = Menus(self, self.settings, self._do, self.files.load)
        self.actions_by_name = self.menus.actions
        self.preferences = SettingsActions(self.settings, self.menus, self.media, self)
        self._show_tool()
        self._lay_out()
        self._connect()
        self._connect_importing()
        self.preferences.apply_all()
        self.resize(DESIGNED.boundedTo(self.screen().availableSize()))
        self.session.open(take, path)
        self.files.imported = imported(take)
        self._show_opened()

    # --- building

    def _do(self, name: str) -> None:
        tools = (self.edits, self.time, self.marks, self.views, self.visemes, self.retarget, self.review)
        owners = (self, self.files, self.sound, *tools, self.preferences)
        owner = next(each for each in owners if name in type(each).__dict__)
        if name != "cancel":  # which would keep what is half typed
            self._focus.give_back()
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
        column.addWidget(self.missing)
        column.addWidget(self.importing)
        column.addLayout(middle, 1)
        column.addWidget(self.status)
        self.setCentralWidget(central)

    def _connect(self) -> None:
        self.session.changed.connect(self._on_change)
        self.inference.ready.connect(lambda: self.status["engine"].setText(""))
        shown = (self.preview, self.media, self.reference, self.live, self.retarget, self.review)
        for part in (*shown, self.inference, self.filling, self.visemes, self.timeline.visemes, self.marks):
            part.failed.connect(self.notices.tell)
        self.keeper.failed.connect(self.notices.hold)
        self.preview.timed.connect(self.status.timed)
        self._connect_media()
        self._connect_retarget()
        self.notes.author = self.review.section.author = lambda: self.settings.author
        self.preferences.themed.connect(self._wear)
        for clock in (self.timeline, self.status):
            self.preferences.counted.connect(clock.count_in_frames)
        self.transport.changed.connect(self._show_transport)
        self.value.close_here.connect(self.edits.close_here)
        self.value.typed.connect(self.edits.set_value)
        self.facts.again.connect(self.edits.again)
        self.facts.reach.connect(self.edits.go_there)
        self.smoothing.moved.connect(self.edits.preview_smoothing)
        self.smoothing.kept.connect(self.edits.smooth)
        self.smoothing.dropped.connect(self.inference.cancel)
        self.edits.cutoff_hz = self.smoothing.cutoff.value
        self.edits.let_go = self.timeline.visemes.drop
        for told in (self.edits.told, self.time.told, self.timeline.told):
            told.connect(self.status.tell)
        self.edits.put_away = self.notices.put_away
        self.time.looping = self.actions_by_name["loop"].isChecked
        self.live.face.connect(self.preview.show_live)
        self.preview.live_timed.connect(self.live.on_screen)
        self.live.recorded.connect(self.files.open_recording)
        self.review.told.connect(self.status.tell)
        self.review.open_take = self.files.open_then
        self.keeper.saved.connect(self._show_saved)
        self.keeper.mended.connect(self.notices.withdraw)
        self.timeline.visemes.wanted.connect(self._do)
        self.files.cues_dropped.connect(self.visemes.attach)
        self.files.told.connect(self.notices.tell)
        self.files.wrote.connect(self.notices.say)
        self.files.opened.connect(self._show_opened)
        self.filling.changed.connect(self._show_filling)
        self.spans.refused.connect(self.notices.tell)
        self._contexts = Contexts(self)
        self.timeline.marked.connect(self.spans.mark)
        self.spans.strip.wanted.connect(self.preview.draw_strip)
        self.preview.strip_drawn.connect(self.spans.strip.show_picture)
        self.session.document.undo.indexChanged.connect(self._show_undo)
        self._show_undo()
        self._show_missing()
        self._show_filling()
        self._watch_keys()

    def _watch_keys(self) -> None:
        self._keyboard = Keyboard(self, self.preview)
        self._focus = Focus(self, self.curves, (self.timeline, self.preview.face))
        self._focus.give_back()

    def _connect_retarget(self) -> None:
        self.retarget.shown.connect(self.preview.show_sides)
        self.retarget.retargeting.capture_opened.connect(self.files.open_recording)
        self.preview.picked.connect(self.retarget.pick)
        self.preview.dot_clicked.connect(self.retarget.placing.choose)
        self.edits.stop_else = self.retarget.retargeting.cancel
        self.files.capture_dropped.connect(self.retarget.take_in)
        self.files.character_chosen.connect(self.retarget.retargeting.show_on)
        self.retarget.retargeting.head_read.connect(self.preview.show_character)
        self.retarget.retargeting.told.connect(self.status.hold)

    def _connect_importing(self) -> None:
        self.importing.refused.connect(self.notices.tell)
        self.importing.chosen.connect(self.curves.setFocus)
        self.importing.hide_button.clicked.connect(self._show_importing)

    def _connect_media(self) -> None:
        self.media.missing_changed.connect(self._show_missing)
        self.missing.locate.connect(self.sound.locate)
        self.missing.accept.connect(self.sound.use_found)
        self.missing.detach.connect(self.media.detach)
        self.attached.detached.connect(self.media.detach)
        self.reference.detached.connect(self.sound.detach_video)
        self.attached.moved.connect(self.media.move)
        self.timeline.slid.connect(self.media.settle)

    def focusNextPrevChild(self, onwards: bool) -> bool:
        """Go through what can be seen as the eye does."""
        return self._focus.step(onwards)

    def showEvent(self, event: QShowEvent) -> None:
        """Load the networks once the window can be seen."""
        super().showEvent(event)
        QTimer.singleShot(0, self.inference.warm_up)
        QTimer.singleShot(0, partial(stay_on_screen, self))

    def moveEvent(self, event: QMoveEvent) -> None:
        """Make room for the frame, which a desktop may draw long after the window is seen, once; later moves are the user's."""
        super().moveEvent(event)
        if not self._framed and self.isVisible() and self.frameGeometry() != self.geometry():
            self._framed = True
            QTimer.singleShot(0, partial(stay_on_screen, self))

    # --- opening and closing

    def load(self, path: Path) -> None:
        """Read a take or a project beside what is open, and open it when it is read; returns at once."""
        self.files.load(path)

    def _show_opened(self) -> None:
        self.transport.run(0.0)
        self.notices.hide()
        self._show_title()
        self.status.show_take()
        from_file = self.keeper.path is None and self.session.document.path not in (None, DEMO_TAKE)
        self.importing.tell(self.files.imported, shown=from_file)
        there = from_file and self.importing.there  # it has what was noticed
        self.status.tell("" if there else " ".join(self.session.document.take.notices))
        self._show_importing()

    def show_import(self) -> None:
        """Show or hide how the open take was read."""
        self.importing.setVisible(self.importing.there and self.importing.isHidden())
        self._show_importing()

    def _show_importing(self) -> None:
        self.actions_by_name["show_import"].setEnabled(self.importing.there)
        self.actions_by_name["show_import"].setChecked(not self.importing.isHidden())

    def _show_saved(self, *_: object) -> None:
        self.notices.hide()
        self._show_title()

    def _show_missing(self) -> None:
        self.missing.show_missing(self.media.missing)
        self.actions_by_name["locate_media"].setEnabled(bool(self.media.missing))

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
        """Ask for unsaved edits, wait until all is written, then end the threads."""
        if not self.closed:
            self.files.when_safe(self._leave)
        event.setAccepted(self.closed)

    def _leave(self) -> None:
        self.shut_down()
        self.closed = True
        self.close()

    def shut_down(self) -> None:
        """End the threads; the window cannot be used after."""
        self._keyboard.let_go()
        self._plain_text.let_go()
        self._focus.let_go()
        self.transport.run(0.0)
        self.session.document.undo.blockSignals(True)  # clearing itself at its end, it would still tell everyone
        self.files.opening.close()
        self.keeper.close()
        self.inference.close()
        self.media.close()
        self.reference.close_reader()
        self.filling.close()
        self.flagging.close()
        self.visemes.close()
        self.live.shut_down()
        self.retarget.retargeting.close()
        self.review.close()
        self.preview.close_renderer()
        self.preferences.close()

    # --- the window

    def quit(self) -> None:
        """End the program; what is not saved is kept for the next start."""
        self.close()

    def _show_filling(self) -> None:
        # Enter belongs to the buttons too, unless there is a variant to keep
        self.actions_by_name["accept"].setEnabled(bool(self.filling.variants))
        self.actions_by_name["fill"].setEnabled(not self.filling.busy)

    def mute(self) -> None:
        """Play with or without sound."""
        self.media.mute(self.actions_by_name["mute"].isChecked())

    def _show_tool(self) -> None:
        for name in TOOLS:
            self.actions_by_name[f"{name}_tool"].setChecked(self.session.view.tool == name)
        self.actions_by_name["hit_exactly"].setChecked(not self.session.view.believability)
        self.actions_by_name["show_removed"].setChecked(self.session.view.shows_removed)

    def _wear(self, colours: theme.Palette) -> None:
        self.colours = colours
        QApplication.setPalette(theme.qt_palette(colours))
        self.setStyleSheet(theme.style_sheet(colours))
        self.curves.paint_with(colours)
        self.timeline.paint_with(colours)

    # --- showing

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.CURVES | Change.SAVED):
            self.setWindowModified(self.session.document.edited)
        if change & (Change.TAKE | Change.MARKS | Change.MEDIA):
            for kind in MEDIA:
                self.actions_by_name[f"detach_{kind}"].setEnabled(self.session.document.marks.medium(kind) is not None)
        if change & (Change.TAKE | Change.VISEMES):
            for name in ("shift_visemes", "restore_visemes", "remove_visemes"):
                self.actions_by_name[name].setEnabled(self.session.document.visemes is not None)
        if change & (Change.TAKE | Change.MARKS | Change.SAVED | Change.CURVES):
            self._show_hints()
        if change & Change.TOOL:
            self._show_tool()

    def _show_title(self, *_: object) -> None:
        self.setWindowTitle(f"{title(self.session.document.name)}[*] - Retake")
        self.setWindowModified(self.session.document.edited)

    def _show_hints(self) -> None:
        session, stack = self.session, self.session.document.undo
        self.menus.show_hints(
            changed=stack.count() > 0, saved=not session.document.edited, hatched=bool(session.document.open_spans)
        )

    def _show_undo(self, *_: int) -> None:
        stack = self.session.document.undo
        self._show_hints()
        for name, able, text in (
            ("undo", stack.canUndo(), stack.undoText()),
            ("redo", stack.canRedo(), stack.redoText()),
        ):
            action = self.actions_by_name[name]
            action.setEnabled(able)
            words = f"{name.capitalize()} {text}".strip()
            action.setText(caption(words))
            action.setToolTip(tip(f"{words}  ({action.shortcut().toString()})"))

    def _show_transport(self) -> None:
        self.actions_by_name["play"].setChecked(self.transport.playing)
        self.actions_by_name["play"].setIconText("❚❚" if self.transport.playing else "▶")
