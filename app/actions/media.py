"""The actions about sound and reference video, and the questions they ask."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QFileDialog, QWidget

from app.playback import media
from app.playback.media import Media
from app.session import Session
from engine import project

ENDINGS = {"audio": media.ENDINGS + media.FILM_ENDINGS, "video": media.FILM_ENDINGS}
KINDS = {"audio": "Sound", "video": "Videos"}


class MediaActions(QObject):
    """Each public method without arguments is an action of the table.

    Parameters
    ----------
    session, media : what is open, and what plays along
    window : the parent of the dialogs
    """

    def __init__(self, session: Session, media: Media, window: QWidget) -> None:
        super().__init__()
        self._session, self._media, self._window = session, media, window

    def attach_audio(self) -> None:
        """Choose a recording to play along with the take."""
        if path := self._chosen("audio", "Attach sound"):
            self._media.attach("audio", path)

    def attach_video(self) -> None:
        """Choose a video to watch beneath the face."""
        if path := self._chosen("video", "Attach a reference video"):
            self._media.attach("video", path)

    def detach_audio(self) -> None:
        """Let the take go on without its sound."""
        self._media.detach("audio")

    def detach_video(self) -> None:
        """Let the take go on without its reference video."""
        self._media.detach("video")

    def locate_media(self) -> None:
        """Choose the first file that is missing."""
        for kind in list(self._media.missing)[:1]:
            self.locate(kind)

    def locate(self, kind: str) -> None:
        """Choose the file that takes the place of the one that is missing."""
        record = self._session.document.marks.medium(kind)
        if record is not None and (path := self._chosen(kind, f"Where is {project.name_of(record)}?")):
            self._media.locate(kind, path)

    def use_found(self, kind: str) -> None:
        """Use the file that has the name but not the content of the one that was attached."""
        found = self._media.missing.get(kind)
        if found is not None and found.changed is not None:
            self._media.locate(kind, found.changed)

    def sound_earlier(self) -> None:
        """Let the sound begin a frame earlier."""
        self._nudge("audio", -1)

    def sound_later(self) -> None:
        """Let the sound begin a frame later."""
        self._nudge("audio", 1)

    def video_earlier(self) -> None:
        """Let the video begin a frame earlier."""
        self._nudge("video", -1)

    def video_later(self) -> None:
        """Let the video begin a frame later."""
        self._nudge("video", 1)

    def _nudge(self, kind: str, frames: int) -> None:
        self._media.move(kind, self._session.document.offset_s(kind) + frames / self._session.document.take.fps)

    def _chosen(self, kind: str, title: str) -> Path | None:
        endings = " ".join(f"*{ending}" for ending in ENDINGS[kind])
        name, _ = QFileDialog.getOpenFileName(self._window, title, "", f"{KINDS[kind]} ({endings})")
        return Path(name) if name else None
