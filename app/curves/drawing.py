"""What the lanes show of a session: each function brings all of them up to date with one kind of change."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from app.curves.lane import Lane
from app.curves.peaks import on_screen
from app.session import Session
from app.session.document import Document
from engine.take import Array


def take_curves(lanes: Sequence[Lane], session: Session) -> None:
    """Give each lane its curves, and choose the range of values that they need."""
    for lane in lanes:
        lane.take_curves(
            session.document.original_curve(lane.key),
            session.document.curve(lane.key),
            session.document.asked_curve(lane.key),
            touched=session.document.touched,
        )
        lane.fit()


def show_frames(lanes: Sequence[Lane], session: Session) -> None:
    """Show the frames of the view."""
    visible = on_screen(len(session.document.take), session.view.range)
    for lane in lanes:
        lane.show_frames(*session.view.range)
        lane.draw_original(visible)


def draw_edits(lanes: Sequence[Lane], session: Session) -> None:
    """Draw what was asked and what the face does, with the draft over it."""
    visible, draft = on_screen(len(session.document.take), session.view.range), session.document.draft
    for lane in lanes:
        drafted = session.document.draft_curve(lane.key)
        if draft is None or drafted is None:
            lane.draw_edit(visible)
        else:
            asked = None if lane.curve.is_weight else (draft.asked[:, lane.curve.column], draft.start)
            lane.draw_edit(visible, (drafted, draft.start), asked)


def draw_removed(lanes: Sequence[Lane], session: Session) -> None:
    """Draw what cleaning takes off, while it is chosen and wanted."""
    visible, draft = on_screen(len(session.document.take), session.view.range), session.document.draft
    wanted = session.view.tool == "clean" and session.view.shows_removed
    for lane in lanes:
        drafted = session.document.draft_curve(lane.key) if wanted else None
        if draft is None or drafted is None:
            lane.hide_removed()
            continue
        rows = slice(draft.start, draft.stop)
        taken_off = session.document.curve(lane.key)[rows] - drafted
        lane.draw_removed(taken_off, draft.start, kept=~session.document.take.lost[rows], visible=visible)


def draw_differences(lanes: Sequence[Lane], session: Session) -> None:
    """Draw how much each curve differs from the take before, during a review."""
    document, view = session.document, session.view
    if not _reviewed(session):
        return
    visible = on_screen(len(document.take), view.range)
    for lane in lanes:
        lane.difference((document.take, document.original), partial(_difference, document, lane.key))
        lane.draw_difference(visible, view.playhead)


def tell_differences(lanes: Sequence[Lane], session: Session) -> None:
    """Show how much each curve differs at the playhead, during a review."""
    if _reviewed(session):
        for lane in lanes:
            lane.tell_difference(session.view.playhead)


def _reviewed(session: Session) -> bool:
    return session.document.differences is not None and session.view.tool == "review"


def _difference(document: Document, lane: int) -> Array:
    return np.asarray(document.curve(lane) - document.original_curve(lane))
