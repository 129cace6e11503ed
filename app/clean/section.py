"""The Clean tool's settings: one strength, a live preview, and the lag it costs."""

from __future__ import annotations

import numpy as np
from PySide6.QtWidgets import QCheckBox, QPushButton, QSpinBox

from app.session import Change, Session
from app.session.edits import Editing
from app.widgets.section import Section, quiet, slider
from engine.editing import CleanRequest

FULL = 100


class CleanSection(Section):
    """Removes jitter from the selection, or the whole take, by as much as the slider says.

    Parameters
    ----------
    session : whose take is cleaned
    inference : carries it out
    """

    tools = frozenset({"clean"})

    def __init__(self, session: Session, inference: Editing) -> None:
        super().__init__(session, "Clean")
        self._inference = inference
        self.strength = QSpinBox(minimum=0, maximum=FULL, suffix=" %")
        self.strength.setValue(80)
        self._slider = slider(0, FULL)
        self._slider.setValue(80)
        self.row("Strength", self.strength)
        self.column.addWidget(self._slider)
        self.preview_button, self.keep_button, self.drop_button = (
            QPushButton("Preview"),
            QPushButton("Clean"),
            QPushButton("Discard"),
        )
        self.keep_button.setProperty("primary", True)
        self.side_by_side(self.preview_button, self.keep_button, self.drop_button)
        self.removed = QCheckBox("Show what is removed")
        self.removed.setToolTip("Draw it under each curve, on a scale of its own (Shift+R)")
        self.removed.setChecked(session.view.shows_removed)
        self.removed.toggled.connect(lambda on: session.view.show_removed(shown=on))
        self.column.addWidget(self.removed)
        self._facts = quiet("The selection, or the whole take where nothing is selected.")
        self.column.addWidget(self._facts)
        self._slider.valueChanged.connect(self.strength.setValue)
        self.strength.valueChanged.connect(self._slider.setValue)
        self.strength.valueChanged.connect(self._previewed)
        self.preview_button.clicked.connect(self.preview)
        self.keep_button.clicked.connect(self.keep)
        self.drop_button.clicked.connect(inference.cancel)
        session.changed.connect(self._on_change)

    def preview(self) -> None:
        """Show what cleaning does."""
        frames = self.session.view.selection or (0, len(self.session.document.take))
        self._inference.run(CleanRequest(frames, self.strength.value() / FULL))

    def keep(self) -> None:
        """Clean, as one undo step."""
        self.preview()
        strength = self.strength.value()
        self._inference.finish(f"clean at {strength} %", kind="clean")

    def _previewed(self, _: int) -> None:
        if self._inference.busy:
            self.preview()

    def _on_change(self, change: Change) -> None:
        if change & Change.TOOL:
            self.removed.setChecked(self.session.view.shows_removed)
        if change & Change.DRAFT and self.session.view.tool == "clean":
            draft = self.session.document.draft
            if draft is None or draft.lag_ms is None:
                self._facts.setText("The selection, or the whole take where nothing is selected.")
                return
            removed = np.abs(draft.weights - self.session.document.take.weights[draft.start : draft.stop])
            lag = draft.lag_ms
            lines = [f"takes off {removed.mean():.4f} on average, {removed.max():.2f} at most"]
            lines += [f"lag {lag:.0f} ms at full strength"] if np.isfinite(lag) else []
            self._facts.setText("\n".join(lines))
