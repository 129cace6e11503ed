"""Sound and video belong to a project: attached, moved in time, saved, lost, found again, replaced, detached."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
import soundfile
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QPushButton
from pytestqt.qtbot import QtBot

from app.bench.playback import NullSink
from app.timeline.panel import AUDIO_PX, RULER_PX
from app.window.main_window import MainWindow
from engine.lab.performer import demo
from tests.films import film
from tests.journeys.conftest import load, settled

LEFT, PLAIN, ALT = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.AltModifier
RATE = 16_000
LANE_Y = RULER_PX + AUDIO_PX // 2


def recording(path: Path, seed: int = 0) -> Path:
    path.parent.mkdir(exist_ok=True)
    soundfile.write(path, np.random.default_rng(seed).uniform(-0.5, 0.5, RATE * 8), RATE)
    return path


@pytest.fixture
def chosen(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The files that the next dialogs are answered with."""
    answers: list[Path] = []
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(answers.pop(0)), ""))
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(answers.pop(0)), ""))
    return answers


def attached(qtbot: QtBot, window: MainWindow, chosen: list[Path], path: Path, kind: str = "audio") -> None:
    chosen.append(path)
    window.actions_by_name[f"attach_{kind}"].trigger()
    qtbot.waitUntil(lambda: window.session.document.marks.medium(kind) is not None, timeout=10_000)


def save(qtbot: QtBot, window: MainWindow, chosen: list[Path], path: Path) -> None:
    chosen.append(path)
    with qtbot.waitSignal(window.keeper.saved, timeout=10_000):
        QTest.keyClick(window, Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)
    assert not chosen


def button(window: MainWindow, title: str) -> QPushButton:
    (found,) = [each for each in window.missing.findChildren(QPushButton) if each.text() == title and each.isVisible()]
    return found


def test_sound_is_attached_moved_saved_and_comes_back(
    qtbot: QtBot, window: MainWindow, chosen: list[Path], tmp_path: Path
) -> None:
    window.media._open_sink = NullSink
    session, timeline = window.session, window.timeline
    sound = recording(tmp_path / "elsewhere" / "Ärger 顔.wav")
    attached(qtbot, window, chosen, sound)
    settled(qtbot, window)
    assert session.document.undo.undoText() == "attach Ärger 顔.wav" and window.status["sound"].text() == "♪ nothing"

    QTest.mouseMove(timeline, QPoint(round(timeline.x_of(100)), LANE_Y))
    assert timeline.cursor().shape() == Qt.CursorShape.SizeHorCursor
    QTest.mousePress(timeline, LEFT, PLAIN, QPoint(round(timeline.x_of(100)), LANE_Y))
    QTest.mouseMove(timeline, QPoint(round(timeline.x_of(110)), LANE_Y))
    assert session.document.sliding is not None and session.document.undo.count() == 1
    QTest.mouseMove(timeline, QPoint(round(timeline.x_of(115)), LANE_Y))
    QTest.mouseRelease(timeline, LEFT, PLAIN, QPoint(round(timeline.x_of(115)), LANE_Y))
    assert session.document.undo.count() == 2 and session.document.offset_s("audio") == pytest.approx(0.5, abs=0.04)
    assert window.attached.boxes["audio"].milliseconds.value() == round(1e3 * session.document.offset_s("audio"))

    box = window.attached.boxes["audio"].milliseconds
    box.selectAll()
    QTest.keyClicks(box, "250")
    QTest.keyClick(box, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: session.document.undo.count() == 3, timeout=10_000)
    assert session.document.offset_s("audio") == 0.25 and window.attached.boxes["audio"].frames.value() == 7.5
    window.curves.setFocus()
    for _ in range(3):
        QTest.keyClick(window, Qt.Key.Key_Right, ALT)
    qtbot.waitUntil(lambda: session.document.undo.count() == 4, timeout=10_000)
    assert session.document.undo.undoText() == "move the sound to +350 ms"
    assert session.document.marks.medium("audio").offset_s == pytest.approx(-0.35)
    for offset_s in (0.25, pytest.approx(0.5, abs=0.04), 0.0):
        QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
        assert session.document.offset_s("audio") == offset_s
    for _ in range(3):
        session.document.undo.redo()

    save(qtbot, window, chosen, tmp_path / "a project.retake")
    load(qtbot, window, demo.BUNDLED)
    assert session.document.audio is None and not window.attached.isVisible()
    load(qtbot, window, tmp_path / "a project.retake")
    qtbot.waitUntil(lambda: session.document.audio is not None, timeout=10_000)
    assert session.document.audio.path == sound and session.document.offset_s("audio") == pytest.approx(0.35)
    assert not window.missing.isVisible() and not session.document.edited

    QTest.mouseClick(window.attached.boxes["audio"].away, LEFT)
    assert (
        session.document.audio is None
        and session.document.marks.media == ()
        and session.document.undo.undoText() == "detach Ärger 顔.wav"
    )
    QTest.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(lambda: session.document.audio is not None, timeout=10_000)
    assert session.document.offset_s("audio") == pytest.approx(0.35)


