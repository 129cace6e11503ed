"""The actions that open, save and export, and the questions they ask."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QMessageBox, QWidget

from app.keeper import Keeper
from app.playback import media
from app.playback.media import Media
from app.session import Session
from app.settings import Settings
from engine.errors import EngineError
from engine.formats import FORMATS, read_take, write_take
from engine.formats.characters.opening import character_of
from engine.take import Take

PROJECT = ".retake"
Answer = QMessageBox.StandardButton


class FileActions(QObject):
    """Each public method without arguments is an action of the table.

    Parameters
    ----------
    session, keeper, media : what is open, what keeps it safe, and what plays along
    settings : remembers recent files
    window : the parent of the dialogs
    """

    told = Signal(str, str)  # sentence, advice
    opened = Signal()
    character_chosen = Signal(object)  # a Character, or None for the bundled one

    def __init__(self, session: Session, keeper: Keeper, media: Media, settings: Settings, window: QWidget) -> None:
        super().__init__()
        self._session, self._keeper, self._media = session, keeper, media
        self._settings, self._window = settings, window

    def load(self, path: Path, *_: object) -> bool:
        """Open a take or a project; what is open stays as it was where the file cannot be read."""
        is_project = path.suffix.lower() == PROJECT
        try:
            take = None if is_project else read_take(path)
            if not self.may_lose_edits():
                return False
            if take is None:
                self._keeper.open(path)
                if self._keeper.path is None:
                    self.told.emit(
                        f"{path.name} cannot be written here; your edits are kept as unsaved work.",
                        "Save it under another name.",
                    )
            else:
                self._session.open(take, path)
        except EngineError as error:
            self.told.emit(error.sentence, error.advice)
            return False
        self._settings.remember(path)
        self.opened.emit()
        return True

    def take_in(self, path: Path) -> None:
        """Open or attach a file, by its ending."""
        ending = path.suffix.lower()
        if ending in media.ENDINGS:
            self._media.attach(path)
        elif ending in media.FILM_ENDINGS:
            self._session.attach_video(path)
        else:
            self.load(path)

    def open_take(self) -> None:
        """Choose a file to open."""
        endings = " ".join(f"*{ending}" for entry in FORMATS for ending in entry.endings)
        kinds = f"Takes and projects ({endings} *{PROJECT})"
        name, _ = QFileDialog.getOpenFileName(self._window, "Open", "", kinds)
        if name:
            self.load(Path(name))

    def save(self) -> bool:
        """Save the project where it was saved before, or ask where."""
        return self._save_to(self._keeper.path) if self._keeper.path else self.save_as()

    def save_as(self) -> bool:
        """Choose a file and save the project: the original, every edit, and what can be undone."""
        stem = Path(self._session.name).stem
        kind = f"Retake project (*{PROJECT})"
        name, _ = QFileDialog.getSaveFileName(self._window, "Save the project", self._beside(f"{stem}{PROJECT}"), kind)
        return bool(name) and self._save_to(Path(name).with_suffix(PROJECT))

    def export(self) -> bool:
        """Choose a file and write the edited take as other programs read it."""
        stem = Path(self._session.name).stem
        kinds = ";;".join(f"{entry.title} (*{entry.endings[0]})" for entry in FORMATS)
        name, _ = QFileDialog.getSaveFileName(
            self._window, "Export the take", self._beside(f"{stem}_edited.csv"), kinds
        )
        if not name:
            return False
        path = Path(name) if Path(name).suffix else Path(name).with_suffix(".csv")
        try:
            write_take(self._session.take, path)
        except EngineError as error:
            self.told.emit(error.sentence, error.advice)
            return False
        self._settings.remember(path)
        return True

    def open_recording(self, take: Take) -> None:
        """Open what was recorded live, unless edits would be lost."""
        if self.may_lose_edits():
            self._session.open(take, None)
            self._keeper.keep()
            self.opened.emit()

    def load_character(self) -> None:
        """Choose a head to show the take on; none goes back to the bundled one."""
        kinds = "Heads (*.npz *.glb *.gltf *.obj)"
        name, _ = QFileDialog.getOpenFileName(self._window, "Show on another head", "", kinds)
        try:
            self.character_chosen.emit(character_of(Path(name)) if name else None)
        except EngineError as error:
            self.told.emit(error.sentence, error.advice)

    def attach_audio(self) -> None:
        """Choose a recording to play along with the take."""
        kinds = " ".join(f"*{ending}" for ending in media.ENDINGS + media.FILM_ENDINGS)
        name, _ = QFileDialog.getOpenFileName(self._window, "Attach sound", "", f"Sound ({kinds})")
        if name:
            self._media.attach(Path(name))

    def attach_video(self) -> None:
        """Choose a video to watch beneath the face."""
        kinds = " ".join(f"*{ending}" for ending in media.FILM_ENDINGS)
        name, _ = QFileDialog.getOpenFileName(self._window, "Attach a reference video", "", f"Videos ({kinds})")
        if name:
            self._session.attach_video(Path(name))

    def may_lose_edits(self) -> bool:
        """Ask about edits that are not saved; returns whether one may go on."""
        if not self._session.edited:
            return True
        answer = QMessageBox.question(
            self._window,
            "Unsaved edits",
            f"{self._session.name} has edits that are not saved.",
            Answer.Save | Answer.Discard | Answer.Cancel,
        )
        if answer == Answer.Discard:
            self._keeper.forget()
            return True
        return answer == Answer.Save and self.save()

    def offer_left_over(self) -> None:
        """Offer the work of a program that ended early."""
        left = self._keeper.left_over()
        if not left:
            return
        listed = "\n".join(entry.sentence for entry in left)
        box = QMessageBox(self._window)
        box.setWindowTitle("Unsaved work")
        box.setText(f"Retake ended before this was saved:\n\n{listed}")
        restore = box.addButton("Restore", QMessageBox.ButtonRole.AcceptRole)
        discard = box.addButton("Discard", QMessageBox.ButtonRole.DestructiveRole)
        box.addButton("Later", QMessageBox.ButtonRole.RejectRole)
        box.exec()
        try:
            if box.clickedButton() is restore:
                self._keeper.recover(left[0])
                self.opened.emit()
            elif box.clickedButton() is discard:
                for entry in left:
                    self._keeper.discard(entry)
        except EngineError as error:
            self.told.emit(error.sentence, error.advice)

    def _save_to(self, path: Path) -> bool:
        try:
            self._keeper.save_as(path)
        except EngineError as error:
            self.told.emit(error.sentence, error.advice)
            return False
        self._settings.remember(path)
        self.opened.emit()
        return True

    def _beside(self, name: str) -> str:
        """Return a name in the folder of what is open; the program's own demo take is no place to save to."""
        from engine.performance import demo

        path = self._session.path
        folder = path.parent if path is not None and path != demo.BUNDLED else Path.home()
        return str(folder / name)
