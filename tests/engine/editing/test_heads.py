"""Retargeting and driving through the front door are what the methods do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.character import Character, bundled, without_lacking
from engine.editing import (
    DriveRequest,
    LabelRequest,
    Matching,
    Performance,
    RetargetRequest,
    capture_of,
    drive,
    retarget,
    retarget_from_labels,
    standard_places,
    suggest_frames,
)
from engine.errors import EditError
from engine.formats import read_take
from engine.formats.markers.capture import Markers
from engine.lab.performer import demo
from engine.manifold.retarget import from_labels
from engine.manifold.retarget import suggest_frames as suggested
from engine.spacetime.layout import MARKERS, named, standard
from engine.spacetime.retarget import retarget as by_movement
from engine.spacetime.source import from_markers, from_take
from engine.take import SHAPE_INDEX, Take

LABELS = {10: {"jawOpen": 0.6}, 30: {"mouthSmileLeft": 0.7, "mouthSmileRight": 0.5}}


@pytest.fixture(scope="module")
def take() -> Take:
    return Take(read_take(demo.BUNDLED).weights[60:100], 30.0, name="short")


@pytest.fixture(scope="module")
def broad() -> Character:
    head = bundled()
    stretch = np.array([1.25, 0.95, 1.1], np.float32)
    return replace(head, neutral=head.neutral * stretch, deltas=0.8 * head.deltas * stretch)


@pytest.fixture(scope="module")
def markers() -> Markers:
    head, layout = bundled(), standard(bundled())
    jaw = np.sin(np.linspace(0, np.pi, 20))[:, None, None] * layout.deltas(head)[SHAPE_INDEX["jawOpen"]]
    return Markers(layout.rest(head) + jaw, layout.names, 30.0)


def test_a_take_by_movement(take: Take, broad: Character) -> None:
    performance, matching = Performance(take, bundled()), Matching(alpha=0.02, beta=0.2)
    made = retarget(performance, RetargetRequest(broad, matching=matching))
    expected = by_movement(from_take(take, bundled()), broad, matching=matching)
    np.testing.assert_array_equal(made.take.weights, expected.weights)
    patch = made.patch(take)
    np.testing.assert_array_equal(patch.apply(take).weights, expected.weights)
    assert (patch.start, patch.stop, made.uncertainty) == (0, len(take), None)


def test_a_part_of_it_begins_at_its_frame(take: Take, broad: Character) -> None:
    made = retarget(Performance(take, bundled()), RetargetRequest(broad, frames=(12, 20)))
    expected = by_movement(from_take(take, bundled()).part(12, 20), broad)
    np.testing.assert_array_equal(made.take.weights, expected.weights)
    np.testing.assert_array_equal(made.weights_at(12), expected.weights[0])
    np.testing.assert_array_equal(made.weights_at(19), expected.weights[-1])
    assert made.weights_at(11) is None and made.weights_at(20) is None


def test_a_capture_at_places_with_corrected_landmarks(markers: Markers, broad: Character) -> None:
    source = capture_of(markers)
    places = {name: vertex for name, vertex in standard_places(broad).items() if name != "chin"}
    landmarks = {"lip_upper": "lip_lower", "lip_lower": "lip_upper"}
    performance = Performance(source.take, bundled(), source)
    made = retarget(performance, RetargetRequest(broad, places, landmarks=landmarks))
    measured = from_markers(markers, landmarks=landmarks)
    expected = by_movement(measured, broad, layout=named(places))
    np.testing.assert_array_equal(made.take.weights, expected.weights)


def test_labels_bend_a_take(take: Take, broad: Character) -> None:
    made = retarget_from_labels(Performance(take, bundled()), LabelRequest(LABELS, RetargetRequest(broad)))
    expected = from_labels(take, LABELS)
    np.testing.assert_array_equal(made.take.weights, without_lacking(expected.take, broad).weights)
    np.testing.assert_array_equal(made.uncertainty, expected.uncertainty)


def test_labels_correct_what_a_captures_markers_tell(markers: Markers, broad: Character) -> None:
    source, told = capture_of(markers), list[float]()
    performance = Performance(source.take, bundled(), source)
    made = retarget_from_labels(performance, LabelRequest({10: {"jawOpen": 0.6}}, RetargetRequest(broad)), told.append)
    base = by_movement(source, broad)
    expected = from_labels(base, {10: {"jawOpen": 0.6}}, source=performance.features)
    np.testing.assert_array_equal(made.take.weights, expected.take.weights)
    assert told and min(told) >= 0 and max(told) <= 1


def test_frames_that_are_told_apart_are_suggested(take: Take, markers: Markers) -> None:
    performance = Performance(take, bundled())
    assert suggest_frames(performance, 3, [5]) == suggested(take.weights, 3, labelled=[5])
    assert performance.features is take.weights
    source = capture_of(markers)
    assert Performance(source.take, bundled(), source).features.shape == (20, 3 * len(MARKERS))


def test_telling_may_stop_it(take: Take, broad: Character) -> None:
    class Enough(Exception):
        pass

    def stop(_: float) -> None:
        raise Enough

    with pytest.raises(Enough):
        retarget(Performance(take, bundled()), RetargetRequest(broad), stop)


def test_what_is_stored_names_all_but_the_head(broad: Character) -> None:
    movement = RetargetRequest(broad, {"chin": 3}, Matching(alpha=1 / 3))
    stored = LabelRequest(LABELS, movement).stored()
    assert stored == {
        "places": {"chin": 3},
        "alpha": 1 / 3,
        "beta": Matching().beta,
        "closure": Matching().closure,
        "labels": {"10": LABELS[10], "30": LABELS[30]},
    }


def test_a_mesh_follows_points(take: Take, broad: Character) -> None:
    moving = drive(Performance(take, bundled()), DriveRequest(broad, standard_places(broad)))
    assert moving.frames.shape == (len(take), *moving.rest.shape) and moving.fps == take.fps
    chin = standard_places(broad)["chin"]
    jaw = take.weights[:, SHAPE_INDEX["jawOpen"]]
    lowest = int(np.argmin(moving.frames[:, broad.number_of(chin), 1]))
    assert jaw[lowest] >= np.quantile(jaw, 0.8)  # the chin is lowest where the jaw is open


def test_too_few_points_are_one_sentence(take: Take, broad: Character) -> None:
    few = dict(list(standard_places(broad).items())[:3])
    with pytest.raises(EditError, match="Only 3 of the mesh's points"):
        drive(Performance(take, bundled()), DriveRequest(broad, few))


def test_a_head_without_landmarks_has_no_standard_places(broad: Character) -> None:
    with pytest.raises(EditError, match="lacks the landmarks"):
        standard_places(replace(broad, landmarks={}))
