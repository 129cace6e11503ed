from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QPointF
from pytestqt.qtbot import QtBot

from app.curves.tools.base import Stroke, Tool
from app.session.curve_table import CURVES, FIRST_WEIGHT
from engine.controls import ALL_INDEX
from engine.take import SHAPES
from tests.app.curves.tools.panels import Panel, event


@pytest.fixture
def panel(qtbot: QtBot) -> Panel:
    return Panel()


def test_a_control_is_asked_of_the_networks_beside_the_other_controls_as_they_are(panel: Panel) -> None:
    lane = ALL_INDEX["lips_vertical"]
    Tool(panel).ask(lane, 10, np.array([-3.0, 4.0]))  # type: ignore[arg-type]
    ((start, asked),) = panel.inference.asked
    own = panel.session.document.controls
    assert start == 10
    np.testing.assert_array_equal(asked[:, lane], [0.0, 4.0])  # a distance is no less than nothing
    np.testing.assert_array_equal(np.delete(asked, lane, axis=1), np.delete(own[10:12], lane, axis=1))
    assert (own[10:12, lane] != asked[:, lane]).all()
    Tool(panel).ask(ALL_INDEX["jaw_sideways"], 10, np.array([-3.0, 4.0]))  # type: ignore[arg-type]
    np.testing.assert_array_equal(panel.inference.asked[-1][1][:, ALL_INDEX["jaw_sideways"]], [-3.0, 4.0])


def test_a_weight_is_asked_as_it_is(panel: Panel) -> None:
    Tool(panel).ask(FIRST_WEIGHT + 7, 10, np.array([0.25, 1.5]))  # type: ignore[arg-type]
    (request,) = panel.inference.requests
    assert (request.shape, request.start) == (SHAPES[7], 10) and not panel.inference.asked
    np.testing.assert_array_equal(request.curve, [0.25, 1.5])


def test_what_was_asked_becomes_a_step_named_after_the_curve_and_nothing_asked_is_none(panel: Panel) -> None:
    stroke = Stroke(panel)  # type: ignore[arg-type]
    stroke.verb = "pull"
    for asks in (False, True):
        stroke._lane = 2
        assert stroke.busy
        panel.inference.busy = asks
        stroke.release(event(0))
        assert not stroke.busy and panel.inference.finished == [f"pull {CURVES[2].title}"] * asks
    stroke.release(event(0))
    assert len(panel.inference.finished) == 1


def test_a_stroke_that_is_dropped_springs_back_once(panel: Panel) -> None:
    stroke = Stroke(panel)  # type: ignore[arg-type]
    stroke.cancel()
    assert panel.inference.cancelled == 0
    stroke._lane = 0
    stroke.cancel()
    assert panel.inference.cancelled == 1 and not stroke.busy and not panel.inference.finished


def test_hints_stay_while_a_curve_is_held(panel: Panel) -> None:
    stroke = Stroke(panel)  # type: ignore[arg-type]
    stroke._lane = 0
    stroke.leave()
    assert panel.readouts == []
    stroke._lane = None
    stroke.leave()
    assert panel.readouts == [""]
    Tool(panel).done("draw", 0, QPointF())  # type: ignore[arg-type]
    assert not panel.inference.finished
