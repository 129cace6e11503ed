"""The actions that open, save and export, and the questions they ask."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from threading import Thread

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QMessageBox, QWidget

from app.actions.export_report import export_report
from app.actions.opener import Opener
from app.playback import media
from app.playback.media import Media
from app.session import Session
from app.session.keeper import Keeper
from app.settings import Settings
from app.widgets.saving import ask_where, beside, may_replace
from app.widgets.text import message_box
from engine.errors import EngineError
from engine.formats import FORMATS, cues, write_take
from engine.formats.base.atomic import sweep
from engine.formats.base.reading import Sides
from engine.formats.characters.opening import SECOND
from engine.formats.livelink import folder as livelink_folder
from engine.formats.livelink.folder import CARD
from engine.project import ENDING
from engine.take import Take

ORIGINAL = "{} is the take as it was recorded."
# What a take is exported as: as it was read, or with left and right of mouth and jaw as the app or by their names.
SIDES_WRITTEN: dict[str, Sides] = {
    "": "automatic",
    ", sides as the app records": "recorded",
    ", sides as named": "named",
}
EXPORTS: dict[str, Sides] = {
    f"{entry.title}{words} (*{entry.endings[0]})": sides for entry in FORMATS for words, sides in SIDES_WRITTEN.items()
}
ENDINGS = {kind: entry.endings[0] for entry in FORMATS for kind in EXPORTS if kind.startswith(entry.title)}
CAPTURES = (".trc", ".c3d")  # markers may also be in a CSV, but so are takes


class FileActions(QObject):
    """Each public method without arguments is an action of the table.

    Parameters
    ----------
    session, keeper, media : what is open, what keeps it safe, and what plays along
    settings : remembers recent files
    window : the parent of the dialogs

    Attributes
    ----------
    opener : opens what was chosen
    """

    message = Signal(str, str)  # sentence, advice
    wrote = Signal(str, str)  # what was written, and what the file cannot hold
    opened = Signal()
    capture_dropped = Signal(object)  # the path of a file of markers
    character_chosen = Signal(object)  # the Path of a head, or None for the bundled one
    cues_dropped = Signal(object)  # the Path of a file that says what is said when

    def __init__(self, session: Session, keeper: Keeper, media: Media, settings: Settings, window: QWidget) -> None:
        super().__init__()
        self._session, self._keeper, self._media = session, keeper, media
        self.opener = Opener(session, keeper, settings, window, self.save)
        self.opener.failed.connect(self.message)
        self.opener.opened.connect(self.opened)
        self._settings, self._window = settings, window
        keeper.saved.connect(settings.remember)

    def load(self, path: Path, *_: object) -> None:
        """Read a take or a project, and open it when it is read; returns at once."""
        self.opener.load(path)

    def take_in(self, path: Path) -> None:
        """Open or attach a file, by its ending."""
        ending = path.suffix.lower()
        if self._is_another_take(path):
            self.load(path)
        elif ending in media.ENDINGS:
            self._media.attach("audio", path)
        elif ending in media.FILM_ENDINGS:
            self._media.attach("video", path)
        elif ending in cues.READERS:
            self.cues_dropped.emit(path)
        elif ending in CAPTURES:
            self.capture_dropped.emit(path)
        else:
            self.load(path)

    def _is_another_take(self, path: Path) -> bool:
        """Whether a file belongs to a take of several files that is not open."""
        try:
            return livelink_folder.is_one(path) and livelink_folder.table_of(path) != self._session.document.path
        except EngineError:
            return True  # opening it says what is wrong

    def open_take(self) -> None:
        """Choose a file to open."""
        endings = " ".join(f"*{ending}" for entry in FORMATS for ending in entry.endings)
        kinds = f"Takes and projects ({endings} *.zip {CARD} *{ENDING})"
        name, _ = QFileDialog.getOpenFileName(self._window, "Open", "", kinds)
        if name:
            self.load(Path(name))

    def open_folder(self) -> None:
        """Choose the folder of a take to open, as Live Link Face hands it over."""
        name = QFileDialog.getExistingDirectory(self._window, "Open a take folder")
        if name:
            self.load(Path(name))

    def save(self) -> bool:
        """Save the project where it was saved before, or ask where; returns whether it is on its way."""
        return self._save_to(self._keeper.path) if self._keeper.path else self.save_as()

    def save_as(self) -> bool:
        """Choose a file and save the project: the original, every edit, and what can be undone."""
        suggested = beside(self._session.document.path, f"{Path(self._session.document.name).stem}{ENDING}")
        kinds = {f"Retake project (*{ENDING})": ENDING}
        path, _ = ask_where(self._window, "Save the project", suggested, kinds)
        return path is not None and self._save_to(path)

    def export(self) -> bool:
        """Choose a file and write the edited take as other programs read it."""
        suggested = beside(self._session.document.path, f"{Path(self._session.document.name).stem}_edited.csv")
        path, kind = ask_where(self._window, "Export the take", suggested, ENDINGS)
        if path is None or (self._is_original(path) and not may_replace(self._window, ORIGINAL.format(path.name))):
            return False
        try:
            write_take(self._session.document.take, path, EXPORTS.get(kind, "automatic"))
        except EngineError as error:
            self.message.emit(error.sentence, error.advice)
            return False
        self._settings.remember(path)
        saved = self._keeper.path is not None and not self._session.document.edited
        self.wrote.emit(*export_report(self._session, path, saved=saved))
        return True

    def open_recording(self, take: Take) -> None:
        """Open what was recorded live, unless edits would be lost."""
        self.opener.open_take(take)

    def own_head(self) -> None:
        """Show the take on the head that comes with Retake."""
        self.character_chosen.emit(None)

    def second_head(self) -> None:
        """Show the take on the second bundled head."""
        self.character_chosen.emit(SECOND)

    def load_character(self) -> None:
        """Choose a file with a head to show the take on, and to retarget to by default."""
        kinds = "Heads (*.npz *.glb *.gltf *.vrm *.obj *.ply *.stl)"
        name, _ = QFileDialog.getOpenFileName(self._window, "Show on another head", "", kinds)
        if name:
            self.character_chosen.emit(Path(name))

    def offer_left_over(self) -> None:
        """Offer the work of a program that ended early, and remove what it was writing."""
        folders = {Path(path).parent for path in self._settings.recent}
        Thread(target=_sweep_all, args=(folders,), daemon=True).start()  # a folder on a network may not answer
        left = self._keeper.left_over()
        if not left:
            return
        listed = "\n".join(entry.sentence for entry in left)
        box = message_box(self._window, "Unsaved work", f"Retake ended before this was saved:\n\n{listed}")
        restore = box.addButton("Restore", QMessageBox.ButtonRole.AcceptRole)
        discard = box.addButton("Discard", QMessageBox.ButtonRole.DestructiveRole)
        box.addButton("Later", QMessageBox.ButtonRole.RejectRole)
        box.exec()
        if box.clickedButton() is restore:
            self.opener.opening.read(left[0].path, left_over=True)
        elif box.clickedButton() is discard:
            try:
                for entry in left:
                    self._keeper.discard(entry)
            except EngineError as error:
                self.message.emit(error.sentence, error.advice)

    def _save_to(self, path: Path) -> bool:
        self._media.settle_in(path.parent)
        self._keeper.save_as(path)
        return True

    def _is_original(self, path: Path) -> bool:
        """Return whether a file is the recording that is open, or has the name of the one a project was made of."""
        opened = self._session.document.path
        same = opened is not None and opened.exists() and path.exists() and path.samefile(opened)
        return path.exists() and (same or path.name == self._session.document.original.name)


def _sweep_all(folders: Iterable[Path]) -> None:
    for folder in folders:
        sweep(folder)
