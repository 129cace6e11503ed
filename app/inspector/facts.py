"""What the edit came to, in plain numbers."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QLabel, QPushButton

from app.session import Change, Session
from app.session.commands import EditCommand
from app.session.curve_table import CURVES
from app.widgets.section import Section, quiet
from engine.extended import bundled_face
from engine.take import Array

LEGEND = "Curves: grey as recorded, dashed as asked."


class FactsSection(Section):
    """What is asked and reached, and why not more; how much differs from the original."""

    again = Signal()
    reach = Signal()

    def __init__(self, session: Session) -> None:
        super().__init__(session, "This edit")
        self.told, self.facts = QLabel(wordWrap=True), quiet("")
        self.column.addWidget(self.told)
        self.column.addWidget(self.facts)
        self.again_button = QPushButton("Apply to the last edit")
        self.again_button.setToolTip(
            "Make the last edit again, with the settings of the brush as they are now.  (Ctrl+R)"
        )
        self.again_button.clicked.connect(self.again)
        self.column.addWidget(self.again_button)
        self.reach_button = QPushButton("Reach it all the same")
        self.reach_button.setToolTip(
            "Make the last edit again with a believability of 0: it goes where it was dragged."
        )
        self.reach_button.clicked.connect(self.reach)
        self.column.addWidget(self.reach_button)
        session.changed.connect(self._on_change)
        session.undo.indexChanged.connect(self._show)
        self._show()

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.CURVES | Change.DRAFT | Change.TOOL):
            self._show()

    def _show(self, *_: int) -> None:
        session, step = self.session, self._step()
        made = step.edit.inputs["believability"] if step is not None else session.believability
        self.again_button.setVisible(session.draft is None and made != session.believability)
        told, held_back = self._told_of(step)
        self.told.setText("\n".join(told))
        self.told.setVisible(bool(told))
        self.reach_button.setVisible(session.draft is None and held_back)
        self.facts.setText(self._counts())

    def _step(self) -> EditCommand | None:
        """Return the last edit, where it asked for a curve."""
        step = self.session.undo.command(self.session.undo.index() - 1)
        return step if isinstance(step, EditCommand) and step.asked is not None else None

    def _told_of(self, step: EditCommand | None) -> tuple[list[str], bool]:
        """Return what to say of the edit on screen, and whether believability alone keeps it from what was asked."""
        draft = self.session.draft
        if draft is not None:
            return _told(draft.start, draft.weights, draft.asked, draft.granted, self.session.believability)
        if step is None or step.asked is None:
            return [], False
        start, asked = step.asked
        now = self.session.take.weights[start : start + len(asked)]
        return _told(start, now, asked, step.granted, step.edit.inputs["believability"])

    def _counts(self) -> str:
        session, draft, frames = self.session, self.session.draft, len(self.session.take)
        if draft is not None:
            return f"moves {draft.stop - draft.start:,} of {frames:,} frames"
        if not session.undo.index():
            return "Nothing changed yet. Drag a curve up or down."
        moved = int((session.take.weights != session.original.weights).any(axis=1).sum())
        if not moved:
            return "Every frame is as recorded."
        return f"{moved:,} of {frames:,} frames changed, the rest is as recorded, bit for bit.\n{LEGEND}"


def _told(
    start: int, weights: Array, asked: Array, granted: Array | None, believability: float
) -> tuple[list[str], bool]:
    """Return a line for each control that an edit asked for, and whether believability alone holds one of them back.

    Weights, (n, 52), and asked values, (n, 16) with NaN, are from frame `start`.
    """
    # here and not above: torch takes a second to load, and the window should be seen first
    from engine.shortfall import shortfalls

    wanted = ~np.isnan(asked)
    if not wanted.any():
        return [], False
    reached = bundled_face().measure(weights)
    found = shortfalls(weights, asked, believability=believability, granted=granted)
    short = {one.control: one for one in found}
    lines = []
    for lane in np.flatnonzero(wanted.any(axis=0)).tolist():
        rows = np.flatnonzero(wanted[:, lane])
        middle = rows[len(rows) // 2]
        met = f"{CURVES[lane].title} {reached[middle, lane]:.1f} {CURVES[lane].unit}, as asked"
        lines.append(f"{short[lane]} (frame {start + short[lane].row})" if lane in short else met)
    return lines, any(one.believed for one in found)