def test_a_click_on_the_waveform_goes_there_and_moves_nothing(
    qtbot: QtBot, window: MainWindow, chosen: list[Path], tmp_path: Path
) -> None:
    attached(qtbot, window, chosen, recording(tmp_path / "a.wav"))
    settled(qtbot, window)
    QTest.mouseClick(window.timeline, LEFT, PLAIN, QPoint(round(window.timeline.x_of(60)), LANE_Y))
    assert window.session.view.playhead == 60 and window.session.document.undo.count() == 1


def test_what_lay_beside_a_take_is_in_its_project_and_undoing_older_steps_keeps_it(
    qtbot: QtBot, window: MainWindow, chosen: list[Path], tmp_path: Path
) -> None:
    take = Path(shutil.copy(demo.BUNDLED, tmp_path / "slate.csv"))
    recording(tmp_path / "slate.wav")
    film(tmp_path / "slate.mp4", [round(1000 * n / 30) for n in range(60)])
    load(qtbot, window, take)
    window.session.view.select((20, 40))
    window.timeline.marked.emit()  # a step from before the sound is found
    qtbot.waitUntil(lambda: len(window.session.document.marks.media) == 2, timeout=10_000)
    assert window.session.document.undo.count() == 1
    window.session.document.undo.undo()
    assert window.session.document.audio is not None and window.session.document.video is not None
    (tmp_path / "projects").mkdir()
    save(qtbot, window, chosen, tmp_path / "projects" / "another name.retake")
    load(qtbot, window, demo.BUNDLED)
    load(qtbot, window, tmp_path / "projects" / "another name.retake")
    qtbot.waitUntil(
        lambda: window.session.document.audio is not None and window.session.document.video is not None, timeout=10_000
    )


