from __future__ import annotations

import numpy as np
import pytest

from engine.controls import CONTROL_INDEX, measure
from engine.lab.performer.corpus import synthetic_performances
from engine.regress.contacts import APART_MM, MEETING, met
from engine.take import SHAPE_INDEX, SHAPES, Array

WHOLLY = np.ones((1, len(MEETING)))


@pytest.fixture
def weights() -> Array:
    return synthetic_performances(0.2, seed=1)[0]


def test_what_is_as_asked_stays_bit_for_bit(weights: Array) -> None:
    np.testing.assert_allclose(met(weights, measure(weights), WHOLLY), weights, atol=1e-6)


def test_a_closure_that_is_missed_by_a_little_is_met(weights: Array) -> None:
    asked = measure(weights)
    ajar = np.array(weights)
    for name in ("eyeBlinkLeft", "eyeBlinkRight", "mouthClose"):
        ajar[:, SHAPE_INDEX[name]] *= 0.96
    shut = (asked[:, MEETING] < 3.0) & (asked[:, MEETING] > 0.3)
    before = np.abs(measure(ajar)[:, MEETING] - asked[:, MEETING])[shut]
    after = np.abs(measure(met(ajar, asked, WHOLLY))[:, MEETING] - asked[:, MEETING])[shut]
    assert before.max() > 0.3
    assert np.quantile(after, 0.99) < 0.02


def test_a_face_far_from_what_is_asked_was_mended_on_purpose() -> None:
    apart = np.zeros((1, len(SHAPES)))
    asked = measure(apart)
    asked[:, CONTROL_INDEX["eyelid_left"]] -= 10.0
    assert measure(apart)[0, CONTROL_INDEX["eyelid_left"]] > APART_MM
    np.testing.assert_array_equal(met(apart, asked, WHOLLY), apart)


def test_a_wink_of_the_take_itself_is_no_mistake() -> None:
    face = np.zeros((1, len(SHAPES)))
    wink = np.array(face)
    wink[:, SHAPE_INDEX["eyeBlinkLeft"]] = 0.9
    asked = measure(wink)
    np.testing.assert_array_equal(met(face, asked, WHOLLY), face)
    np.testing.assert_allclose(measure(met(face, asked, WHOLLY, asked))[:, MEETING], asked[:, MEETING], atol=0.3)


def test_a_request_that_had_to_be_tempered_is_not_met_to_the_letter(weights: Array) -> None:
    asked = measure(weights) + 0.5
    np.testing.assert_array_equal(met(weights, asked, 0.3 * WHOLLY), weights)
    assert (met(weights, asked, WHOLLY) != weights).any()


def test_each_frame_is_for_itself_and_gaze_is_left_alone(weights: Array) -> None:
    asked = measure(weights) + np.random.default_rng(0).normal(0, 0.5, (len(weights), 8))
    whole = met(weights, asked, WHOLLY)
    np.testing.assert_allclose(met(weights[40:43], asked[40:43], WHOLLY), whole[40:43], atol=1e-6)
    gaze = [index for index, name in enumerate(SHAPES) if name.startswith("eyeLook")]
    np.testing.assert_array_equal(whole[:, gaze], weights[:, gaze])
    assert whole.min() >= 0 and whole.max() <= 1
