"""What the edit came to, in plain numbers."""

from __future__ import annotations

import numpy as np

from app.curve_table import CURVES, FIRST_WEIGHT
from app.section import Section, quiet
from app.session import Change, Session


class FactsSection(Section):
    """Asked and reached while an edit is under way; how much differs from the original after it."""

    def __init__(self, session: Session) -> None:
        super().__init__(session, "This edit")
        self._facts = quiet("")
        self.column.addWidget(self._facts)
        session.changed.connect(self._on_change)
        self._facts.setText(self._describe())

    def _on_change(self, change: Change) -> None:
        if change & (Change.TAKE | Change.CURVES | Change.DRAFT):
            self._facts.setText(self._describe())

    def _describe(self) -> str:
        session = self.session
        frames = len(session.take)
        if session.draft is not None:
            return "\n".join(
                [*self._asked(), f"moves {session.draft.stop - session.draft.start:,} of {frames:,} frames"]
            )
        if not session.undo.index():
            return "Nothing changed yet. Drag a curve up or down."
        moved = int((session.take.weights != session.original.weights).any(axis=1).sum())
        return f"{moved:,} of {frames:,} frames differ from the original\n{frames - moved:,} frames bit-identical"

    def _asked(self) -> list[str]:
        draft = self.session.draft
        assert draft is not None
        controls = self.session.controls[draft.start : draft.stop]
        lines = []
        for lane in np.flatnonzero((draft.asked != controls).any(axis=0)[:FIRST_WEIGHT]):
            row = int(np.argmax(np.abs(draft.asked[:, lane] - controls[:, lane])))
            asked, reached = draft.asked[row, lane], draft.reached[row, lane]
            if draft.asked is not draft.reached:
                lines.append(f"{CURVES[lane].title}: asked {asked:.1f}, reached {reached:.1f} mm")
        return lines
