"""Flags kept up to date on a thread of their own: all of them when a take is opened, near the edit after one."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QObject

from app.background import LatestWins
from app.session.changes import Change
from app.session.session import Session
from engine.formats.audio import Audio
from engine.quality import Flag, FlagSettings, flags_after, flags_of, parted, seen_of, sound_of
from engine.speech.lane import VisemeLane
from engine.take import Array, Take

Frames = tuple[int, int]


@dataclass(frozen=True, eq=False)
class _Look:
    """What to look at, and where: `touched` since `known` was found, or everywhere where that is None."""

    number: int
    take: Take
    original: Take
    controls: Array
    original_controls: Array
    asked: Array
    visemes: VisemeLane | None
    audio: Audio | None
    audio_offset_s: float
    known: tuple[Flag, ...] | None
    touched: Frames
    settings: FlagSettings


class Flagging(QObject):
    """Finds flags again after each edit and sets them in the session.

    Parameters
    ----------
    session : whose take is looked at
    """

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self._known: tuple[Flag, ...] | None = None  # what was dismissed among them
        self._wanted = session.document.marks.flags, session.document.marks.dismissals
        self._number = 0
        self._touched: list[tuple[int, Frames]] = []  # by the look that it was first part of; not in `_known` yet
        self._work = LatestWins(_look, name="flags")
        self._work.done.connect(self._arrived)
        session.changed.connect(self._on_change)
        self._on_change(Change.TAKE)

    @property
    def idle(self) -> bool:
        """Whether no search is running."""
        return self._work.idle

    def close(self) -> None:
        """End the thread."""
        self._session.changed.disconnect(self._on_change)
        self._work.stop()

    def _on_change(self, change: Change) -> None:
        wanted, self._wanted = (
            self._wanted,
            (self._session.document.marks.flags, self._session.document.marks.dismissals),
        )
        if change & (Change.TAKE | Change.READING) or wanted[0] != self._wanted[0]:
            self._known, self._touched = None, []
            self._submit((0, len(self._session.document.take)))
        elif wanted[1] != self._wanted[1]:
            self._show()
        elif change & Change.CURVES:
            self._submit(self._session.document.touched)
        elif change & (Change.VISEMES | Change.MEDIA):  # what they tell is looked for in the whole take
            self._submit((0, 0))

    def _submit(self, touched: Frames) -> None:
        session = self._session
        self._number += 1
        self._touched.append((self._number, touched))
        everywhere = min(start for _, (start, _) in self._touched), max(stop for _, (_, stop) in self._touched)
        self._work.submit(
            _Look(
                self._number,
                session.document.take,
                session.document.original,
                session.document.controls,
                session.document.original_controls,
                session.document.asked,
                session.document.visemes,
                session.document.audio,
                session.document.offset_s("audio"),
                self._known,
                everywhere,
                session.document.marks.flags,
            )
        )

    def _arrived(self, look: _Look, flags: tuple[Flag, ...]) -> None:
        marks = self._session.document.marks
        if look.original is not self._session.document.original or look.settings != marks.flags:
            return  # that take is closed, or something else is looked for by now
        self._known = flags
        self._touched = [entry for entry in self._touched if entry[0] > look.number]
        self._show()

    def _show(self) -> None:
        """Set in the session which findings count, and which were dismissed."""
        if self._known is not None:
            self._session.document.set_flags(*parted(self._known, self._session.document.marks.dismissals))


def _look(look: _Look) -> tuple[Flag, ...]:
    controls = look.controls, look.original_controls
    audio, fps = look.audio, look.take.fps
    sound = sound_of(audio, fps=fps, offset_s=look.audio_offset_s) if audio is not None else None
    seen = seen_of(look.take, look.original, look.asked, look.visemes, controls=controls, sound=sound)
    if look.known is None:
        return flags_of(seen, look.settings)
    return flags_after(look.known, seen, look.touched, look.settings)
