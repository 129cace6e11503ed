"""What lies beside a take: sound and video are looked for and read in the background, and kept in the project."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, QTimer, Signal

from app.background import LatestWins
from app.playback.clock import AudioClock, Sink, WallClock
from app.playback.device import open_device
from app.playback.packed import unpacked
from app.playback.transport import Transport
from app.playback.video import Video
from app.session import MEDIA, Change, Session
from app.session.commands import MarkCommand
from app.settings import Settings
from engine import project
from engine.formats import audio, film
from engine.project import ENDING, Found
from engine.project import Media as Record

ENDINGS = audio.ENDINGS
FILM_ENDINGS = film.ENDINGS
REST_MS = 400  # after the last nudge: then it is one finished step
PACKED = ".zip"
WORDS = {"audio": "sound", "video": "video"}


@dataclass(frozen=True)
class _Wanted:
    """A file to read for the take opened so many takes ago.

    Attributes
    ----------
    path : of the file; None: `record` is to be looked for in `folders`
    record : what the project says of it, None for what is new
    by_hand : whether the user chose it, and not the program
    """

    opening: int
    kind: str
    path: Path | None
    record: Record | None
    folders: tuple[Path, ...]
    by_hand: bool = False


@dataclass(frozen=True)
class _Read:
    record: Record
    path: Path
    sound: audio.Audio | None


class Media(QObject):
    """Attaches sound and video to the open take, found beside it, chosen, or named by a project, and picks the clock.

    Attaching, detaching and moving in time are steps that can be undone; what a take brings with it is none.

    Parameters
    ----------
    session, transport : what it belongs to
    open_sink : opens a loudspeaker for a rate and a number of channels, or returns None
    settings : remembers where files outside the project's folder are on this computer

    Attributes
    ----------
    missing : what the project names and no file is
    device : the loudspeaker that plays, empty where none does
    """

    failed = Signal(str, str)  # sentence, advice
    missing_changed = Signal()
    device_changed = Signal()

    def __init__(
        self,
        session: Session,
        transport: Transport,
        open_sink: Callable[[int, int], Sink | None] = open_device,
        settings: Settings | None = None,
    ) -> None:
        super().__init__()
        self._session, self._transport, self._open_sink = session, transport, open_sink
        self._settings = settings
        self.missing: dict[str, Found] = {}
        self.device = ""
        self._muted, self._scrubs = False, True
        self._playing: audio.Audio | None = None
        self._opening = 0
        self._shown: dict[str, str] = {}  # by kind: the content that is shown, or looked for
        self._places: dict[str, Path] = {}  # by content: where it was found
        self.reading = LatestWins(_read, name="sound and video")
        self.reading.done.connect(self._arrived)
        self.reading.failed.connect(self._refused)
        self._rest = QTimer(self, singleShot=True, interval=REST_MS)
        self._rest.timeout.connect(self.settle)
        session.changed.connect(self._on_change)
        self._on_change(Change.TAKE)

    @property
    def attached(self) -> bool:
        """Whether there is sound to play."""
        return self._session.document.audio is not None

    # --- what the user asks for

    def attach(self, kind: str, path: Path) -> None:
        """Read a recording (audio) or a video and let it go along with the open take."""
        self._read(kind, path=path, by_hand=True)

    def detach(self, kind: str) -> None:
        """Let the take go on without its sound or video; the file stays where it is."""
        record = self._session.document.marks.medium(kind)
        if record is not None:
            self._push(kind, None, f"detach {project.name_of(record)}")

    def locate(self, kind: str, path: Path) -> None:
        """Use a file in place of the missing one, at the same start; a different content is reported."""
        self._read(kind, path=path, record=self._session.document.marks.medium(kind), by_hand=True)

    def move(self, kind: str, offset_s: float) -> None:
        """Let the sound or video begin at a time in the take; moves in quick succession are one step."""
        if self._session.document.sliding is not None and self._session.document.sliding[0] != kind:
            self.settle()
        if self._session.document.marks.medium(kind) is not None:
            self._session.document.slide(kind, offset_s)
            self._rest.start()

    def settle(self) -> None:
        """Keep the beginning that is shown, as one step."""
        self._rest.stop()
        if self._session.document.sliding is None:
            return
        kind, offset_s = self._session.document.sliding
        record = self._session.document.marks.medium(kind)
        self._session.document.slide(kind, None)
        if record is not None and abs(record.offset_s + offset_s) > 1e-9:
            title = f"move the {WORDS[kind]} to {offset_s * 1e3:+.0f} ms"
            self._push(kind, replace(record, offset_s=0.0 - offset_s), title)

    def settle_in(self, folder: Path) -> None:
        """Name all media as a project in a folder does."""
        self.settle()
        marks = self._session.document.marks
        for record in marks.media:
            place = self._places.get(record.sha256)
            if place is not None:
                marks = marks.with_medium(record.kind, project.placed(record, place, folder))
        self._session.document.set_marks(marks)

    def mute(self, on: bool) -> None:
        """Play without sound; time runs by it all the same."""
        self._muted = on
        self._set_up_clock()

    def scrub_aloud(self, on: bool) -> None:
        """Let moments be heard while the playhead is moved, or not."""
        self._scrubs = on
        self._set_up_clock()

    def use_device(self, name: str) -> None:
        """Play on another loudspeaker; the system's own without a name."""
        self._open_sink = partial(open_device, wanted=name)
        self._playing = None
        self._choose_clock()

    def close(self) -> None:
        """End the thread and release the loudspeaker."""
        self._rest.stop()
        self._session.changed.disconnect(self._on_change)
        self.reading.stop()
        self._transport.use(WallClock())

    # --- following the session

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            self._opening += 1
            self._shown.clear()
            self._tell_missing({})
            self._look_beside(self._session.document.path)
        if change & (Change.TAKE | Change.MARKS):
            self._follow_marks()
        if change & (Change.TAKE | Change.MEDIA):
            self._choose_clock()

    def _look_beside(self, take: Path | None) -> None:
        """Read what lies beside a recorded take; a project says itself what belongs to it."""
        if take is None or take.suffix.lower() == ENDING:
            return
        filmed = take if take.suffix.lower() == PACKED else film.beside(take)
        found = audio.beside(take) or filmed  # phones record the sound with the picture
        for kind, path in (("audio", found), ("video", filmed)):
            if path is not None:
                self._read(kind, path=path)

    def _follow_marks(self) -> None:
        """Read the files that the marks name, and close those they name no more."""
        for kind in MEDIA:
            record = self._session.document.marks.medium(kind)
            content = record.sha256 if record is not None else ""
            if content == self._shown.get(kind, ""):
                continue
            self._shown[kind] = content
            self._show(kind, None)
            self._tell_missing({name: found for name, found in self.missing.items() if name != kind})
            if record is not None:
                self._read(kind, record=record)

    def _read(
        self, kind: str, *, path: Path | None = None, record: Record | None = None, by_hand: bool = False
    ) -> None:
        base = self._session.document.path.parent if self._session.document.path is not None else None
        place = self._place(record.sha256) if record is not None else None
        folders = [folder for folder in (base, place and place.parent) if folder is not None]
        self.reading.submit(_Wanted(self._opening, kind, path, record, tuple(folders), by_hand), kind)

    def _place(self, content: str) -> Path | None:
        known = self._settings.place_of(content) if self._settings is not None else None
        return self._places.get(content) or known

    # --- what came of reading

    def _arrived(self, wanted: _Wanted, result: _Read | Found | None) -> None:
        """Show what was read, unless its take is closed or has got something else in the meantime."""
        if result is None:
            return  # there was nothing beside the take
        now = self._session.document.marks.medium(wanted.kind)
        if wanted.opening != self._opening or (wanted.record is not None and now is None):
            return
        if isinstance(result, Found):
            if now is not None and now.sha256 == result.media.sha256:
                self._tell_missing({**self.missing, wanted.kind: result})
        elif wanted.by_hand:
            self._take_in(wanted, result)
        elif now is None or (wanted.record is not None and now.sha256 == wanted.record.sha256):
            self._use(wanted.kind, result)
            record = replace(now, path=result.record.path) if now is not None else result.record
            self._session.document.set_marks(self._session.document.marks.with_medium(wanted.kind, record))

    def _take_in(self, wanted: _Wanted, result: _Read) -> None:
        """Attach what the user chose, as a step; the file that was missing, found again, is none."""
        self._use(wanted.kind, result)
        name = project.name_of(result.record)
        if wanted.record is None:
            self._push(wanted.kind, result.record, f"attach {name}")
        elif wanted.record.sha256 == result.record.sha256:
            self._session.document.set_marks(self._session.document.marks.with_medium(wanted.kind, result.record))
        else:
            self._push(wanted.kind, result.record, f"replace {project.name_of(wanted.record)}")
            self.failed.emit(
                f"{name} is not the file that was attached; it is used from now on.", "Undo restores the old one."
            )

    def _use(self, kind: str, result: _Read) -> None:
        content = result.record.sha256
        self._shown[kind] = content
        self._places[content] = result.path
        if self._settings is not None:
            self._settings.remember_place(content, result.path)
        self._tell_missing({name: found for name, found in self.missing.items() if name != kind})
        self._show(kind, result)

    def _show(self, kind: str, result: _Read | None) -> None:
        if kind == "audio":
            self._session.document.attach_audio(result.sound if result else None)
        else:
            self._session.document.attach_video(result.path if result else None)

    def _push(self, kind: str, record: Record | None, title: str) -> None:
        marks = self._session.document.marks.with_medium(kind, record)
        self._session.document.undo.push(MarkCommand.of(self._session.document, marks, title))

    def _tell_missing(self, missing: dict[str, Found]) -> None:
        if missing != self.missing:
            self.missing = missing
            self.missing_changed.emit()

    def _refused(self, wanted: _Wanted, sentence: str, advice: str) -> None:
        """Say what is wrong, but not that a film found beside the take is silent."""
        films = (*film.ENDINGS, PACKED)
        found_film = wanted.path is not None and wanted.path.suffix.lower() in films and wanted.kind == "audio"
        if wanted.opening == self._opening and (wanted.by_hand or not found_film):
            self.failed.emit(sentence, advice)

    # --- the clock

    def _choose_clock(self) -> None:
        recording, offset_s = self._session.document.audio, self._session.document.offset_s("audio")
        clock = self._transport.clock
        if recording is self._playing:
            if isinstance(clock, AudioClock):
                clock.shift(offset_s)
            return
        self._playing = recording
        self._transport.use(WallClock())  # a device that lets only one in is free before it is asked again
        sink = self._open_sink(recording.rate, recording.channels) if recording is not None else None
        if recording is not None and sink is not None:
            self._transport.use(AudioClock(recording, offset_s, sink))
            self._set_up_clock()
        self.device = sink.name if sink is not None else ""
        self.device_changed.emit()

    def _set_up_clock(self) -> None:
        if isinstance(self._transport.clock, AudioClock):
            self._transport.clock.muted = self._muted
            self._transport.clock.scrubs = self._scrubs


def _read(wanted: _Wanted) -> _Read | Found | None:
    """Find a file by its content, or take the one that was chosen, and read it; runs on the media's thread.

    None where a zip holds no film.
    """
    record, path = wanted.record, wanted.path
    if path is not None and path.suffix.lower() == PACKED and (path := unpacked(path)) is None:
        return None
    if path is None:
        assert record is not None
        found = project.find(record, wanted.folders[0], wanted.folders[1:]) if wanted.folders else Found(record, None)
        if found.path is None:
            return found
        path = found.path
        record = project.placed(record, path, wanted.folders[0])
    else:
        offset_s = record.offset_s if record is not None else 0.0
        folder = wanted.folders[0] if wanted.folders else path.parent
        record = project.attach(path, folder, kind=wanted.kind, offset_s=offset_s)
    if wanted.kind == "video":
        Video(path).close()  # raises where there is no picture
    return _Read(record, path, audio.read(path) if wanted.kind == "audio" else None)
