"""The reference video beneath the face: the frame that belongs to the playhead, whatever rate it was filmed at."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from app.background import LatestWins
from app.playback.video import Frame, Picture, Video
from app.preview.renderer import GROUND
from app.session import Change, Session
from app.theme import GRID
from app.widgets.text import Label

HEIGHT_PX = 180


@dataclass(frozen=True)
class _Wanted:
    path: Path
    time_s: float  # of the video


class _Reader:
    """What the background thread holds open."""

    def __init__(self) -> None:
        self._video: Video | None = None

    def frame(self, wanted: _Wanted) -> Frame | None:
        if self._video is None or self._video.path != wanted.path:
            self.close()
            self._video = Video(wanted.path)
        return self._video.frame_at(wanted.time_s)

    def close(self) -> None:
        if self._video is not None:
            self._video.close()
        self._video = None


class _Screen(QWidget):
    """A picture as large as it fits."""

    def __init__(self) -> None:
        super().__init__()
        self.image = QImage()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName("Reference video")

    def sizeHint(self) -> QSize:
        """Low, so that the face keeps its room."""
        return QSize(320, HEIGHT_PX)

    def show_picture(self, picture: Picture | None) -> None:
        """Show a picture, or none."""
        if picture is None:
            self.image = QImage()
        else:
            height, width = picture.shape[:2]
            self.image = QImage(picture.tobytes(), width, height, 3 * width, QImage.Format.Format_RGB888).copy()
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the picture in the middle."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(*GROUND))
        if not self.image.isNull():
            size = QSize(self.image.size()).scaled(self.size(), Qt.AspectRatioMode.KeepAspectRatio)
            left, top = (self.width() - size.width()) / 2, (self.height() - size.height()) / 2
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            painter.drawImage(QRectF(left, top, size.width(), size.height()), self.image)


class ReferencePanel(QFrame):
    """The video's frame at the playhead; hidden while the take has no video.

    Parameters
    ----------
    session : whose playhead, video and offset are shown
    """

    failed = Signal(str, str)  # sentence, advice
    detached = Signal()

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        reader = _Reader()
        self.reading = LatestWins(reader.frame, name="reference video", close=reader.close)
        self.reading.done.connect(self._arrived)
        self.reading.failed.connect(self._refused)
        self.shown = _Screen()
        self._lay_out()
        session.changed.connect(self._on_change)
        self._on_change(Change.MEDIA)

    def _lay_out(self) -> None:
        name = Label("Reference")
        name.setProperty("quiet", True)
        away = QToolButton()
        away.setText("✕")
        away.setToolTip("Detach the reference video")
        away.setAccessibleName("Detach the reference video")
        away.clicked.connect(self.detached)
        row = QHBoxLayout()
        row.addWidget(name)
        row.addStretch(1)
        row.addWidget(away)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, GRID, 0, 0)
        column.addLayout(row)
        column.addWidget(self.shown)

    def close_reader(self) -> None:
        """End the thread and close the file."""
        self.reading.stop()

    def _on_change(self, change: Change) -> None:
        session = self._session
        if change & (Change.TAKE | Change.MEDIA):
            self.setVisible(session.document.video is not None)
        if session.document.video is not None and change & (Change.TAKE | Change.MEDIA | Change.PLAYHEAD):
            # the middle of the take's frame, or rounding would decide between two frames of a video at the same rate
            time_s = (session.view.playhead + 0.5) / session.document.take.fps - session.document.offset_s("video")
            self.reading.submit(_Wanted(session.document.video, time_s))

    def _arrived(self, wanted: _Wanted, frame: Frame | None) -> None:
        if wanted.path == self._session.document.video:
            self.shown.show_picture(None if frame is None else frame.picture)

    def _refused(self, wanted: _Wanted, sentence: str, advice: str) -> None:
        """Report an error once: the video is closed, and read again when the project is opened."""
        if wanted.path == self._session.document.video:
            self._session.document.attach_video(None)
            self.failed.emit(sentence, advice)
