"""The Pin tool's settings: the pose at the playhead by weights, and how far it spreads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QLineEdit, QPushButton, QSlider

from app.session import Change, Session
from app.session.edits import Editing
from app.widgets.section import CountBox, Section, quiet
from app.widgets.weight_sliders import WeightSliders
from engine.editing import PinRequest
from engine.project import Pin

SPREAD_S = 0.5


class PinsSection(Section):
    """Sliders for the pose at the playhead; while one moves, the change spreads over the range.

    Parameters
    ----------
    session : whose take is pinned
    inference : carries the solving out
    """

    tools = frozenset({"pin"})

    def __init__(self, session: Session, inference: Editing) -> None:
        super().__init__(session, "Pin")
        self._inference = inference
        self._frame = 0
        self._pose: dict[str, float] = {}  # the weights that were moved
        self.hint = quiet("Move a slider: the pose is met at the playhead and eases out over the range.")
        self.column.addWidget(self.hint)
        self.before, self.after = (CountBox("frame", lowest=0, highest=5000) for _ in range(2))
        for box in (self.before, self.after):
            box.valueChanged.connect(self._spread)
        self.row("Ease in", self.before)
        self.row("Ease out", self.after)
        self._weights = WeightSliders()
        self._weights.moved.connect(self._move)
        self._weights.searched.connect(self._show_sliders)
        self.keep_button, self.drop_button = QPushButton("Pin"), QPushButton("Discard")
        self.keep_button.setProperty("primary", True)
        self.keep_button.setToolTip("Keep the pose and the pin")
        self.side_by_side(
            self.keep_button, self.drop_button
        )  # above the sliders: beneath them a low screen has no room
        self.column.addWidget(self._weights)
        self.keep_button.clicked.connect(self.keep)
        self.drop_button.clicked.connect(self.drop)
        session.changed.connect(self._on_change)
        self._reset_range()
        self._show_sliders()

    @property
    def search(self) -> QLineEdit:
        """What is typed narrows the list of sliders."""
        return self._weights.search

    @property
    def sliders(self) -> dict[str, QSlider]:
        """The sliders on screen, by shape name."""
        return self._weights.sliders

    @property
    def range(self) -> tuple[int, int]:
        """The half-open range that the pin spreads over."""
        return max(0, self._frame - self.before.value()), min(
            len(self.session.document.take), self._frame + self.after.value() + 1
        )

    def keep(self) -> None:
        """Keep the pose as one undo step, and the pin with it."""
        if not self._pose or not self._inference.busy:
            return
        session, (start, stop) = self.session, self.range
        pin = Pin(self._frame, dict(self._pose), start, stop)
        names = ", ".join(list(self._pose)[:2])
        others = tuple(other for other in session.document.marks.pins if other.frame != pin.frame)
        pins = tuple(sorted((*others, pin), key=lambda each: each.frame))
        inputs = {"frame": self._frame, "weights": dict(self._pose), "range": [start, stop]}
        self._pose = {}
        self._inference.finish(
            f"pin {names}", kind="pin", inputs=inputs, marks=replace(session.document.marks, pins=pins)
        )

    def drop(self) -> None:
        """Discard the pose."""
        self._pose = {}
        self._inference.cancel()
        self._show_sliders()

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            self._reset_range()
        if change & (Change.TAKE | Change.PLAYHEAD | Change.CURVES | Change.TOOL) and self.session.view.tool == "pin":
            if change & (Change.PLAYHEAD | Change.TAKE) and self._pose:
                self.drop()
            self._frame = self.session.view.playhead
            self._show_sliders()

    def _reset_range(self) -> None:
        reach = round(SPREAD_S * self.session.document.take.fps)
        for box in (self.before, self.after):
            with QSignalBlocker(box):
                box.setValue(reach)

    def _show_sliders(self) -> None:
        """Show the shapes that match the search, or else those most active around the playhead."""
        self._frame = self.session.view.playhead
        face, (start, stop) = self.session.document.take.weights[self._frame], self.range
        activity = np.ptp(self.session.document.take.weights[start:stop], axis=0) + face
        self._weights.show_face(face, activity, self._pose)

    def _move(self, name: str, value: float) -> None:
        self._pose[name] = value
        self._spread()

    def _spread(self, *_: int) -> None:
        if not self._pose:
            return
        self._inference.run(PinRequest({self._frame: dict(self._pose)}, self.range))
