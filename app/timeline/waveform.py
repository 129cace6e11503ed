"""Draws the waveform from peaks per block, so that an hour is drawn as fast as a second."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QImage, QPainter

from engine.formats.audio import Audio

PEAK_ALPHA, RMS_ALPHA = 110, 255  # of 255: how much of the colour is laid on
QUIETEST = 0.02  # a recording whose loudest sample is below this is not drawn any larger


def draw_waveform(painter: QPainter, audio: Audio, box: QRectF, between_s: tuple[float, float], colour: str) -> None:
    """Draw a recording's peaks and, brighter inside, its root mean square; its loudest moment fills the box.

    Parameters
    ----------
    box : where, in the painter's pixels
    between_s : times of the recording at the box's left and right edge; outside it nothing is drawn
    colour : #rrggbb
    """
    first_s, last_s = between_s
    ratio = painter.device().devicePixelRatio()
    columns, rows = max(1, round(box.width() * ratio)), round(box.height() * ratio) | 1  # odd: silence is a line
    peaks = audio.peaks(first_s, last_s, columns)
    full = max(audio.loudest, QUIETEST)
    heights = np.linspace(full, -full, rows, dtype=np.float32)[:, None]
    half = full / max(1, rows - 1)
    alpha = np.zeros((rows, len(peaks.low)), np.uint8)
    alpha[(heights < peaks.high + half) & (heights > peaks.low - half)] = PEAK_ALPHA
    alpha[np.abs(heights) < peaks.rms] = RMS_ALPHA
    ends_s = peaks.first_s + peaks.column_s * np.arange(1, alpha.shape[1] + 1)
    alpha[:, (ends_s <= 0) | (ends_s - peaks.column_s >= audio.duration_s)] = 0
    per_s = box.width() / max(last_s - first_s, 1e-9)
    left = box.left() + (peaks.first_s - first_s) * per_s
    painter.drawImage(
        QRectF(left, box.top(), alpha.shape[1] * peaks.column_s * per_s, box.height()), _tinted(alpha, colour)
    )


def _tinted(alpha: np.ndarray, colour: str) -> QImage:
    """Return an image of one colour, as opaque at each pixel as `alpha`, (rows, columns) uint8."""
    shade = QColor(colour)
    weight = alpha.astype(np.uint32)
    pixels = weight << 24
    for part, shift in ((shade.red(), 16), (shade.green(), 8), (shade.blue(), 0)):
        pixels |= (weight * part // 255) << shift
    rows, columns = pixels.shape
    return QImage(pixels.tobytes(), columns, rows, 4 * columns, QImage.Format.Format_ARGB32_Premultiplied).copy()
