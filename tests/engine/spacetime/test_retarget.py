from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.character import Character, bundled
from engine.errors import EditError
from engine.formats.markers.capture import Markers
from engine.spacetime.closure import Gaps
from engine.spacetime.layout import standard
from engine.spacetime.matching import Matching
from engine.spacetime.retarget import Tuning, correspond, match, retarget
from engine.spacetime.source import Source, from_markers, from_take
from engine.take import SHAPE_INDEX, Array, Take
from tests.engine.spacetime.captures import apart, captured

FREE = Matching(alpha=1e-7, beta=0.1, closure=0.0, bounds=None)


def _markers_of(weights: Array) -> Array:
    return from_take(Take(weights, 30.0), bundled()).displacements


def test_a_take_on_its_own_head_moves_the_markers_as_they_were(take: Take, played: Source) -> None:
    found = retarget(played, bundled(), matching=FREE)
    moved = found.weights @ standard(bundled()).deltas(bundled()).reshape(52, -1)
    np.testing.assert_allclose(moved.reshape(played.displacements.shape), played.displacements, atol=0.05)


def test_gaze_and_tongue_are_carried_over_by_name(take: Take, played: Source) -> None:
    found = retarget(played, bundled())
    for shape in ("eyeLookInLeft", "eyeLookOutRight", "tongueOut"):
        np.testing.assert_array_equal(found.curve(shape), take.curve(shape))


def test_a_larger_head_gets_the_same_weights(played: Source) -> None:
    character = bundled()
    scaled: Character = replace(
        character, neutral=character.neutral * np.float32(1.3), deltas=character.deltas * np.float32(1.3)
    )
    pair, larger = correspond(played, character), correspond(played, scaled)
    np.testing.assert_allclose(larger.basis, pair.basis, atol=1e-3)


def test_a_capture_moves_the_face_as_the_take_did(take: Take, played: Source) -> None:
    found = retarget(from_markers(captured(played)), bundled())
    rest = apart(_markers_of(take.weights), 0 * played.displacements)
    assert apart(_markers_of(found.weights), _markers_of(take.weights)) < 0.35 * rest


def test_gaps_are_bridged(played: Source) -> None:
    markers = captured(played)
    holes = markers.positions.copy()
    hidden = np.random.default_rng(0).random(holes.shape[:2]) < 0.1
    hidden[0] = False
    holes[hidden] = np.nan
    whole = retarget(from_markers(markers), bundled()).weights
    found = retarget(from_markers(replace(markers, positions=holes)), bundled()).weights
    assert apart(_markers_of(found), _markers_of(whole)) < 0.3


def test_eyes_that_close_in_the_source_close_however_strong_the_prior() -> None:
    """The paper's figure 7(e): a strong prior keeps the eyes from closing all the way."""
    blink = np.zeros((40, 52))
    lids = [SHAPE_INDEX["eyeBlinkLeft"], SHAPE_INDEX["eyeBlinkRight"]]
    blink[18:24, lids] = np.array([0.4, 0.9, 1.0, 1.0, 0.7, 0.3])[:, None]
    source, gaps = from_take(Take(blink, 30.0), bundled()), Gaps(bundled())
    opened = {
        closure: gaps.sizes(retarget(source, bundled(), matching=Matching(alpha=0.5, closure=closure)).weights)
        for closure in (0.0, 30.0)
    }
    assert opened[0.0][20:22, 3:].min() > 3
    assert opened[30.0][20:22, 3:].max() < 2  # where a lid counts as closed


def test_a_part_is_solved_as_a_take_of_its_own(played: Source) -> None:
    part = played.part(20, 60)
    assert len(retarget(part, bundled())) == len(part) == 40


def _without(markers: Markers, index: int) -> Markers:
    positions = markers.positions.copy()
    positions[0, index] = np.nan
    return replace(markers, positions=positions)


def _doubled(markers: Markers) -> Markers:
    positions = markers.positions.copy()
    positions[:, 1] = positions[:, 0]
    return replace(markers, positions=positions)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda m: replace(m, names=tuple(f"x{i}" for i in range(54))), "Only 0 of the source's 54 markers"),
        (lambda m: _without(m, 7), "lip_lower is missing in the neutral frame"),
        (_doubled, "forehead and glabella are at the same place"),
    ],
)
def test_captures_that_cannot_be_used_say_why(played: Source, change: object, says: str) -> None:
    with pytest.raises(EditError, match=says):
        retarget(from_markers(change(captured(played))), bundled())  # type: ignore[operator]


def test_a_jaw_at_its_bound_is_solved_around_not_cut_off(monkeypatch: pytest.MonkeyPatch) -> None:
    """The source opens its jaw further than the target can; cutting it off would leave the rest as it was."""
    talk = np.zeros((60, 52))
    phase = np.sin(np.linspace(0, 3 * np.pi, 60)) ** 2
    talk[:, SHAPE_INDEX["jawOpen"]], talk[:, SHAPE_INDEX["mouthClose"]] = phase, 0.4 * phase
    deltas = bundled().deltas.copy()
    deltas[SHAPE_INDEX["jawOpen"]] *= np.float32(0.6)
    stiff = replace(bundled(), deltas=deltas)
    pair = correspond(from_take(Take(talk, 30.0), bundled()), stiff)

    def speed_error() -> float:
        weights = match(pair, 30.0, Matching())
        assert weights.min() >= 0 and weights.max() <= 1
        return float((np.diff(weights @ pair.basis.T - pair.motion, axis=0) ** 2).sum())

    solved = speed_error()
    monkeypatch.setattr("engine.spacetime.retarget.TUNING", Tuning(jaw_rounds=0))
    assert solved < 0.8 * speed_error()
