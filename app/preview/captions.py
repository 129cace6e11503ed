"""What is burnt into a movie beneath the faces: whose they are, timecode and frame, and the notes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from PySide6.QtCore import QCoreApplication, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QImage, QPainter
from PySide6.QtWidgets import QApplication

from app.preview.renderer import Picture
from engine.review.counting import Counting
from engine.words import plain, shortened

GROUND, TEXT, QUIET, NOTE = (QColor(name) for name in ("#14161a", "#e3e6eb", "#a3acb9", "#F0E442"))
LINES_OF_NOTES = 2
LEAST_PX, SHARE = 10, 1 / 32  # of a line's type, at least, and of the picture's height
LINE, MARGIN = 1.5, 0.6  # heights of type
SHOWN_S = 3.0  # for which a note on a single frame can be read
LONGEST = 400  # characters of a note or a name
SHORTER = 0.9  # of a note that does not fit, until it does
MIDDLE, LEFT, RIGHT = (
    Qt.AlignmentFlag.AlignVCenter | side
    for side in (Qt.AlignmentFlag.AlignHCenter, Qt.AlignmentFlag.AlignLeft, Qt.AlignmentFlag.AlignRight)
)
WRAPPED = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop | Qt.TextFlag.TextWordWrap


@dataclass(frozen=True)
class Said:
    """A note as it is burnt in: its text from a frame on, to the frame before `stop`."""

    start: int
    stop: int
    text: str


@dataclass(frozen=True)
class Captions:
    """What is written beneath the faces of a movie.

    Attributes
    ----------
    names : of the faces, from left to right
    counting : how the frames of the take are labelled
    first : number of frames from midnight to the take's first one
    notes : in order of time
    """

    names: tuple[str, ...]
    counting: Counting
    first: int = 0
    notes: tuple[Said, ...] = field(default=())

    def timecode(self, frame: int) -> str:
        """Return the timecode of a frame of the take."""
        return self.counting.label(self.first + frame)

    def note_at(self, frame: int) -> str:
        """Return the text of the notes that are shown at a frame, the newest first; empty where there is none."""
        lasting = round(SHOWN_S * self.counting.rate)
        shown = [note for note in self.notes if note.start <= frame < max(note.stop, note.start + lasting)]
        return "\n".join(plain(note.text, longest=LONGEST) for note in reversed(shown))


def type_px(height: int) -> int:
    """Return the height of the type beneath a picture of a height."""
    return max(LEAST_PX, round(SHARE * height))


def band_height(captions: Captions, height: int) -> int:
    """Return the height of the band beneath a picture of a height, an even number."""
    lines = 2 + (LINES_OF_NOTES if captions.notes else 0)
    return 2 * round(type_px(height) * (lines * LINE + 2 * MARGIN) / 2)


def burnt_in(picture: Picture, captions: Captions, frame: int) -> Picture:
    """Return a picture with the band of a frame beneath it, (height + band, width, 3)."""
    return np.concatenate([picture, band(captions, frame, width=picture.shape[1], height=picture.shape[0])])


def band(captions: Captions, frame: int, *, width: int, height: int) -> Picture:
    """Return the band that belongs beneath a picture of a size, (band height, width, 3)."""
    _require_fonts()
    size = type_px(height)
    image = QImage(width, band_height(captions, height), QImage.Format.Format_RGB32)
    image.fill(GROUND)
    painter = QPainter(image)
    font = QFont()
    font.setPixelSize(size)
    painter.setFont(font)
    step, margin = LINE * size, MARGIN * size
    line = QRectF(margin, margin, width - 2 * margin, step)
    _write_names(painter, captions.names, line, width)
    line.translate(0, step)
    painter.setPen(TEXT)
    painter.drawText(line, LEFT, captions.timecode(frame))
    painter.drawText(line, RIGHT, f"frame {frame}")
    painter.setPen(NOTE)
    rest = QRectF(line.left(), line.bottom(), line.width(), LINES_OF_NOTES * step)
    painter.drawText(rest, WRAPPED, _fitting(captions.note_at(frame), QFontMetricsF(font), rest))
    painter.end()
    return _pixels(image)


def _write_names(painter: QPainter, names: Sequence[str], line: QRectF, width: int) -> None:
    """Write each name in the middle beneath its face."""
    painter.setPen(QUIET)
    part = width / max(1, len(names))
    metrics = QFontMetricsF(painter.font())
    for index, name in enumerate(names):
        place = QRectF(index * part, line.top(), part, line.height())
        text = metrics.elidedText(plain(name, longest=LONGEST), Qt.TextElideMode.ElideMiddle, part - line.left())
        painter.drawText(place, MIDDLE, text)


def _fitting(text: str, metrics: QFontMetricsF, place: QRectF) -> str:
    """Return text that is shortened until it fits its place."""
    while len(text) > 1 and metrics.boundingRect(place, WRAPPED, text).height() > place.height():
        text = shortened(text, int(SHORTER * len(text)))
    return text


def _pixels(image: QImage) -> Picture:
    """Return an image of 32 bits a pixel as an array, (height, width, 3)."""
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine() // 4, 4)
    return np.ascontiguousarray(rows[:, : image.width(), 2::-1])


class _Fonts:
    """What Qt needs before it can write: an application, which a command line has none of."""

    application: QCoreApplication | None = None


def _require_fonts() -> None:
    """Make an application without a screen where there is none."""
    if QCoreApplication.instance() is None:
        _Fonts.application = QApplication(["retake", "-platform", "offscreen"])
