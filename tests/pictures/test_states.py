"""What the window looks like in its states, beside pictures that a person has looked at.

Renew them after a wanted change, and look at each: RETAKE_RENEW_PICTURES=1 python -m pytest tests/pictures
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtGui import QImage
from pytestqt.qtbot import QtBot

from app.main_window import MainWindow
from engine.project import Media
from tests.journeys.conftest import no_dialog, settled, window

HERE = Path(__file__).parent
SIZE = (1280, 800)
ALLOWED_MEAN = 5.0  # of 255: fonts and software GL differ a little from machine to machine, a lost panel by far more

__all__ = ["no_dialog", "window"]  # fixtures


def first_minute(opened: MainWindow) -> None:
    opened.session.move_playhead(175)


def weights_shown(opened: MainWindow) -> None:
    opened.session.expand(0)
    opened.edits.scale_tool()
    opened.session.select((60, 100))


def pinning_in_light(opened: MainWindow) -> None:
    opened.actions_by_name["light_theme"].trigger()
    opened.edits.pin_tool()
    opened.session.move_playhead(175)


def told_off(opened: MainWindow) -> None:
    opened.notices.tell("take.csv is not a Live Link Face file.", "Export it from the app as CSV.")


def sound_missing(opened: MainWindow) -> None:
    record = Media("audio", "sound/slate.wav", "0" * 64, -0.25)
    opened.session.set_marks(opened.session.marks.with_medium("audio", record))


STATES: tuple[Callable[[MainWindow], None], ...] = (
    first_minute,
    weights_shown,
    pinning_in_light,
    told_off,
    sound_missing,
)


def pixels(image: QImage) -> np.ndarray:
    image = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].astype(float)


@pytest.mark.parametrize("state", STATES, ids=lambda state: state.__name__)
def test_a_state_looks_as_it_did(qtbot: QtBot, window: MainWindow, state: Callable[[MainWindow], None]) -> None:
    window.resize(*SIZE)
    state(window)
    settled(qtbot, window)
    qtbot.waitUntil(lambda: window.media.reading.idle, timeout=10_000)
    settled(qtbot, window)
    window.status["speed"].clear()
    image = window.grab().toImage()
    path = HERE / f"{state.__name__}.png"
    if os.environ.get("RETAKE_RENEW_PICTURES"):
        image.save(str(path))
    known = QImage(str(path))
    assert (image.width(), image.height()) == (known.width(), known.height())
    assert np.abs(pixels(image) - pixels(known)).mean() < ALLOWED_MEAN
