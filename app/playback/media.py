"""What lies beside a take: its sound is read in the background, and the transport follows what is heard."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.playback.clock import AudioClock, Sink, WallClock
from app.playback.device import open_device
from app.session import Change, Session
from app.transport import Transport
from engine.formats import audio, film

ENDINGS = audio.ENDINGS
FILM_ENDINGS = film.ENDINGS


@dataclass(frozen=True)
class _Wanted:
    path: Path
    take: Path | None  # the take it was wanted for
    by_hand: bool


class Media(QObject):
    """Attaches sound and video to the open take, found beside it or chosen, and picks the clock.

    Parameters
    ----------
    session, transport : what it belongs to
    open_sink : opens a loudspeaker for a rate and a number of channels, or returns None
    """

    failed = Signal(str, str)  # sentence, advice

    def __init__(
        self,
        session: Session,
        transport: Transport,
        open_sink: Callable[[int, int], Sink | None] = open_device,
    ) -> None:
        super().__init__()
        self._session, self._transport, self._open_sink = session, transport, open_sink
        self._muted = False
        self._playing: tuple[object, float] = (None, 0.0)
        self.reading = LatestWins(lambda wanted: audio.read(wanted.path), name="sound")
        self.reading.done.connect(self._arrived)
        self.reading.failed.connect(self._refused)
        session.changed.connect(self._on_change)
        self._on_change(Change.TAKE)

    def attach(self, path: Path) -> None:
        """Read a recording and play it along with the open take."""
        self.reading.submit(_Wanted(path, self._session.path, True))

    def mute(self, on: bool) -> None:
        """Play without sound; time runs by it all the same."""
        self._muted = on
        if isinstance(self._transport.clock, AudioClock):
            self._transport.clock.muted = on

    def close(self) -> None:
        """End the thread and let go of the loudspeaker."""
        self._session.changed.disconnect(self._on_change)
        self.reading.stop()
        self._transport.use(WallClock())

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            self._look_beside(self._session.path)
        if change & (Change.TAKE | Change.MEDIA):
            self._choose_clock()

    def _look_beside(self, take: Path | None) -> None:
        if take is None:
            return
        filmed = film.beside(take)
        found = audio.beside(take) or filmed  # phones record the sound with the picture
        if found:
            self.reading.submit(_Wanted(found, take, False))
        if filmed:
            self._session.attach_video(filmed)

    def _arrived(self, wanted: _Wanted, recording: audio.Audio) -> None:
        """Attach what was read, unless its take is closed or has got another sound in the meantime."""
        if wanted.take == self._session.path and (wanted.by_hand or self._session.audio is None):
            self._session.attach_audio(recording, self._session.audio_offset_s)

    def _refused(self, wanted: _Wanted, sentence: str, advice: str) -> None:
        """Say what is wrong, but not that a film found beside the take is silent."""
        if wanted.by_hand or wanted.path.suffix.lower() not in film.ENDINGS:
            self.failed.emit(sentence, advice)

    def _choose_clock(self) -> None:
        wanted = self._session.audio, self._session.audio_offset_s
        if wanted[0] is self._playing[0] and wanted[1] == self._playing[1]:
            return
        self._playing = wanted
        self._transport.use(WallClock())  # a device that lets only one in is free before it is asked again
        recording, offset_s = wanted
        sink = self._open_sink(recording.rate, recording.channels) if recording is not None else None
        if recording is not None and sink is not None:
            clock = AudioClock(recording, offset_s, sink)
            clock.muted = self._muted
            self._transport.use(clock)
