"""The window: connects its parts, opens and closes, and shows in menus and title what the session is like."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from PySide6.QtCore import QTimer
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent, QMoveEvent, QShowEvent
from PySide6.QtWidgets import QApplication

from app import theme
from app.curves.tools import TOOLS
from app.session import MEDIA, Change
from app.settings import Settings
from app.widgets.text import caption, tip, title
from app.window.contexts import Contexts
from app.window.focus import Focus
from app.window.keyboard import Keyboard
from app.window.layout import lay_out
from app.window.parts import WindowParts
from app.window.screen import DESIGNED, stay_on_screen
from app.window.wiring import connect
from engine.assets import DEMO_TAKE
from engine.formats.livelink.importing import imported
from engine.take import Take


class MainWindow(WindowParts):
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
        super().__init__(take, settings, unsaved)
        self.closed = False  # once its threads have ended
        self.setAcceptDrops(True)
        self._show_tool()
        lay_out(self)
        self.session.changed.connect(self._on_change)
        connect(self)
        self._contexts = Contexts(self)
        self._keyboard = Keyboard(self, self.preview)
        self._focus = Focus(self, self.curves, (self.timeline, self.preview.face))
        self._focus.give_back()
        self.show_undo()
        self.show_missing()
        self.show_filling()
        self.preferences.apply_all()
        self.resize(DESIGNED.boundedTo(self.screen().availableSize()))
        self.session.open(take, path)
        self.files.opener.imported = imported(take)
        self.show_opened()

    def do(self, name: str) -> None:
        """Perform an action of the table; the keyboard focus returns to the lanes."""
        if name != "cancel":  # which would keep what is half typed
            self._focus.give_back()
        super().do(name)

    def author(self) -> str:
        """Return who writes the notes."""
        return self.settings.author

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

    def show_opened(self) -> None:
        """Show what was opened: stop playing, show its name and how it was read."""
        self.transport.run(0.0)
        self.notices.hide()
        self._show_title()
        self.status.show_take()
        from_file = self.keeper.path is None and self.session.document.path not in (None, DEMO_TAKE)
        self.importing.show_reading(self.files.opener.imported, shown=from_file)
        there = from_file and self.importing.there  # it has what was noticed
        self.status.show_message("" if there else " ".join(self.session.document.take.notices))
        self.show_importing()

    def show_import(self) -> None:
        """Show or hide how the open take was read."""
        self.importing.setVisible(self.importing.there and self.importing.isHidden())
        self.show_importing()

    def show_importing(self) -> None:
        """Show in the menu whether the line about reading is there."""
        self.actions_by_name["show_import"].setEnabled(self.importing.there)
        self.actions_by_name["show_import"].setChecked(not self.importing.isHidden())

    def show_saved(self, *_: object) -> None:
        """Name what was saved, and put notices away."""
        self.notices.hide()
        self._show_title()

    def show_missing(self) -> None:
        """Show which sound or video is not where it was."""
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
            self.files.opener.when_safe(self._leave)
        event.setAccepted(self.closed)

    def _leave(self) -> None:
        self.shut_down()
        self.closed = True
        self.close()

    def shut_down(self) -> None:
        """End the threads; the window cannot be used after."""
        self._keyboard.remove()
        self._plain_text.remove()
        self._focus.remove()
        self.transport.run(0.0)
        self.session.document.undo.blockSignals(True)  # clearing itself at its end, it would still tell everyone
        self.files.opener.opening.close()
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

    def show_filling(self) -> None:
        """Let a fill be kept where there is one, and asked for where none is made."""
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

    def apply_theme(self, colours: theme.Palette) -> None:
        """Apply a theme's colours to every part."""
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

    def show_undo(self, *_: int) -> None:
        """Name what can be undone and redone."""
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

    def show_transport(self) -> None:
        """Show whether it plays."""
        self.actions_by_name["play"].setChecked(self.transport.playing)
        self.actions_by_name["play"].setIconText("❚❚" if self.transport.playing else "▶")
        self.status.show_speed(self.transport.speed)
        self.actions_by_name["loop"].setChecked(self.transport.loop)
