from __future__ import annotations

import pytest
from pytestqt.qtbot import QtBot

from app.curves.tools.mark import MarkTool, ScrubTool
from engine.project import Span
from tests.app.curves.tools.panels import Panel, event


@pytest.fixture
def tool(qtbot: QtBot) -> MarkTool:
    return MarkTool(Panel())  # type: ignore[arg-type]


def spans(tool: MarkTool) -> tuple[Span, ...]:
    return tool.panel.session.document.marks.spans


def dragged(tool: MarkTool, begin: int, end: int) -> None:
    tool.press(0, event(10 * begin))
    tool.move(0, event(10 * end))
    tool.release(event(10 * end))


@pytest.mark.parametrize(("begin", "end"), [(20, 29), (29, 20)])
def test_frames_that_are_dragged_over_become_a_span_by_one_step(tool: MarkTool, begin: int, end: int) -> None:
    tool.press(0, event(10 * begin))
    assert tool.busy
    tool.move(None, event(10 * end))
    assert tool.panel.session.view.selection == (20, 30)
    assert tool.panel.readouts[-1] == "10 frames" and not spans(tool)  # type: ignore[attr-defined]
    tool.release(event(10 * end))
    assert not tool.busy and spans(tool) == (Span(20, 30),)
    undo = tool.panel.session.document.undo
    assert undo.count() == 1 and undo.undoText() == "mark a span"
    undo.undo()
    assert spans(tool) == ()


def test_spans_are_kept_by_their_first_frame_and_none_twice(tool: MarkTool) -> None:
    for begin, end in ((40, 44), (10, 19), (40, 44), (10, 12)):
        dragged(tool, begin, end)
    assert sorted(spans(tool), key=lambda span: span.start) == list(spans(tool))
    assert set(spans(tool)) == {Span(40, 45), Span(10, 20), Span(10, 13)}
    assert tool.panel.session.document.undo.count() == 3


def test_a_click_moves_the_playhead_and_marks_nothing(tool: MarkTool) -> None:
    tool.press(0, event(203))
    tool.release(event(197))
    assert tool.panel.session.view.playhead == 20 and spans(tool) == ()
    tool.panel.session.view.select((3, 9))
    dragged(tool, 30, 30)
    assert spans(tool) == () and tool.panel.session.view.playhead == 30


def test_what_is_dropped_marks_nothing(tool: MarkTool) -> None:
    tool.press(0, event(100))
    tool.move(0, event(200))
    tool.cancel()
    tool.release(event(200))
    assert not tool.busy and spans(tool) == () and tool.panel.session.view.selection is None


def test_hovering_says_what_to_do(tool: MarkTool) -> None:
    tool.move(0, event(100))
    tool.move(None, event(100))
    assert tool.panel.readouts == ["drag over frames to mark them", ""]  # type: ignore[attr-defined]


def test_a_playhead_follows_the_pointer_while_it_is_held(tool: MarkTool) -> None:
    scrub, view = ScrubTool(tool.panel), tool.panel.session.view
    scrub.move(0, event(100))
    assert view.playhead == 0 and not scrub.busy
    scrub.press(0, event(204))
    assert view.playhead == 20 and scrub.busy
    scrub.move(None, event(306))
    assert view.playhead == 31
    for end in (scrub.release, lambda _: scrub.cancel()):
        scrub.press(0, event(204))
        end(event(204))
        scrub.move(0, event(100))
        assert view.playhead == 20 and not scrub.busy
