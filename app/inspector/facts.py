"""What the edit came to, in plain numbers."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QPushButton

from app.session import Change, Session
from app.session.commands import EditCommand
from app.session.curve_table import CURVES
from app.widgets.section import Section, quiet
from app.widgets.text import Label
from engine.extended import bundled_face
from engine.take import Array
from engine.words import counted

LEGEND = "Curves: grey as recorded, dashed as asked."


class FactsSection(Section):
    """What is asked and reached, and why not more; how much differs from the original."""

    away = frozenset({"review"})
    again = Signal()
    reach = Signal()

    def __init__(self, session: Session) -> None:
        super().__init__(session, "This edit")
        self.outcome, self.facts = Label(), quiet("")
        self.outcome.setWordWrap(True)
        self.column.addWidget(self.outcome)
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
        session.document.undo.indexChanged.connect(self._show)
        self._show()

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.CURVES | Change.DRAFT | Change.TOOL):
            self._show()
        elif change & Change.PLAYHEAD:
            self._show_outcome()

    def _show_outcome(self) -> None:
        """Say what came of the edit where the playhead is."""
        lines, held_back = self._outcome_of(self._step())
        self.outcome.setText("\n".join(lines))
        self.outcome.setVisible(bool(lines))
        self.reach_button.setVisible(self.session.document.draft is None and held_back)

    def _show(self, *_: int) -> None:
        session, step = self.session, self._step()
        used = step.edit.inputs["believability"] if step is not None else session.view.believability
        self.again_button.setVisible(session.document.draft is None and used != session.view.believability)
        self._show_outcome()
        self.facts.setText(self._counts())

    def _step(self) -> EditCommand | None:
        """Return the last edit, where it asked for a curve."""
        step = self.session.document.undo.command(self.session.document.undo.index() - 1)
        return step if isinstance(step, EditCommand) and step.asked is not None else None

    def _outcome_of(self, step: EditCommand | None) -> tuple[list[str], bool]:
        """Return what to say of the edit on screen, and whether believability alone keeps it from what was asked."""
        session, draft = self.session, self.session.document.draft
        if draft is not None:
            was = session.document.controls[draft.start : draft.start + len(draft.asked)]
            edit = draft.start, draft.weights, draft.asked, draft.granted, was
            return _outcome(*edit, believability=session.view.believability, playhead=session.view.playhead)
        if step is None or step.asked is None:
            return [], False
        start, asked = step.asked
        now = session.document.take.weights[start : start + len(asked)]
        believability = step.edit.inputs["believability"]
        return _outcome(
            start, now, asked, step.granted, step.before[0], believability=believability, playhead=session.view.playhead
        )

    def _counts(self) -> str:
        session, draft, frames = self.session, self.session.document.draft, len(self.session.document.take)
        if draft is not None:
            return f"moves {draft.stop - draft.start:,} of {counted(frames, 'frame')}"
        if not session.document.undo.index():
            return "Nothing changed yet. Drag a curve up or down."
        moved = int((session.document.take.weights != session.document.original.weights).any(axis=1).sum())
        if not moved:
            return "Every frame is as recorded."
        return f"{moved:,} of {counted(frames, 'frame')} changed, the rest is as recorded, bit for bit.\n{LEGEND}"


def _outcome(
    start: int, weights: Array, asked: Array, granted: Array | None, was: Array, *, believability: float, playhead: int
) -> tuple[list[str], bool]:
    """Return a line for each control that an edit asked for, and whether believability alone holds one of them back.

    Weights, (n, 52), asked values, (n, 16) with NaN, and what the controls were, (n, 16), are from frame `start`. A
    line tells of the row at the playhead, whose face and values are on the screen; where nothing was asked there, of
    the row that misses most, or, where all is met, that was pulled furthest, and names its frame.
    """
    # here and not above: torch takes a second to load, and the window should be seen first
    from engine.shortfall import SHORT, shortfalls

    wanted = ~np.isnan(asked)
    if not wanted.any():
        return [], False
    reached = bundled_face().measure(weights)
    missing = np.nan_to_num(np.abs(asked - reached))
    lines = []
    for lane in np.flatnonzero(wanted.any(axis=0)).tolist():
        here = 0 <= playhead - start < len(asked) and wanted[playhead - start, lane]
        rows = np.flatnonzero(wanted[:, lane])
        misses, pulled = missing[rows, lane], np.abs(asked[rows, lane] - was[rows, lane])
        row = playhead - start if here else int(rows[np.argmax(misses if misses.max() > SHORT else pulled)])
        single = slice(row, row + 1)
        found = shortfalls(
            weights[single],
            asked[single],
            believability=believability,
            granted=None if granted is None else granted[single],
        )
        short = next((str(each) for each in found if each.control == lane), "")
        met = f"{CURVES[lane].title} {reached[row, lane]:.1f} {CURVES[lane].unit}, as asked"
        lines.append(f"{short or met}{'' if here else f' (frame {start + row:,})'}")
    every = shortfalls(weights, asked, believability=believability, granted=granted)
    return lines, any(each.believed for each in every)
