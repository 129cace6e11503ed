"""Reading takes and projects beside the window: what is open stays usable until the new one is there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoCommand

from app.background import LatestWins
from app.session.commands import restored
from app.session.session import Session
from engine.errors import EngineError
from engine.extended import bundled_face
from engine.formats import read_take
from engine.formats.base.atomic import sweep
from engine.formats.livelink import folder as livelink_folder
from engine.formats.livelink.importing import Imported, imported
from engine.project import ENDING, InUseError, Project, Replayed, replay
from engine.take import Array, Take


@dataclass(frozen=True, eq=False)
class Wish:
    """A file that shall be opened.

    Attributes
    ----------
    left_over : whether it is the unsaved work of a program that ended early
    read_only : whether a project shall be read and not written, since another program has it open
    """

    path: Path
    left_over: bool = False
    read_only: bool = False


@dataclass(frozen=True, eq=False)
class InUse:
    """What came of a wish to open a project that another program has open."""

    sentence: str

    def drop(self) -> None:
        """Do nothing: there is no file to close."""


@dataclass(frozen=True, eq=False)
class Opened:
    """A file that was read, with all that takes long about showing it.

    Attributes
    ----------
    wish : what was asked for
    take : the take as it was recorded
    path : of the file that its frames are in
    imported : what that file says of itself
    measured : its controls, (frames, 16), and those of the take as edited
    project : the open project; None where the file is a take
    state, steps : what the edits of a project come to, and their commands
    """

    wish: Wish
    take: Take
    path: Path
    imported: Imported | None
    measured: tuple[Array, Array]
    project: Project | None = None
    state: Replayed | None = None
    steps: tuple[QUndoCommand, ...] = ()

    def drop(self) -> None:
        """Close the file: something else was opened."""
        if self.project is not None:
            self.project.close()


def opened(session: Session, wish: Wish, report: Callable[[float], None] = lambda _: None) -> Opened:
    """Read a file for a session; calls `report` with the share done. Raises `EngineError`, or what `report` raises."""
    report(0.0)
    sweep(wish.path.parent)
    if not wish.left_over and wish.path.suffix.lower() != ENDING:
        take = read_take(wish.path, report)
        return Opened(wish, take, livelink_folder.table_of(wish.path), imported(take), 2 * (_measured(take),))
    project = Project.open(wish.path, read_only=wish.read_only)
    try:
        report(0.0)
        contents = project.contents
        state = replay(contents)
        measured = _measured(state.original or contents.original), _measured(state.take)
        steps = tuple(restored(session.document, contents, state))
        report(1.0)
    except BaseException:
        project.close()
        raise
    origin = imported(contents.original)
    return Opened(wish, contents.original, wish.path, origin, measured, project, state, steps)


def _measured(take: Take) -> Array:
    controls = bundled_face().measure(take.weights)
    controls.flags.writeable = False
    return controls


class Opening(QObject):
    """Reads one file at a time on a thread of its own; a newer wish ends the older one.

    Parameters
    ----------
    session : which the commands of a project are made for
    """

    done = Signal(object)  # an Opened, which is the receiver's to keep or to drop
    failed = Signal(str, str)  # sentence, advice
    in_use = Signal(object, str)  # the path of a project that another program has open, and a sentence about it
    progress = Signal(float)  # the share of a take that is read, from the thread
    changed = Signal()  # another file is read, or none

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self._wish: Wish | None = None
        self._work = LatestWins(self._read, name="opening")
        self._work.done.connect(self._arrived)
        self._work.failed.connect(self._refused)

    @property
    def path(self) -> Path | None:
        """The file that is read."""
        return self._wish.path if self._wish else None

    def read(self, path: Path, *, left_over: bool = False, read_only: bool = False) -> None:
        """Read a file in place of the one that is read; returns at once, and `done` or `failed` follows."""
        self._wish = Wish(path, left_over, read_only)
        self._work.submit(self._wish)
        self.changed.emit()

    def stop(self) -> None:
        """Read nothing any more; what is open stays."""
        if self._wish is not None:
            self._wish = None
            self.changed.emit()

    def close(self) -> None:
        """Stop, and end the thread."""
        self._work.done.disconnect(self._arrived)
        self._work.done.connect(lambda _, read: read.drop())
        self.stop()
        self._work.stop()

    def _read(self, wish: Wish) -> Opened | InUse:
        """Read a file, unless the request was cancelled; runs on the thread."""

        def report(share: float) -> None:
            if wish is not self._wish:
                raise EngineError("This is not wanted any more.")
            self.progress.emit(share)

        try:
            return opened(self._session, wish, report)
        except InUseError as error:
            return InUse(error.sentence)

    def _arrived(self, wish: Wish, read: Opened | InUse) -> None:
        if wish is self._wish and isinstance(read, InUse):
            self.stop()
            self.in_use.emit(wish.path, read.sentence)
        elif wish is self._wish:
            self._wish = None
            self.done.emit(read)
            self.changed.emit()
        else:
            read.drop()

    def _refused(self, wish: Wish, sentence: str, advice: str) -> None:
        if wish is self._wish:
            self.stop()
            self.failed.emit(sentence, advice)
