"""Each verb is a function of a take and of what is asked; what it does is what an editor answers."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from engine import editing
from engine.clean.takes import clean as clean_take
from engine.controls import CONTROL_INDEX, measure
from engine.editing import Editor, Patch, Request
from engine.errors import EditError
from engine.inpaint.fill import fill_spans
from engine.take import SHAPES, Take

VERBS: dict[str, tuple[Callable[[Take, Any], Patch], Request]] = {
    "control": (editing.set_control, editing.ControlRequest("lips_vertical", (40, 50), "add", 2.0)),
    "weight": (editing.replace_weight, editing.WeightRequest("jawOpen", 30, np.linspace(0, 1, 8))),
    "paste": (editing.paste, editing.PasteRequest(70, np.full((2, len(SHAPES)), 0.25))),
    "smooth": (editing.smooth, editing.SmoothRequest((20, 40), 4.0)),
    "clean": (editing.clean, editing.CleanRequest((20, 40), 0.5)),
    "pin": (editing.pin, editing.PinRequest({50: {"jawOpen": 0.5}}, (40, 60))),
    "fill": (editing.fill, editing.FillRequest((40, 60), seed=2)),
    "spans": (editing.fill_spans, editing.SpansRequest(((40, 50), (60, 70)))),
}


@pytest.fixture(scope="module")
def take() -> Take:
    """Three seconds of slow motion, a lost run in them."""
    rng, lost = np.random.default_rng(5), np.zeros(90, bool)
    lost[[57, 58, 80, 81]] = True
    weights = np.clip(0.2 + np.cumsum(rng.normal(0, 0.01, (90, len(SHAPES))), axis=0), 0, 1)
    return Take(weights, 30.0, lost, name="slow")


@pytest.mark.parametrize("verb", list(VERBS))
def test_a_verb_is_what_an_editor_answers(take: Take, verb: str) -> None:
    act, request = VERBS[verb]
    patch, expected = act(take, request), Editor(take).patch(request)
    np.testing.assert_array_equal(patch.apply(take).weights, expected.apply(take).weights)
    assert np.abs(patch.apply(take).weights - take.weights).max() > 1e-3


def test_a_drag_is_what_an_editor_answers(take: Take) -> None:
    asked = Editor(take).controls[30:50] + 0.5
    request = editing.DragRequest(30, asked)
    np.testing.assert_array_equal(editing.drag(take, request).weights, Editor(take).patch(request).weights)


def test_a_patch_over_many_spans_makes_the_very_take_that_filling_them_does(take: Take) -> None:
    spans = ((55, 60), (10, 20), (79, 84))
    request = editing.SpansRequest(spans, editing.FillRequest((0, 0), lost=True, seed=1))
    patched, filled = editing.fill_spans(take, request).apply(take), fill_spans(take, spans, request.steering, seed=1)
    np.testing.assert_array_equal(patched.weights, filled.weights)
    np.testing.assert_array_equal(patched.lost, filled.lost)


def test_clean_with_its_figures_is_the_method_and_near_the_patch(take: Take) -> None:
    request = editing.CleanRequest((20, 60), 0.5)
    told, expected = editing.cleaned(take, request), clean_take(take, strength=0.5, frames=(20, 60))
    np.testing.assert_array_equal(told.take.weights, expected.take.weights)
    assert told.lag_ms == expected.lag_ms and told.touched == (20, 60)
    np.testing.assert_allclose(editing.clean(take, request).apply(take).weights, told.take.weights, atol=1e-12)


def test_variants_are_of_seeds_that_follow_each_other(take: Take) -> None:
    first, second = editing.fill_variants(take, editing.FillRequest((30, 60), seed=7), 2)
    again = editing.fill_variants(take, editing.FillRequest((30, 60), seed=8), 1)[0]
    np.testing.assert_allclose(second.weights, again.weights, atol=1e-6)
    assert np.abs(first.weights - second.weights).max() > 1e-3


def test_lost_runs_are_spans(take: Take) -> None:
    assert editing.lost_spans(take) == ((57, 59), (80, 82))


def test_a_pose_reaches_a_control(take: Take) -> None:
    pose = editing.pose_reaching(take, 10, {"lips_vertical": 9.0})
    assert measure(pose[None])[0, CONTROL_INDEX["lips_vertical"]] == pytest.approx(9.0, abs=0.2)


def test_pins_that_disagree_are_one_sentence() -> None:
    merged = editing.merged_pins([(3, {"jawOpen": 0.5}), (3, {"tongueOut": 0.25})])
    assert np.nansum(merged[3]) == 0.75  # type: ignore[arg-type]
    with pytest.raises(EditError, match="different values of jawOpen"):
        editing.merged_pins([(3, {"jawOpen": 0.5}), (3, {"jawOpen": 0.25})])


def test_asking_loads_no_network_and_no_solver() -> None:
    """The window is seen before they are there."""
    said = "import sys, engine.editing; print([name for name in ('torch', 'scipy') if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", said], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
