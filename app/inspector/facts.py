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
from engine.controls import bundled_measurer
from engine.exact import shortfalls
from engine.take import Array
from engine.words import counted

LEGEND = "Curves: grey as recorded, dashed as asked."


class FactsSection(Section):
    """What is asked and reached, and why not more; how much differs from the original."""

    again = Signal()

    def __init__(self, session: Session) -> None:
        super().__init__(session, "This edit")
        self.told, self.facts = Label(), quiet("")
        self.told.setWordWrap(True)
        self.column.addWidget(self.told)
        self.column.addWidget(self.facts)
        self.again_button = QPushButton("Apply to the last edit")
        self.again_button.setToolTip(
            "Make the last edit again, with the settings of the brush as they are now.  (Ctrl+R)"
        )
        self.again_button.clicked.connect(self.again)
        self.column.addWidget(self.again_button)
        session.changed.connect(self._on_change)
        session.undo.indexChanged.connect(self._show)
        self._show()

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.CURVES | Change.DRAFT | Change.TOOL):
            self._show()
        elif change & Change.PLAYHEAD:
            self._tell()

    def _tell(self) -> None:
        """Say what came of the edit where the playhead is."""
        told = self._told_of(self._step())
        self.told.setText("\n".join(told))
        self.told.setVisible(bool(told))

    def _show(self, *_: int) -> None:
        session, step = self.session, self._step()
        modes = {"exact": session.exact, "follow": session.follow}
        made = {name: step.edit.inputs.get(name) for name in modes} if step is not None else modes
        self.again_button.setVisible(session.draft is None and made != modes)
        self._tell()
        self.facts.setText(self._counts())

    def _step(self) -> EditCommand | None:
        """Return the last edit, where it asked for a curve."""
        step = self.session.undo.command(self.session.undo.index() - 1)
        return step if isinstance(step, EditCommand) and step.asked is not None else None

    def _told_of(self, step: EditCommand | None) -> list[str]:
        session, draft = self.session, self.session.draft
        if draft is not None:
            rows = slice(draft.start, draft.stop)
            if draft.asked is draft.reached:
                return []  # nothing was asked of a control
            before = session.controls[rows], session.asked[rows]
            return _told(
                draft.weights, draft.asked, *before, exact=session.exact, frames=(draft.start, session.playhead)
            )
        if step is None or step.asked is None:
            return []
        start, asked = step.asked
        exact = bool(step.edit.inputs.get("exact"))
        return _told(step.edit.weights, asked, *step.before, exact=exact, frames=(start, session.playhead))

    def _counts(self) -> str:
        session, draft, frames = self.session, self.session.draft, len(self.session.take)
        if draft is not None:
            return f"moves {draft.stop - draft.start:,} of {counted(frames, 'frame')}"
        if not session.undo.index():
            return "Nothing changed yet. Drag a curve up or down."
        moved = int((session.take.weights != session.original.weights).any(axis=1).sum())
        if not moved:
            return "Every frame is as recorded."
        return f"{moved:,} of {counted(frames, 'frame')} changed, the rest is as recorded, bit for bit.\n{LEGEND}"


def _told(
    weights: Array, asked: Array, controls: Array, asked_before: Array, *, exact: bool, frames: tuple[int, int]
) -> list[str]:
    """Return a line for each control that an edit asked for: (n, 52) weights, (n, 8) mm asked and there before.

    `frames` are the first row's and the playhead's. It tells of the row at the playhead, whose face and values are on
    the screen; where nothing was asked there, of the row that was asked for most, and names its frame. What a row on
    the way there misses is no answer to what was asked.
    """
    changed, playhead = asked != controls, frames[1] - frames[0]
    lines = []
    for lane in np.flatnonzero(changed.any(axis=0)).tolist():
        here = 0 <= playhead < len(asked) and changed[playhead, lane]
        row = playhead if here else int(np.argmax(np.abs(asked[:, lane] - controls[:, lane])))
        wanted = np.where(changed[row], asked[row], asked_before[row])[None]
        found = shortfalls(weights[row : row + 1], wanted, bundled_measurer(), exact_curve=exact)
        short = next((str(each) for each in found if each.control == lane), "")
        reached = bundled_measurer().measure(weights[row : row + 1])[0, lane]
        met = f"{CURVES[lane].title} {reached:.1f} mm of {asked[row, lane]:.1f} asked"
        lines.append(f"{short or met}{'' if here else f' (frame {frames[0] + row:,})'}")
    return lines
