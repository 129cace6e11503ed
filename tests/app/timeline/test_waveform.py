from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QImage, QPainter
from pytestqt.qtbot import QtBot

from app.session import Session
from app.theme import DARK
from app.timeline.flags import FLAGS_PX
from app.timeline.panel import AUDIO_PX, RULER_PX, SPANS_PX, Timeline
from app.timeline.waveform import draw_waveform
from engine.formats.audio import Audio
from engine.take import SHAPES, Take

RATE = 8_000


def drawn(audio: Audio, first_s: float, last_s: float, *, width: int = 400, height: int = 41) -> np.ndarray:
    """Return how opaque each pixel is, (height, width)."""
    image = QImage(width, height, QImage.Format.Format_ARGB32_Premultiplied)
    image.fill(0)
    painter = QPainter(image)
    draw_waveform(painter, audio, QRectF(0, 0, width, height), (first_s, last_s), "#ffffff")
    painter.end()
    return np.frombuffer(image.constBits(), np.uint8).reshape(height, width, 4)[:, :, 3].copy()


def test_height_shows_the_peak_and_inside_it_brighter_the_rms(qtbot: QtBot) -> None:
    time_s = np.arange(RATE * 4) / RATE
    loud = np.select([time_s < 1, time_s < 2, time_s < 3], [0.0, 0.4, 0.5]) * np.sin(2 * np.pi * 200 * time_s)
    alpha = drawn(Audio(loud.astype(np.float32), RATE), 0.0, 4.0)
    quiet, heard = alpha[:, 50], alpha[:, 150]
    assert np.flatnonzero(quiet).tolist() == [20] and quiet[20] < 255  # silence is a faint line
    assert abs((heard > 0).sum() - 0.8 * 41) <= 2
    assert abs((heard == 255).sum() - 0.8 / np.sqrt(2) * 41) <= 2
    assert heard[20] == 255


def test_beyond_the_recording_nothing_is_drawn(qtbot: QtBot) -> None:
    alpha = drawn(Audio(np.full(RATE, 0.5, np.float32), RATE), -1.0, 3.0)
    assert not alpha[:, :98].any() and not alpha[:, 202:].any() and alpha[20, 102:198].all()


@pytest.fixture
def timeline(qtbot: QtBot) -> Timeline:
    made = Timeline(Session(Take(weights=np.zeros((300, len(SHAPES))), fps=30.0)), DARK, gutter_px=100)
    qtbot.addWidget(made)
    made.resize(600, 120)
    return made


def test_the_lane_is_there_only_while_there_is_sound(timeline: Timeline) -> None:
    session = timeline._session
    assert timeline.sizeHint().height() == RULER_PX + SPANS_PX + FLAGS_PX
    before = timeline.grab().toImage()
    session.document.attach_audio(Audio(np.ones(RATE, np.float32) * 0.5, RATE))
    session.document.slide("audio", 5.0)
    assert timeline.sizeHint().height() == RULER_PX + AUDIO_PX + SPANS_PX + FLAGS_PX
    image = timeline.grab().toImage()
    middle = RULER_PX + AUDIO_PX // 2
    quiet = QColor(DARK.quiet)
    assert image.pixelColor(round(timeline.x_of(165)), middle) == quiet  # at 5.5 s
    assert image.pixelColor(round(timeline.x_of(60)), middle) != quiet
    session.document.attach_audio(None)
    assert timeline.grab().toImage() == before
