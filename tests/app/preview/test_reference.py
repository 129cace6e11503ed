from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.preview.reference import ReferencePanel
from app.session import Session
from engine.take import SHAPES, Take
from tests.films import film, shade, sound_only


@pytest.fixture
def panel(qtbot: QtBot):
    made = ReferencePanel(Session(Take(weights=np.zeros((90, len(SHAPES))), fps=30.0)))
    yield made
    made.close_reader()
    made.deleteLater()


def settled(qtbot: QtBot, panel: ReferencePanel) -> None:
    qtbot.waitUntil(lambda: panel.reading.idle, timeout=10_000)
    qtbot.wait(10)


def shown(qtbot: QtBot, panel: ReferencePanel) -> int | None:
    settled(qtbot, panel)
    image = panel.shown.image
    return None if image.isNull() else image.pixelColor(image.width() // 2, image.height() // 2).green()


def test_the_frame_at_the_playhead_is_shown_shifted_by_the_offset(qtbot, panel, tmp_path: Path) -> None:
    session = panel._session
    assert panel.isHidden()
    session.document.attach_video(film(tmp_path / "a.mp4", [round(1000 * n / 30) for n in range(60)]))
    assert not panel.isHidden()
    for frame in (0, 1, 30, 29, 59, 12):
        session.view.move_playhead(frame)
        assert abs(shown(qtbot, panel) - shade(frame)) <= 3
    session.view.move_playhead(75)
    assert shown(qtbot, panel) is None  # the video has ended
    session.document.slide("video", 1.0)
    assert abs(shown(qtbot, panel) - shade(45)) <= 3
    session.document.attach_video(None)
    assert panel.isHidden()


def test_a_file_without_a_picture_gives_a_sentence_and_is_taken_away(qtbot, panel, tmp_path: Path) -> None:
    with qtbot.waitSignal(panel.failed, timeout=10_000) as told:
        panel._session.document.attach_video(sound_only(tmp_path / "a.mp4"))
    assert "no moving picture" in told.args[0]
    assert panel._session.document.video is None and panel.isHidden()


def test_another_take_has_no_video(qtbot, panel, tmp_path: Path) -> None:
    session = panel._session
    session.document.attach_video(film(tmp_path / "a.mp4", [0, 33, 67]))
    session.open(session.document.take, tmp_path / "b.csv")
    assert panel.isHidden()
