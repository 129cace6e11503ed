"""Opens takes and projects in place of what is open, and asks about unsaved edits first."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QMessageBox, QWidget

from app.session import Session
from app.session.keeper import Keeper
from app.session.opening import Opened, Opening, Wish
from app.settings import Settings
from engine.formats.livelink.importing import Imported
from engine.take import Take
from engine.words import NAME_LENGTH, plain

Answer = QMessageBox.StandardButton
COPY = "What you do to it here is kept as unsaved work, until you save it under another name."


class Opener(QObject):
    """Reads one file at a time, and opens it once the edits of what is open are saved or given up.

    A file is read on a thread; then it waits for a save that is running; then it replaces what is open, unless another
    file was chosen meanwhile.

    Parameters
    ----------
    session, keeper : what is open, and what saves it
    settings : remembers recent files
    window : the parent of the questions
    save : starts a save, and returns whether it was started

    Attributes
    ----------
    opening : reads files on its thread
    imported : what the file that was opened last says of itself
    """

    failed = Signal(str, str)  # sentence, advice
    opened = Signal()

    def __init__(
        self, session: Session, keeper: Keeper, settings: Settings, window: QWidget, save: Callable[[], bool]
    ) -> None:
        super().__init__()
        self._session, self._keeper, self._settings = session, keeper, settings
        self._window, self._save = window, save
        self.opening = Opening(session)
        self.imported: Imported | None = None
        self._newest: Wish | None = None  # of those that were read
        self._reopens = False  # whether the open project is read again
        self._discarded: tuple[object, ...] | None = None  # the edits to give up when the file is read
        self.opening.done.connect(self._confirm)
        self.opening.changed.connect(self._keep_again)
        self.opening.failed.connect(self.failed)
        self.opening.in_use.connect(self._offer_copy)

    def load(self, path: Path) -> None:
        """Read a take or a project, and open it when it is read; returns at once. Unsaved edits are asked about before.

        `opened` follows, or `failed` where the file cannot be read: what is open then stays as it was.
        """
        self._discarded = None
        if self._keeper.holds(path):
            self.when_safe(partial(self._reopen, path))
        elif self._session.document.edited and self._keeper.path is not None:
            self.when_safe(partial(self.opening.read, path))  # the last step is on its way to the project
        elif self._session.document.edited:
            # before it is read, which may take long
            self._ask(partial(self.opening.read, path), discard=self._remember_discarded)
        else:
            self.opening.read(path)

    def open_take(self, take: Take, then: Callable[[], None] = lambda: None) -> None:
        """Open a take that no file holds, unless edits would be lost, and go on."""
        self.when_safe(partial(self._open_take, take, then))

    def when_safe(self, then: Callable[[], None], otherwise: Callable[[], None] = lambda: None) -> None:
        """Do what closes the open take: at once, or when its edits are saved, or never, as the user says."""
        if not self._keeper.when_idle(partial(self._ask, then, otherwise)):
            name = self._session.document.name
            self.failed.emit(f"{name} is being saved; then it is closed.", "You may go on working.")

    # --- a file

    def _remember_discarded(self) -> None:
        """Remember which edits may be given up once the file that was chosen is read."""
        self._discarded = self._edits()

    def _edits(self) -> tuple[object, ...]:
        document = self._session.document
        return document.original, document.undo.index(), document.undo.count(), document.marks

    def _reopen(self, path: Path) -> None:
        """Read the open project again from its file."""
        self._keeper.release()
        self._reopens = True
        self.opening.read(path)

    def _keep_again(self) -> None:
        """Keep what is open as unsaved work where its project could not be read again."""
        if self._reopens and self.opening.path is None:
            self._reopens = False
            self._keeper.keep()

    def _offer_copy(self, path: Path, sentence: str) -> None:
        """Offer to work on a copy of a project that another program has open."""
        question = f"{sentence}\n\nOpen a copy? {COPY}"
        if QMessageBox.question(self._window, "Open elsewhere", question, Answer.Open | Answer.Cancel) == Answer.Open:
            self.opening.read(path, read_only=True)

    def _confirm(self, opened: Opened) -> None:
        """Open what was read; ask for unsaved edits where there are any that the user did not give up."""
        self._newest, self._reopens = opened.wish, False
        discarded, self._discarded = self._discarded, None
        if discarded == self._edits():
            self._keeper.when_idle(partial(self._open, opened, discard=True))
        else:
            self.when_safe(partial(self._open, opened), opened.drop)

    def _open(self, opened: Opened, *, discard: bool = False) -> None:
        """Open what was read in place of what is open."""
        if opened.wish is not self._newest or self.opening.path is not None:
            opened.drop()  # while its predecessor was being saved, something else was chosen
            return
        if discard:
            self._keeper.forget()
        self.imported = opened.imported
        if opened.project is not None:
            self._keeper.open(opened)
        else:
            self._session.open(opened.take, opened.path, opened.measured[0])
        if not opened.wish.left_over:
            self._settings.remember(opened.wish.path)
        self.opened.emit()
        if opened.project is not None and opened.project.read_only:
            self._say_read_only(opened.wish)

    def _say_read_only(self, wish: Wish) -> None:
        name = wish.path.name
        what = f"This is a copy of {name}" if wish.read_only else f"{name} cannot be written here"
        self.failed.emit(f"{what}; your edits are kept as unsaved work.", "Save it under another name.")

    # --- what both ways need

    def _open_take(self, take: Take, then: Callable[[], None]) -> None:
        self.imported = None
        self._session.open(take, None)
        self._keeper.keep()
        self.opened.emit()
        then()

    def _ask(
        self,
        then: Callable[[], None],
        otherwise: Callable[[], None] = lambda: None,
        *,
        discard: Callable[[], None] | None = None,
    ) -> None:
        """Ask whether to save unsaved edits, and go on with `then`, or with `otherwise` where the user cancels."""
        if not self._session.document.edited:
            then()
            return
        answer = QMessageBox.question(
            self._window,
            "Unsaved edits",
            f"{plain(self._session.document.name, longest=NAME_LENGTH)} has edits that are not saved.",
            Answer.Save | Answer.Discard | Answer.Cancel,
        )
        if answer == Answer.Discard:
            (discard or self._keeper.forget)()
            then()
        elif answer == Answer.Save and self._save():
            self.when_safe(then, otherwise)
        else:
            otherwise()
