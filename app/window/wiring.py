"""Connects the parts of the window: tables of signals and of the methods that they call.

Methods, and no lambdas: a connection keeps what a lambda holds for as long as its sender lives, and the window, which
owns the senders, would never be freed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from app.window.main_window import MainWindow

Rows = tuple[tuple[Any, Callable[..., object]], ...]  # a bound signal, and what it calls


def connect(window: MainWindow) -> None:
    """Connect the parts of a window."""
    for rows in (_notices, _opening, _media, _editing, _time, _retarget, _review, _live):
        for signal, call in rows(window):
            signal.connect(call)
    for clock in (window.timeline, window.status):
        window.preferences.counted.connect(clock.count_in_frames)
    window.edits.cutoff_hz = window.smoothing.cutoff.value
    window.edits.cancel_move = window.timeline.visemes.drop
    window.edits.hide_notice = window.notices.hide_shown
    window.edits.stop_else = window.retarget.retargeting.cancel
    window.time.looping = window.actions_by_name["loop"].isChecked
    for signed in (window.notes, window.flags, window.review.verdict):
        signed.author = window.author
    window.notes.drawn = window.preview.drawn
    window.review.open_take, window.review.load = window.files.opener.open_take, window.files.load


def _notices(window: MainWindow) -> Rows:
    """Connect errors to the notices, and messages to the status bar."""
    panels = (window.preview, window.media, window.reference, window.live, window.retarget, window.review, window.flags)
    parts = (*panels, window.inference, window.filling, window.visemes, window.timeline.visemes, window.marks)
    speakers = (window.edits, window.time, window.timeline, window.marks, window.review)
    return (
        *((part.failed, window.notices.warn) for part in parts),
        *((speaker.message, window.status.show_message) for speaker in speakers),
        (window.keeper.failed, window.notices.warn_until_solved),
        (window.keeper.mended, window.notices.withdraw),
        (window.files.message, window.notices.warn),
        (window.files.wrote, window.notices.inform),
        (window.spans.refused, window.notices.warn),
        (window.importing.refused, window.notices.warn),
        (window.preview.timed, window.status.timed),
        (window.inference.ready, window.status.engine_ready),
    )


def _opening(window: MainWindow) -> Rows:
    return (
        (window.files.opened, window.show_opened),
        (window.keeper.saved, window.show_saved),
        (window.keeper.kept, window.live.recording.settle),
        (window.importing.chosen, window.curves.setFocus),
        (window.importing.hide_button.clicked, window.show_importing),
        (window.preferences.themed, window.apply_theme),
    )


def _media(window: MainWindow) -> Rows:
    return (
        (window.media.missing_changed, window.show_missing),
        (window.missing.locate, window.sound.locate),
        (window.missing.accept, window.sound.use_found),
        (window.missing.detach, window.media.detach),
        (window.attached.detached, window.media.detach),
        (window.reference.detached, window.sound.detach_video),
        (window.attached.moved, window.media.move),
        (window.timeline.slid, window.media.settle),
        (window.files.cues_dropped, window.visemes.attach),
        (window.timeline.visemes.wanted, window.do),
    )


def _editing(window: MainWindow) -> Rows:
    return (
        (window.session.document.undo.indexChanged, window.show_undo),
        (window.value.close_here, window.edits.close_here),
        (window.value.typed, window.edits.set_value),
        (window.facts.again, window.edits.again),
        (window.facts.reach, window.edits.go_there),
        (window.smoothing.moved, window.edits.preview_smoothing),
        (window.smoothing.kept, window.edits.smooth),
        (window.smoothing.dropped, window.inference.cancel),
        (window.filling.changed, window.show_filling),
        (window.timeline.marked, window.spans.mark),
        (window.spans.strip.wanted, window.preview.draw_strip),
        (window.preview.strip_drawn, window.spans.strip.show_picture),
    )


def _time(window: MainWindow) -> Rows:
    return ((window.transport.changed, window.show_transport),)


def _retarget(window: MainWindow) -> Rows:
    retargeting = window.retarget.retargeting
    return (
        (window.retarget.shown, window.preview.show_sides),
        (retargeting.choosing.capture_opened, window.files.open_recording),
        (window.preview.picked, window.retarget.pick),
        (window.preview.dot_clicked, window.retarget.placing.choose),
        (window.files.capture_dropped, window.retarget.take_in),
        (window.files.character_chosen, retargeting.choosing.show_on),
        (retargeting.choosing.message, window.status.show_lasting),
    )


def _review(window: MainWindow) -> Rows:
    return (
        (window.notes.drawing_wanted, window.preview.draw_on),
        (window.notes.drawing_wanted, window.actions_by_name["draw_mark"].setChecked),
        (window.notes.looked_at, window.preview.look_at),
        (window.review.looped, window.actions_by_name["loop_change"].setChecked),
    )


def _live(window: MainWindow) -> Rows:
    return (
        (window.live.face, window.preview.show_live),
        (window.preview.live_timed, window.live.on_screen),
        (window.live.recorded, window.files.open_recording),
    )
