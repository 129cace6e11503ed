"""The name that is written is the name that was asked about; two Retakes on one project; the take as it was recorded."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDialogButtonBox, QFileDialog, QLineEdit, QMessageBox
from pytestqt.qtbot import QtBot

from app.settings import Settings
from app.window.main_window import MainWindow
from engine import project
from engine.formats import read_take
from engine.lab.performer import demo
from engine.project import Contents, Project
from tests.journeys.conftest import end, load, noted, saved_as, settled

Answer = QMessageBox.StandardButton
CONTROL_S = (Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)


@pytest.fixture
def take(qtbot: QtBot, window: MainWindow, tmp_path: Path) -> Path:
    """A recording that is open, in a folder of its own."""
    (tmp_path / "shots").mkdir()
    path = tmp_path / "shots" / "take.csv"
    shutil.copyfile(demo.BUNDLED, path)
    load(qtbot, window, path)
    settled(qtbot, window)
    return path


def answering(monkeypatch: pytest.MonkeyPatch, answer: Answer) -> list[str]:
    asked: list[str] = []
    monkeypatch.setattr(QMessageBox, "question", lambda *words: (asked.append(words[2]), answer)[1])
    return asked


def typing(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Put a name in the real dialog, which is Qt's own, and press its button."""
    real = QFileDialog.getSaveFileName

    def ask(*words: object) -> tuple[str, str]:
        def answer() -> None:
            dialogs = [each for each in QApplication.topLevelWidgets() if isinstance(each, QFileDialog)]
            dialog = next((each for each in dialogs if each.isVisible()), None)
            if dialog is None:  # it is still being built
                QTimer.singleShot(20, answer)
                return
            dialog.findChild(QLineEdit, "fileNameEdit").setText(name)
            QTest.mouseClick(dialog.findChild(QDialogButtonBox).buttons()[0], Qt.MouseButton.LeftButton)

        QTimer.singleShot(20, answer)
        return real(*words, options=QFileDialog.Option.DontUseNativeDialog)

    monkeypatch.setattr(QFileDialog, "getSaveFileName", ask)


def choosing(monkeypatch: pytest.MonkeyPatch, *paths: Path | str) -> list[str]:
    """Choose one name after the other, then none."""
    suggested, answers = [], [*map(str, paths)]
    monkeypatch.setattr(
        QFileDialog,
        "getSaveFileName",
        lambda *words: (suggested.append(words[2]), (answers.pop(0) if answers else "", ""))[1],
    )
    return suggested


