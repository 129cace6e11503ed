"""The line at the bottom: what is open, where the playhead is, what plays, and whether all is saved."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QProgressBar, QToolButton

from app.keeper import Keeper
from app.playback.media import Media
from app.session import Change, Session
from app.theme import GRID
from engine.take import timecode

NAMES = ("take", "rate", "length", "place", "notice", "engine", "sound", "saved", "speed")
LATENCIES = 20  # that the median is taken of
SHOWN_AFTER_MS = 150  # a shorter save needs no bar
BAR_PX, BAR_HEIGHT_PX, STEPS = 96, 8, 1000


class StatusBar(QFrame):
    """Labels by name, and the progress of a save with a button that stops it.

    Parameters
    ----------
    session, keeper, media : what is told of
    """

    def __init__(self, session: Session, keeper: Keeper, media: Media) -> None:
        super().__init__()
        self.setProperty("panel", True)
        self._session, self._keeper, self._media = session, keeper, media
        self._latencies_ms: list[float] = []
        self.in_frames = False
        self._labels = {name: QLabel() for name in NAMES}
        self.bar = QProgressBar(minimum=0, maximum=STEPS, textVisible=False)
        self.bar.setFixedSize(BAR_PX, BAR_HEIGHT_PX)
        self.stop = QToolButton()
        self.stop.setText("✕")
        self.stop.setFixedSize(2 * BAR_HEIGHT_PX, 2 * BAR_HEIGHT_PX)  # no higher than a line: nothing moves
        self.stop.setStyleSheet("padding: 0;")
        self.stop.setToolTip("Stop saving")
        self.stop.setAccessibleName("Stop saving")
        self.stop.clicked.connect(keeper.stop_saving)
        self._lay_out()
        self._labels["engine"].setText("loading networks…")
        self._soon = QTimer(self, singleShot=True, interval=SHOWN_AFTER_MS)
        self._soon.timeout.connect(self._show_saving)
        session.changed.connect(self._on_change)
        keeper.saving_changed.connect(self._show_saving)
        keeper.saving_changed.connect(self._soon.start)
        keeper.progress.connect(self._show_progress)
        keeper.saved.connect(self.show_take)
        media.device_changed.connect(self._show_sound)
        self._show_saving()

    def _lay_out(self) -> None:
        row = QHBoxLayout(self)
        row.setContentsMargins(GRID + 2, 3, GRID + 2, 3)
        row.setSpacing(3 * GRID)
        for name, label in self._labels.items():
            label.setProperty("quiet", name != "take")
            row.addWidget(label, 1 if name == "notice" else 0)
            if name == "saved":
                saving = QHBoxLayout()
                saving.setSpacing(GRID // 2)
                saving.addWidget(self.bar)
                saving.addWidget(self.stop)
                row.addLayout(saving)

    def __getitem__(self, name: str) -> QLabel:
        return self._labels[name]

    def show_take(self, *_: object) -> None:
        """Tell what is open."""
        take = self._session.take
        self["take"].setText(self._session.name)
        self["rate"].setText(f"{take.fps:g} fps")
        self["length"].setText(f"{len(take):,} frames · {timecode(take.duration_s, take.fps)}")
        self.show_place()
        self._show_saved()

    def show_place(self) -> None:
        """Tell where the playhead is."""
        frame, fps = self._session.playhead, self._session.take.fps
        self["place"].setText(f"frame {frame:,}" if self.in_frames else f"{timecode(frame / fps, fps)} · {frame}")

    def count_in_frames(self, on: bool) -> None:
        """Tell time in frames, or in timecode too."""
        self.in_frames = on
        self.show_place()

    def timed(self, spent_ms: float) -> None:
        """Tell how long it took from the mouse to the picture."""
        self._latencies_ms = [*self._latencies_ms[1 - LATENCIES :], spent_ms]
        self["speed"].setText(f"drag → preview {np.median(self._latencies_ms):.0f} ms")

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.PLAYHEAD):
            self.show_place()
        if change & (Change.TAKE | Change.CURVES | Change.SAVED):
            self._show_saved()

    def _show_saved(self) -> None:
        saving = self._keeper.saving
        saved = "saved" if self._keeper.path else ""
        told = "edits not saved yet" if self._session.edited else saved
        self["saved"].setText(f"saving {saving.name}…" if saving else told)

    def _show_saving(self) -> None:
        shown = self._keeper.saving is not None and not self._soon.isActive()
        self.bar.setVisible(shown)
        self.stop.setVisible(shown)
        self._show_saved()

    def _show_progress(self, share: float) -> None:
        self.bar.setValue(round(STEPS * share))

    def _show_sound(self) -> None:
        attached = self._session.audio is not None
        self["sound"].setText((f"♪ {self._media.device}" if self._media.device else "♪ silent") if attached else "")
        self["sound"].setToolTip(
            "The loudspeaker that plays" if self._media.device else "No loudspeaker was found; time runs by the clock."
        )