def test_a_file_that_was_moved_is_located_and_a_different_content_reported(
    qtbot: QtBot, window: MainWindow, chosen: list[Path], tmp_path: Path
) -> None:
    session, project = window.session, tmp_path / "p" / "a.retake"
    attached(qtbot, window, chosen, recording(tmp_path / "p" / "a.wav"))
    window.media.move("audio", 0.2)
    window.media.settle()
    save(qtbot, window, chosen, project)
    moved = tmp_path / "moved to" / "b.wav"
    moved.parent.mkdir()
    shutil.move(tmp_path / "p" / "a.wav", moved)
    load(qtbot, window, project)
    qtbot.waitUntil(window.missing.isVisible, timeout=10_000)
    assert session.document.audio is None and session.document.marks.medium("audio") is not None
    assert window.actions_by_name["locate_media"].isEnabled()

    chosen.append(moved)
    QTest.mouseClick(button(window, "Locate a.wav…"), LEFT)
    qtbot.waitUntil(lambda: session.document.audio is not None, timeout=10_000)
    assert not window.missing.isVisible() and not window.notices.isVisible()
    assert (
        session.document.undo.count() == 2 and session.document.offset_s("audio") == 0.2
    )  # the same file: nothing was done
    qtbot.waitUntil(lambda: window.keeper._work.idle, timeout=10_000)
    load(qtbot, window, demo.BUNDLED)
    load(qtbot, window, project)
    qtbot.waitUntil(lambda: session.document.audio is not None, timeout=10_000)  # and it is found there from now on

    moved.unlink()
    load(qtbot, window, demo.BUNDLED)
    load(qtbot, window, project)
    qtbot.waitUntil(window.missing.isVisible, timeout=10_000)
    chosen.append(recording(tmp_path / "other.wav", seed=1))
    QTest.mouseClick(button(window, "Locate b.wav…"), LEFT)
    qtbot.waitUntil(lambda: session.document.audio is not None, timeout=10_000)
    assert window.notices.text.text().startswith("other.wav is not the file that was attached; it is used from now on.")
    assert session.document.undo.undoText() == "replace b.wav" and session.document.offset_s("audio") == 0.2
    session.document.undo.undo()
    qtbot.waitUntil(window.missing.isVisible, timeout=10_000)


def test_a_file_that_was_cut_short_can_be_used_all_the_same_or_detached(
    qtbot: QtBot, window: MainWindow, chosen: list[Path], tmp_path: Path
) -> None:
    session, project = window.session, tmp_path / "a.retake"
    sound, video = recording(tmp_path / "a.wav"), film(tmp_path / "a.mp4", range(0, 2000, 33))
    attached(qtbot, window, chosen, sound)
    attached(qtbot, window, chosen, video, "video")
    save(qtbot, window, chosen, project)
    for path in (sound, video):
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    load(qtbot, window, project)
    qtbot.waitUntil(lambda: len(window.media.missing) == 2, timeout=10_000)
    buttons = [each for each in window.missing.findChildren(QPushButton) if each.text() == "Use it all the same"]
    QTest.mouseClick(buttons[0], LEFT)
    qtbot.waitUntil(lambda: session.document.audio is not None, timeout=10_000)
    assert 3.9 < session.document.audio.duration_s < 4.1 and list(window.media.missing) == ["video"]
    qtbot.waitUntil(lambda: any(each.isVisible() for each in window.missing.findChildren(QPushButton)))  # laid anew
    QTest.mouseClick(button(window, "Use it all the same"), LEFT)
    told = window.notices.text
    qtbot.waitUntil(lambda: told.text().startswith("a.mp4 could not be read"), timeout=10_000)  # half a film is none
    assert session.document.video is None and window.missing.isVisible()
    QTest.mouseClick(button(window, "Detach it"), LEFT)
    assert not window.missing.isVisible() and [media.kind for media in session.document.marks.media] == ["audio"]


def test_a_reference_video_is_nudged_and_detached_beside_its_picture(
    qtbot: QtBot, window: MainWindow, chosen: list[Path], tmp_path: Path
) -> None:
    session = window.session
    attached(qtbot, window, chosen, film(tmp_path / "a.mp4", [round(1000 * n / 30) for n in range(90)]), "video")
    qtbot.waitUntil(window.reference.isVisible, timeout=10_000)
    QTest.keyClick(window, Qt.Key.Key_Left, ALT | Qt.KeyboardModifier.ShiftModifier)
    assert session.document.offset_s("video") == pytest.approx(-1 / 30)
    qtbot.waitUntil(lambda: session.document.undo.undoText() == "move the video to -33 ms", timeout=10_000)
    qtbot.waitUntil(lambda: not window.reference.shown.image.isNull(), timeout=10_000)
    picture: QImage = window.reference.shown.image
    assert not picture.isNull()
    window.actions_by_name["detach_video"].trigger()
    assert not window.reference.isVisible() and session.document.marks.media == ()