def test_a_name_typed_without_an_ending_does_not_replace_the_recording(
    window: MainWindow, take: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = take.read_bytes()
    noted(window, "one")
    typing(monkeypatch, str(take.with_suffix("")))
    asked = answering(monkeypatch, Answer.No)
    monkeypatch.setattr("app.widgets.saving.may_replace", lambda *words: stop(words[1]))

    def stop(sentence: str) -> bool:
        asked.append(sentence)
        choosing(monkeypatch)  # the dialog comes again, and is closed
        return False

    window.files.export()
    assert asked == ["take.csv is there already."] and take.read_bytes() == before


def test_a_project_saved_without_an_ending_asks_about_the_file_it_would_replace(
    qtbot: QtBot, window: MainWindow, take: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = take.with_name("scene.retake")
    project.create(old, Contents(read_take(take))).close()
    before = old.read_bytes()
    noted(window, "one")
    suggested = choosing(monkeypatch, take.with_name("scene"))
    asked = answering(monkeypatch, Answer.No)
    QTest.keyClick(window, *CONTROL_S)
    assert asked == ["scene.retake is there already. Replace it?"] and suggested[1] == str(old)
    assert window.keeper.saving is None and old.read_bytes() == before
    choosing(monkeypatch, take.with_name("scene"))
    answering(monkeypatch, Answer.Yes)
    with qtbot.waitSignal(window.keeper.saved, timeout=10_000):
        QTest.keyClick(window, *CONTROL_S)
    assert window.keeper.path == old and old.read_bytes() != before


@pytest.mark.parametrize(
    ("typed", "written"),
    [
        ("scene", "scene.retake"),
        ("scene.v2", "scene.v2.retake"),
        ("take.csv", "take.csv.retake"),
        ("A.RETAKE", "A.RETAKE"),
    ],
)
def test_a_project_has_the_name_that_was_typed(
    qtbot: QtBot, window: MainWindow, take: Path, monkeypatch: pytest.MonkeyPatch, typed: str, written: str
) -> None:
    (kept := take.with_name("scene.retake" if typed == "scene.v2" else "other.retake")).write_bytes(b"precious")
    noted(window, "one")
    choosing(monkeypatch, take.with_name(typed))
    with qtbot.waitSignal(window.keeper.saved, timeout=10_000) as told:
        QTest.keyClick(window, *CONTROL_S)
    assert told.args == [take.with_name(written)] and kept.read_bytes() == b"precious"


@pytest.mark.parametrize("saved", [False, True])
@pytest.mark.parametrize("answer", [Answer.No, Answer.Yes])
def test_exporting_onto_the_recording_asks(
    qtbot: QtBot, window: MainWindow, take: Path, monkeypatch: pytest.MonkeyPatch, saved: bool, answer: Answer
) -> None:
    before = take.read_bytes()
    noted(window, "one")
    if saved:
        saved_as(qtbot, window, take.with_name("scene.retake"), monkeypatch)
    choosing(monkeypatch, take)
    asked = answering(monkeypatch, answer)
    written: list[Path] = []
    monkeypatch.setattr("app.actions.file.write_take", lambda _, path, *__: written.append(path))
    window.files.export()
    assert asked == ["take.csv is the take as it was recorded. Replace it?"]
    assert written == ([take] if answer == Answer.Yes else []) and take.read_bytes() == before


@pytest.mark.parametrize(
    ("save", "ending"), [("save_labels", ".json"), ("save_places", ".csv"), ("export", ".csv"), ("save_as", ".retake")]
)
def test_every_save_dialog_asks_about_the_name_it_writes(
    window: MainWindow, take: Path, monkeypatch: pytest.MonkeyPatch, save: str, ending: str
) -> None:
    there = take.with_name(f"there{ending}")
    there.write_bytes(b"precious")
    choosing(monkeypatch, take.with_name("there"))
    asked = answering(monkeypatch, Answer.No)
    getattr(window.retarget if hasattr(window.retarget, save) else window.files, save)()
    assert asked == [f"{there.name} is there already. Replace it?"] and there.read_bytes() == b"precious"


def test_no_file_is_chosen_for_writing_in_any_other_way() -> None:
    found = [path.name for path in Path("app").rglob("*.py") if re.search("getSaveFile|AcceptSave", path.read_text())]
    assert found == ["saving.py"]


# --- two Retakes


def test_a_project_that_another_retake_has_open_is_offered_as_a_copy(
    qtbot: QtBot, window: MainWindow, take: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    path = take.with_name("scene.retake")
    noted(window, "one")
    saved_as(qtbot, window, path, monkeypatch)
    second = MainWindow(read_take(take), take, Settings(tmp_path / "other.ini"), unsaved=tmp_path / "unsaved")
    qtbot.addWidget(second)
    asked = answering(monkeypatch, Answer.Cancel)
    second.load(path)
    qtbot.waitUntil(lambda: bool(asked), timeout=20_000)
    assert "scene.retake is open in another Retake." in asked[0] and "copy" in asked[0]
    assert second.session.document.path == take

    answering(monkeypatch, Answer.Open)
    with qtbot.waitSignal(second.files.opened, timeout=20_000):
        second.load(path)
    assert "copy of scene.retake" in second.notices.text.text() and second.keeper.path is None
    assert [note.text for note in second.session.document.marks.notes] == ["one"]
    with qtbot.waitSignal(second.keeper.kept, timeout=20_000):
        noted(second, "two")
    with qtbot.waitSignal(window.keeper.kept, timeout=20_000):
        noted(window, "three")
    choosing(monkeypatch, take.with_name("mine.retake"))
    with qtbot.waitSignal(second.keeper.saved, timeout=20_000):
        second.files.save()
    end(qtbot, second)
    texts = _texts(path), _texts(take.with_name("mine.retake"))
    assert texts == (["one", "three"], ["one", "two"])


def _texts(path: Path) -> list[str]:
    return [note.text for note in Project.open(path, read_only=True).contents.marks.notes]


def test_saving_over_what_another_retake_has_open_is_refused(
    qtbot: QtBot, window: MainWindow, take: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = take.with_name("scene.retake")
    other = project.create(path, Contents(read_take(take)))
    noted(window, "one")
    choosing(monkeypatch, path)
    QTest.keyClick(window, *CONTROL_S)
    qtbot.waitUntil(lambda: "open in another Retake" in window.notices.text.text(), timeout=10_000)
    assert window.session.document.edited
    other.close()


def test_a_project_that_was_replaced_is_said_and_the_window_goes_on(
    qtbot: QtBot, window: MainWindow, take: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    path, other = take.with_name("scene.retake"), tmp_path / "new.retake"
    saved_as(qtbot, window, path, monkeypatch)
    project.create(other, Contents(read_take(take))).close()
    wanted = other.read_bytes()
    other.replace(path)
    step: Callable[[], object] = window.keeper._looks.timeout.emit
    step()
    qtbot.waitUntil(lambda: "replaced by another program" in window.notices.text.text(), timeout=10_000)
    assert window.isWindowModified() and "unsaved work" in window.notices.text.text()
    noted(window, "two")
    saved_as(qtbot, window, take.with_name("mine.retake"), monkeypatch)
    assert path.read_bytes() == wanted and _texts(take.with_name("mine.retake")) == ["two"]
