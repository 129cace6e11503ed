"""Where sound and reference video begin in the take."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QToolButton, QVBoxLayout, QWidget

from app.session import MAX_OFFSET_S, MEDIA, Change, Session
from app.session.sound import beyond_the_take
from app.widgets.section import Section, quiet
from app.widgets.text import Label, tip
from engine.project import name_of

WORDS = {"audio": "Sound", "video": "Video"}
NAME_CHARACTERS = 26
MS_PX, FRAMES_PX = 78, 74


class MediaSection(Section):
    """Names what is attached; its beginning is typed in milliseconds or frames; a button detaches it.

    Parameters
    ----------
    session : whose sound and video are shown
    """

    moved = Signal(str, float)  # kind, seconds into the take
    detached = Signal(str)  # kind

    def __init__(self, session: Session) -> None:
        super().__init__(session, "Sound and video")
        self.boxes = {kind: _Box(kind) for kind in MEDIA}
        for box in self.boxes.values():
            self.column.addWidget(box)
            box.milliseconds.valueChanged.connect(lambda ms, kind=box.kind: self.moved.emit(kind, ms / 1e3))
            box.frames.valueChanged.connect(self._typed_frames(box.kind))
            box.away.clicked.connect(lambda _=False, kind=box.kind: self.detached.emit(kind))
        session.changed.connect(self._on_change)
        self._on_change(Change.TAKE)

    def _typed_frames(self, kind: str):  # type: ignore[no-untyped-def]
        return lambda frames: self.moved.emit(kind, frames / self.session.document.take.fps)

    def _on_change(self, change: Change) -> None:
        if not change & (Change.TAKE | Change.MEDIA | Change.MARKS):
            return
        for kind, box in self.boxes.items():
            record = self.session.document.marks.medium(kind)
            box.setVisible(record is not None)
            if record is not None:
                box.show_medium(name_of(record), self.session.document.offset_s(kind), self.session.document.take.fps)
                box.show_remark(beyond_the_take(self.session) if kind == "audio" else "")
        self.needed = bool(self.session.document.marks.media)
        self.setVisible(self.needed)


class _Box(QWidget):
    """One file: its name, when it begins, and the button that detaches it."""

    def __init__(self, kind: str) -> None:
        super().__init__()
        self.kind = kind
        word = WORDS[kind]
        self.name = Label()
        self.remark = quiet("")
        self.away = QToolButton()
        self.away.setText("✕")
        self.away.setToolTip(f"Detach the {word.lower()}")
        self.away.setAccessibleName(f"Detach the {word.lower()}")
        self.milliseconds, self.frames = QDoubleSpinBox(decimals=0), QDoubleSpinBox(decimals=2)
        keys = "Alt+Shift+←/→" if kind == "video" else "Alt+←/→, or drag the waveform,"
        for box, suffix, step, width in ((self.milliseconds, " ms", 10.0, MS_PX), (self.frames, " fr", 1.0, FRAMES_PX)):
            box.setFixedWidth(width)
            box.setSuffix(suffix)
            box.setSingleStep(step)
            box.setKeyboardTracking(False)
            box.setToolTip(f"When in the take the {word.lower()} begins; {keys} nudges it by a frame.")
            box.setAccessibleName(f"{word} begins at,{suffix}")
        self.milliseconds.setRange(-1e3 * MAX_OFFSET_S, 1e3 * MAX_OFFSET_S)
        top, bottom = QHBoxLayout(), QHBoxLayout()
        top.addWidget(self.name, 1)
        top.addWidget(self.away)
        words = quiet("begins at")
        words.setWordWrap(False)
        bottom.addWidget(words, 1)
        bottom.addWidget(self.milliseconds)
        bottom.addWidget(self.frames)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(2)
        column.addLayout(top)
        column.addLayout(bottom)
        column.addWidget(self.remark)

    def show_remark(self, text: str) -> None:
        """Show a remark about the file, or none."""
        self.remark.setText(text)
        self.remark.setVisible(bool(text))

    def show_medium(self, name: str, offset_s: float, fps: float) -> None:
        """Show a file's name, and when it begins."""
        self.name.setText(name if len(name) <= NAME_CHARACTERS else f"{name[: NAME_CHARACTERS - 9]}…{name[-8:]}")
        self.name.setToolTip(tip(name))
        with QSignalBlocker(self.milliseconds), QSignalBlocker(self.frames):
            self.milliseconds.setValue(1e3 * offset_s)
            self.frames.setRange(-MAX_OFFSET_S * fps, MAX_OFFSET_S * fps)
            self.frames.setValue(offset_s * fps)
