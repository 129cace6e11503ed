"""Listening to a phone: raw or clean on the preview, how it is doing, and recording it to a take."""

from __future__ import annotations

import sys
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QTimer, Signal
from PySide6.QtWidgets import QComboBox, QPushButton, QSpinBox

from app.live.recording import Recording
from app.session import Change, Session
from app.widgets.section import Section, quiet, slider
from engine.errors import EngineError
from engine.words import NAME_LENGTH, counted, plain

if TYPE_CHECKING:
    from engine.live.listen import Listener

STATUS_MS = 400
SWITCH_S = 1e-4  # for which a thread may keep another waiting; Python's own 5 ms would be felt in each packet
SHOWN = 300  # pictures whose delay the meter tells
# Heard from other machines only when asked for: a face is personal, and a socket is a door.
PLACES = {"this computer only": "127.0.0.1", "my network (a phone)": "0.0.0.0"}


class LiveSection(Section):
    """Listens, shows and records.

    Parameters
    ----------
    session : the take beside which one listens; it is not touched until a recording is opened
    folder : where a recording grows while it is made, so that a crash does not lose it
    """

    tools = frozenset({"live"})
    face = Signal(object, float)  # (52,) weights to show and when they arrived, or None to go back to the take
    recorded = Signal(object)  # a Take
    failed = Signal(str, str)
    _cleaned = Signal()  # from the listener's thread

    def __init__(self, session: Session, folder: Path) -> None:
        super().__init__(session, "Live")
        self.recording = Recording(folder)
        self.recording.recorded.connect(self.recorded)
        self.recording.failed.connect(self.failed)
        session.changed.connect(self._on_change)
        self._listener: Listener | None = None
        self._shown_ms: deque[float] = deque(maxlen=SHOWN)
        self._timer = QTimer(self, interval=STATUS_MS)
        self._timer.timeout.connect(self._show_status)
        self._cleaned.connect(self._show_face)
        self._switch_s = sys.getswitchinterval()
        self.place, self.port = QComboBox(), QSpinBox()
        self.place.addItems(list(PLACES))
        self.place.setAccessibleName("Listen to")
        self.port.setRange(1024, 65535)
        self.port.setValue(11111)
        self.column.addWidget(self.place)
        self.row("Port", self.port)
        self.subjects = QComboBox()
        self.subjects.setAccessibleName("Subject")
        self.subjects.setPlaceholderText("nobody is sending yet")
        self.subjects.activated.connect(self._choose_subject)
        self.column.addWidget(self.subjects)
        self.strength = slider(0, 100)
        self.strength.setValue(100)
        self.strength.valueChanged.connect(self._set_strength)
        self.column.addWidget(quiet("Left as it comes, right cleaned"))
        self.column.addWidget(self.strength)
        self.listen_button, self.record_button = QPushButton("Listen"), QPushButton("Record")
        self.listen_button.setProperty("primary", True)
        self.side_by_side(self.listen_button, self.record_button)
        self.listen_button.clicked.connect(self.toggle)
        self.record_button.clicked.connect(self.toggle_recording)
        self.status = quiet("Live Link Face: set this computer's address and the port as target.")
        self.column.addWidget(self.status)
        self._show_buttons()

    @property
    def listening(self) -> bool:
        """Whether a socket is open."""
        return self._listener is not None

    def toggle(self) -> None:
        """Begin to listen, or stop."""
        if self._listener is not None:
            self.stop()
            return
        from engine.live.listen import Listener
        from engine.live.stream import Stream

        try:
            stream = Stream(strength=self.strength.value() / 100)
            self._listener = Listener(
                stream,
                bind=PLACES[self.place.currentText()],
                port=self.port.value(),
                on_frames=self._cleaned.emit,
            )
        except EngineError as error:
            self.failed.emit(error.sentence, error.advice)
            return
        self.subjects.clear()
        self._shown_ms.clear()
        self._timer.start()
        sys.setswitchinterval(SWITCH_S)
        self._show_buttons()

    def stop(self) -> None:
        """Stop listening; a recording under way is opened."""
        if self.recording.running:
            self.toggle_recording()
        self._timer.stop()
        if self._listener is not None:
            self._listener.close()
            self._listener = None
            sys.setswitchinterval(self._switch_s)
            self.face.emit(None, 0.0)
        self._show_buttons()

    def shut_down(self) -> None:
        """Stop for good; a recording under way stays on disk and is offered at the next start."""
        self.recording.shut_down()
        self.stop()

    def toggle_recording(self) -> None:
        """Begin to record, or end and open what was recorded."""
        if self._listener is None:
            return
        if self.recording.running:
            self._listener.stream.on_arrival = None
            self.recording.end()
        else:
            self._listener.stream.on_arrival = self.recording.begin().add
        self._show_buttons()

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            self.recording.opened(self.session.document.take)

    def on_screen(self, spent_ms: float) -> None:
        """Take note of how long a packet took until its picture was shown."""
        self._shown_ms.append(spent_ms)

    def _show_face(self) -> None:
        frames = self._listener.frames() if self._listener is not None else []
        if frames:
            self.face.emit(np.asarray(frames[-1].clean, np.float64), frames[-1].arrived_s)

    def _show_status(self) -> None:
        if self._listener is None:
            return
        self.recording.save()
        status = self._listener.status()
        if [self.subjects.itemText(index) for index in range(self.subjects.count())] != list(status.subjects):
            self.subjects.clear()
            for name in status.subjects:
                self.subjects.addItem(plain(name, longest=NAME_LENGTH), name)
        followed = self.subjects.findData(self._listener.stream.subject or "")
        if followed >= 0 and not self.subjects.view().isVisible():
            self.subjects.setCurrentIndex(followed)
        lines = [counted(status.frames, "frame")]
        if np.isfinite(status.latency_p95_ms):
            lines.append(f"clean {status.latency_p95_ms:.1f} ms after arrival")
        if self._shown_ms:
            lines.append(f"on screen {np.percentile(self._shown_ms, 95):.0f} ms after arrival")
        lines += [f"{count:,} {reason}" for reason, count in status.drops.items() if count]
        if self.recording.running:
            lines.append(f"recording: {counted(self.recording.frames, 'frame')}")
        self.status.setText("\n".join(lines))

    def _show_buttons(self) -> None:
        self.listen_button.setText("Stop" if self.listening else "Listen")
        self.record_button.setText("End and open" if self.recording.running else "Record")
        self.record_button.setEnabled(self.listening)
        for widget in (self.place, self.port):
            widget.setEnabled(not self.listening)

    def _choose_subject(self, _: int) -> None:
        if self._listener is not None:
            self._listener.stream.choose(self.subjects.currentData())

    def _set_strength(self, percent: int) -> None:
        if self._listener is not None:
            self._listener.stream.strength = percent / 100
