"""An editor answers as its methods do, whatever it was asked before."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from engine import retouch
from engine.clean.takes import clean as clean_take
from engine.controls import ALL_INDEX
from engine.editing import (
    CleanRequest,
    ControlRequest,
    Dragger,
    DragRequest,
    Editor,
    FillRequest,
    PasteRequest,
    Patch,
    PinRequest,
    Request,
    SmoothRequest,
    SpansRequest,
    WeightRequest,
    ask,
)
from engine.errors import EditError
from engine.formats import read_take
from engine.inpaint.fill import fill_spans, refill
from engine.lab.performer import demo
from engine.spacetime.pin import PinSolver, Spreading
from engine.take import SHAPE_INDEX, Take


@pytest.fixture(scope="module")
def take() -> Take:
    """Four seconds of the demo take, a lost run among them."""
    read = read_take(demo.BUNDLED)
    lost = np.zeros(120, bool)
    lost[100:104] = True
    return Take(read.weights[60:180], read.fps, lost, name="short")


def requests(take: Take) -> dict[str, Request]:
    asked = Dragger(take).controls[40:60].copy()
    asked[:, ALL_INDEX["lips_vertical"]] += 3.0
    return {
        "drag": DragRequest(40, asked, 0.25),
        "control": ControlRequest("lips_vertical", (40, 60), "set", 9.0, 0.25),
        "weight": WeightRequest("jawOpen", 30, np.linspace(0, 1, 20)),
        "paste": PasteRequest(70, take.weights[10:15]),
        "smooth": SmoothRequest((20, 60), 4.0),
        "clean": CleanRequest((20, 60), 0.5),
        "clean more": CleanRequest((20, 60), 0.75),
        "clean elsewhere": CleanRequest((30, 60), 0.75),
        "pin": PinRequest({50: {"mouthSmileLeft": 0.8}}, (40, 60)),
        "pin further": PinRequest({50: {"mouthSmileLeft": 0.9, "jawOpen": 0.2}}, (40, 60)),
        "pin freely": PinRequest({50: {"mouthSmileLeft": 0.8}}, (40, 60), whole=False),
        "pin other weights freely": PinRequest({50: {"jawOpen": 0.3}}, (40, 60), whole=False),
        "pin without closures": PinRequest({50: {"mouthSmileLeft": 0.8}}, (40, 60), closure=0.0),
        "fill": FillRequest((40, 60), seed=3),
        "spans": SpansRequest(((96, 106), (40, 44)), FillRequest((0, 0), seed=1)),
    }


def _dragged(take: Take, request: DragRequest) -> Patch:
    return Dragger(take).drag(request.start, request.asked, believability=request.believability)


def _set(take: Take, request: ControlRequest) -> Patch:
    dragger, how = Dragger(take), (request.control, request.frames, request.change, request.amount)
    return dragger.drag(*ask(dragger.controls, *how, fps=take.fps), believability=request.believability)


def _cleaned(take: Take, request: CleanRequest) -> Patch:
    full, (start, stop) = clean_take(take, frames=request.frames).take.weights, request.frames
    raw = take.weights[start:stop]
    mixed = take.with_rows(start, raw + request.strength * (full[start:stop] - raw))
    return Patch.between(take, mixed, request.frames)


def _pinned(take: Take, request: PinRequest) -> Patch:
    how = Spreading() if request.closure is None else Spreading(closure=request.closure)
    solver = PinSolver(take, request.pins, request.frames, whole=request.whole, spreading=how)
    return Patch.between(take, solver.take(request.pins), request.frames)


def _filled(take: Take, request: FillRequest) -> Patch:
    return Patch.between(take, refill(take, request, seeds=(request.seed,))[0].take, request.frames)


def _filled_all(take: Take, request: SpansRequest) -> Patch:
    filled = fill_spans(take, request.spans, request.steering, seed=request.steering.seed)
    return Patch.between(take, filled, request.frames)


PLAINLY: dict[type, Callable[[Take, Any], Patch]] = {  # what the method behind a verb comes to
    DragRequest: _dragged,
    ControlRequest: _set,
    WeightRequest: lambda take, each: retouch.replace_weight(take, SHAPE_INDEX[each.shape], each.start, each.curve),
    PasteRequest: lambda take, each: retouch.paste(take, each.start, each.weights),
    SmoothRequest: lambda take, each: retouch.smooth(take, each.frames, each.cutoff_hz),
    CleanRequest: _cleaned,
    PinRequest: _pinned,
    FillRequest: _filled,
    SpansRequest: _filled_all,
}


def test_an_editor_answers_as_the_methods_do_whatever_came_before(take: Take) -> None:
    editor, asked = Editor(take), requests(take)
    for name in (*asked, *reversed(asked)):
        patch, expected = editor.patch(asked[name]), PLAINLY[type(asked[name])](take, asked[name])
        assert patch.start == expected.start, name
        np.testing.assert_array_equal(patch.weights, expected.weights, err_msg=name)
        np.testing.assert_array_equal(patch.asked, expected.asked, err_msg=name)
        np.testing.assert_array_equal(patch.reached, expected.reached, err_msg=name)


def test_the_first_variant_of_many_is_the_one_of_its_seed(take: Take) -> None:
    one, many = (
        Editor(take).patch(FillRequest((40, 70), seed=4)),
        Editor(take).variants(FillRequest((40, 70), seed=4), 3),
    )
    assert len(many) == 3
    np.testing.assert_allclose(one.weights, many[0].weights, atol=1e-6)
    assert np.abs(many[1].weights - many[2].weights).max() > 1e-3
    assert len(Editor(take).variants(FillRequest((40, 70), style="bridge"), 3)) == 1


def test_what_edits_below_asked_holds_under_a_drag(take: Take) -> None:
    editor = Editor(take)
    held = np.full_like(editor.controls, np.nan)
    held[:, ALL_INDEX["lips_horizontal"]] = editor.controls[:, ALL_INDEX["lips_horizontal"]]
    request = ControlRequest("lips_vertical", (40, 60), "add", 6.0)
    free, kept = editor.patch(request), Editor(take, editor.controls, asked=held).patch(request)
    column = ALL_INDEX["lips_horizontal"]
    rows = slice(free.start, free.stop)
    strayed = [np.abs(each.reached[:, column] - editor.controls[rows, column]).max() for each in (free, kept)]
    assert strayed[1] < 1e-3 < strayed[0]


def test_a_lag_is_told_of_cleaning_alone(take: Take) -> None:
    editor = Editor(take)
    assert editor.patch(CleanRequest((20, 60))).lag_ms is not None
    assert editor.patch(SmoothRequest((20, 60), 4.0)).lag_ms is None


@pytest.mark.parametrize(
    ("request_", "says"),
    [
        (WeightRequest("grin", 3, np.zeros(3)), "no shape called 'grin'"),
        (CleanRequest((3, 9), 1.5), "not between 0 and 1"),
        (CleanRequest((3, 900)), "not within the take"),
        (PinRequest({}, (3, 9)), "no pin"),
        (SmoothRequest((3, 9), 400.0), "cutoff"),
        (FillRequest((3, 900)), "not within the take"),
        (ControlRequest("grin", (3, 9), "set", 1.0), "grin"),
    ],
)
def test_what_does_not_fit_is_one_sentence(take: Take, request_: Request, says: str) -> None:
    with pytest.raises(EditError, match=says):
        Editor(take).patch(request_)
