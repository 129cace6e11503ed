"""The line at the bottom: what is open, where the playhead is, what plays, and whether all is saved."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QFrame, QHBoxLayout, QSizePolicy

from app.playback.media import Media
from app.session import Change, Session
from app.session.keeper import Keeper
from app.session.opening import Opening
from app.session.sound import beyond_the_take
from app.theme import GRID
from app.widgets.progress import Progress
from app.widgets.text import Label, Name, tip
from engine.formats.audio import Audio
from engine.take import timecode
from engine.words import counted, plain

LONGEST = 40  # characters of a name in this line
NAMES = ("take", "rate", "length", "place", "pace", "notice", "engine", "sound", "saved", "speed")
TOLD_MS = 12_000  # how long a passing message is shown
LATENCIES = 20  # that the median is taken of


class StatusBar(QFrame):
    """Labels by name, and the progress of a save and of a file that is read, each with a button that stops it.

    Parameters
    ----------
    session, keeper, opening, media : what is shown
    """

    def __init__(self, session: Session, keeper: Keeper, opening: Opening, media: Media) -> None:
        super().__init__()
        self.setProperty("panel", True)
        self._session, self._keeper, self._opening, self._media = session, keeper, opening, media
        self._latencies_ms: list[float] = []
        self.in_frames = False
        self._sound: Audio | None = None  # whose length was shown
        self._passing = QTimer(self, singleShot=True)
        self._labels = {name: Name(longest=LONGEST) if name == "take" else Label() for name in NAMES}
        self._passing.timeout.connect(self._labels["notice"].clear)
        self.saving = Progress("Stop saving", keeper.stop_saving)
        self.opening = Progress("Stop opening", opening.stop)
        self._lay_out()
        self._labels["notice"].setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self._labels["engine"].setText("loading networks…")
        self["place"].setToolTip("Hours, minutes, seconds and frames, and the frame counted from 0, at the playhead")
        self["speed"].setToolTip("How long the face took to follow the mouse")
        session.changed.connect(self._on_change)
        keeper.saving_changed.connect(self._show_saving)
        keeper.progress.connect(self.saving.advance)
        opening.changed.connect(self._show_opening)
        opening.progress.connect(self.opening.advance)
        keeper.saved.connect(self.show_take)
        media.device_changed.connect(self._show_sound)

    def _lay_out(self) -> None:
        row = QHBoxLayout(self)
        row.setContentsMargins(GRID + 2, 3, GRID + 2, 3)
        row.setSpacing(3 * GRID)
        for name, label in self._labels.items():
            label.setProperty("quiet", name != "take")
            row.addWidget(label, 1 if name == "notice" else 0)
            if name == "saved":
                row.addWidget(self.saving)
                row.addWidget(self.opening)

    def __getitem__(self, name: str) -> Label:
        return self._labels[name]

    def engine_ready(self) -> None:
        """Remove the message that the networks are loading."""
        self._labels["engine"].setText("")

    def show_message(self, text: str) -> None:
        """Show a message for some seconds."""
        self["notice"].setText(text)
        self["notice"].setToolTip(tip(text))
        self._passing.start(TOLD_MS)

    def show_lasting(self, text: str) -> None:
        """Show a message until the next one."""
        self._passing.stop()
        self["notice"].setText(text)

    def show_take(self, *_: object) -> None:
        """Show the name, rate and length of the open take."""
        take = self._session.document.take
        self["take"].setText(self._session.document.name)
        self["rate"].setText(f"{take.fps:g} fps")
        self["length"].setText(f"{counted(len(take), 'frame')} · {timecode(take.duration_s, take.fps)}")
        self.show_place()
        self._show_saved()

    def show_place(self) -> None:
        """Show where the playhead is."""
        frame, fps = self._session.view.playhead, self._session.document.take.fps
        self["place"].setText(f"frame {frame:,}" if self.in_frames else f"{timecode(frame / fps, fps)} · {frame}")

    def show_speed(self, speed: float) -> None:
        """Show how fast the take plays where that is not its own speed; 0 is paused."""
        names = {0.25: "¼", 0.5: "½"}
        speed_text = f"{names.get(abs(speed), f'{abs(speed):g}')}× speed"
        self["pace"].setText("" if speed in (0.0, 1.0) else f"{speed_text}, backwards" if speed < 0 else speed_text)

    def count_in_frames(self, on: bool) -> None:
        """Show time in frames, or in timecode too."""
        self.in_frames = on
        self.show_place()

    def timed(self, spent_ms: float) -> None:
        """Show the median time from the mouse event to its picture."""
        self._latencies_ms = [*self._latencies_ms[1 - LATENCIES :], spent_ms]
        self["speed"].setText(f"preview {np.median(self._latencies_ms):.0f} ms")

    def _on_change(self, change: Change) -> None:
        if change & Change.READING:
            self.show_take()
        if change & (Change.TAKE | Change.PLAYHEAD):
            self.show_place()
        if change & (Change.TAKE | Change.CURVES | Change.SAVED):
            self._show_saved()
        if change & Change.MEDIA and self._session.document.audio is not self._sound:
            self._sound = self._session.document.audio
            if beyond := beyond_the_take(self._session):
                self.show_message(beyond)

    def _show_saved(self) -> None:
        saving, opening = self._keeper.saving, self._opening.path
        saved = "saved" if self._keeper.path else ""
        state = "edits not saved yet" if self._session.document.edited else saved
        under_way = [f"saving {plain(saving.name, longest=LONGEST)}…"] if saving else []
        under_way += [f"opening {plain(opening.name, longest=LONGEST)}…"] if opening else []
        self["saved"].setText(" ".join(under_way) or state)

    def _show_saving(self) -> None:
        self.saving.follow(self._keeper.saving is not None)
        self._show_saved()

    def _show_opening(self) -> None:
        self.opening.follow(self._opening.path is not None)
        self._show_saved()

    def _show_sound(self) -> None:
        attached = self._session.document.audio is not None
        self["sound"].setText((f"♪ {self._media.device}" if self._media.device else "♪ silent") if attached else "")
        self["sound"].setToolTip(
            "The loudspeaker that plays" if self._media.device else "No loudspeaker was found; time runs by the clock."
        )
