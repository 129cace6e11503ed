"""The actions on the visemes lane as a whole."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app.background import LatestWins
from app.session import Session
from app.session.commands import VisemesCommand
from app.timeline.viseme_editing import VisemeEditing
from engine.errors import EditError
from engine.formats.cues import READERS, read_cues
from engine.speech.lane import VisemeLane, attached, restored
from engine.take import Take

ENDINGS = tuple(READERS)


class VisemeActions(QObject):
    """Each public method without arguments is an action of the table.

    Parameters
    ----------
    session, lane : what they work on
    window : the parent of the dialog
    """

    failed = Signal(str, str)  # sentence, advice

    def __init__(self, session: Session, lane: VisemeEditing, window: QWidget) -> None:
        super().__init__()
        self._session, self._lane, self._window = session, lane, window
        self.reading = LatestWins(_read, name="visemes")
        self.reading.done.connect(self._arrived)
        self.reading.failed.connect(self._refused)

    def _refused(self, request: object, sentence: str, advice: str) -> None:
        self.failed.emit(sentence, advice)

    def attach(self, path: Path) -> None:
        """Read a file of phones or mouth cues and lay it beside the open take."""
        self.reading.submit((path, self._session.document.recorded))

    def attach_visemes(self) -> None:
        """Choose what is said when: a TextGrid or mouth cues."""
        kinds = f"Phones and mouth cues ({' '.join(f'*{ending}' for ending in ENDINGS)} *.TextGrid)"
        name, _ = QFileDialog.getOpenFileName(self._window, "Attach visemes", "", kinds)
        if name:
            self.attach(Path(name))

    def name_viseme(self) -> None:
        """Type what is said at the playhead."""
        lane, session = self._session.document.visemes, self._session
        index = lane.at(session.view.playhead / session.document.take.fps) if lane is not None else None
        if index is None:
            advice = "Move it to a block of the visemes lane." if lane is not None else "Attach visemes first."
            self.failed.emit("No viseme is said at the playhead.", advice)
        else:
            self._lane.type_name(index)

    def shift_visemes(self) -> None:
        """Type when the visemes begin."""
        if self._there():
            self._lane.type_shift()

    def restore_visemes(self) -> None:
        """Take the cues as they were in the file; where they begin stays."""
        lane = self._there()
        if lane is not None and lane.cues is not lane.originals:
            self._push(restored(lane), "visemes as attached")

    def remove_visemes(self) -> None:
        """Take the lane away."""
        if self._there():
            self._push(None, "remove the visemes")

    def close(self) -> None:
        """End the thread."""
        self.reading.stop()

    def _there(self) -> VisemeLane | None:
        if self._session.document.visemes is None:
            self.failed.emit("There are no visemes.", "Attach a TextGrid or mouth cues: File, Attach visemes.")
        return self._session.document.visemes

    def _arrived(self, request: tuple[Path, Take], read: tuple[VisemeLane, list[str]]) -> None:
        path, recorded = request
        lane, notices = read
        if recorded is self._session.document.recorded:
            self._push(lane, f"attach {path.name}")
            if notices:
                self.failed.emit(" ".join(notices), "")

    def _push(self, lane: VisemeLane | None, title: str) -> None:
        self._session.document.undo.push(VisemesCommand.of(self._session.document, lane, title))


def _read(request: tuple[Path, Take]) -> tuple[VisemeLane, list[str]]:
    """Return the lane of a file, and what the user should hear about it."""
    path, notices = request[0], list[str]()
    cues = read_cues(path, notices.append)
    if not cues and notices:
        raise EditError(notices[-1], "Choose a file with a tier of phones.")
    return attached(cues, path.name), notices
