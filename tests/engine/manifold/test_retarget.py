from __future__ import annotations

import numpy as np
import pytest

from engine.character import bundled
from engine.errors import EditError
from engine.formats import read_take
from engine.lab.performer import demo
from engine.manifold.patches import alignment, similar
from engine.manifold.retarget import (
    Retargeter,
    Settings,
    coordinates,
    from_labels,
    retarget_points,
    retarget_weights,
    scaled_to,
    suggest_frames,
)
from engine.take import SHAPE_INDEX, SHAPES, Take


def landmarks(frames: slice) -> tuple[np.ndarray, np.ndarray]:
    """The bundled head's landmarks in the demo take, (frames, n, 3), and at rest."""
    rest, deltas = bundled().landmark_positions(list(bundled().landmarks))
    weights = np.clip(read_take(demo.BUNDLED).weights[frames], 0, 1)
    return rest + np.einsum("fs,spc->fpc", weights, deltas), rest


def exaggerated(source: np.ndarray, rest: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A head that moves otherwise: wider, and each landmark with its own gain in each direction."""
    gain = np.random.default_rng(4).uniform(0.4, 1.8, rest.shape)
    return rest * [1.3, 1, 0.9] + gain * (source - rest), rest * [1.3, 1, 0.9]


def test_a_source_that_the_target_copies_needs_one_label() -> None:
    source, rest = landmarks(slice(0, 100))
    turned_rest = 1.5 * rest + 10
    target = turned_rest + 1.5 * (source - rest)
    made = retarget_points(source, rest, turned_rest, {50: target[50]})
    np.testing.assert_allclose(made, target, atol=1e-6)


def test_more_labels_come_closer_and_every_label_is_met() -> None:
    source, rest = landmarks(slice(40, 140))
    target, target_rest = exaggerated(source, rest)
    errors = []
    for count in (2, 6, 20):
        frames = np.linspace(0, 99, count).round().astype(int)
        made = retarget_points(source, rest, target_rest, {int(f): target[f] for f in frames})
        np.testing.assert_allclose(made[frames], target[frames], atol=0.02)
        errors.append(np.linalg.norm(made - target, axis=2).mean())
    untouched = np.linalg.norm(target_rest + (source - rest) - target, axis=2).mean()
    assert errors[2] < errors[1] < errors[0] < untouched
    assert errors[2] < 0.05 * untouched


def test_suggested_frames_do_better_than_evenly_spaced_ones() -> None:
    source, rest = landmarks(slice(0, 240))
    target, target_rest = exaggerated(source, rest)

    def error(frames: list[int]) -> float:
        made = retarget_points(source, rest, target_rest, {f: target[f] for f in frames})
        return float(np.linalg.norm(made - target, axis=2).mean())

    even = [int(f) for f in np.linspace(0, 239, 6).round()]
    assert error(suggest_frames(source, 6)) < error(even)


def test_suggestions_go_on_from_the_labels_there_are() -> None:
    source, _ = landmarks(slice(0, 200))
    first = suggest_frames(source, 4)
    assert suggest_frames(source, 6)[:4] == first
    assert suggest_frames(source, 2, labelled=first) == suggest_frames(source, 6)[4:]
    assert len(set(suggest_frames(source, 500))) == 200


def test_a_long_take_is_solved_at_spread_frames_and_the_rest_follows_its_patch() -> None:
    source, rest = landmarks(slice(0, 240))
    target, target_rest = exaggerated(source, rest)
    labels = {f: target[f] for f in range(0, 240, 20)}
    whole = retarget_points(source, rest, target_rest, labels)
    spread = retarget_points(source, rest, target_rest, labels, Settings(at_once=120))
    errors = [np.linalg.norm(made - target, axis=2).mean() for made in (whole, spread)]
    np.testing.assert_allclose(spread[list(labels)], target[list(labels)], atol=0.02)
    assert errors[1] < 1.5 * errors[0]


def test_weights_of_a_target_with_shapes() -> None:
    take = read_take(demo.BUNDLED)
    halved = 0.5 * take.weights
    made = retarget_weights(take, {f: halved[f] for f in suggest_frames(take.weights, 20)})
    assert np.abs(made.weights - halved).mean() < 0.1 * np.abs(take.weights - halved).mean()
    assert len(made) == len(take) and made.fps == take.fps


def test_a_few_labels_tell_the_gain_of_every_point() -> None:
    """Over a source that moves everywhere: gains are found to within their ridge, and no gain is no change."""
    rng = np.random.default_rng(3)
    rest, away = rng.normal(size=(17, 3)), rng.normal(size=(200, 17, 3))
    target = rest + away * rng.uniform(0.4, 1.8, (17, 3))
    frames = np.arange(0, 200, 20)
    found = scaled_to(rest + away, rest, frames, target[frames])
    assert np.abs(found - target).mean() < 0.2 * np.abs(rest + away - target).mean()
    np.testing.assert_allclose(scaled_to(target, rest, frames, target[frames]), target, atol=1e-12)


def test_a_label_may_name_some_shapes_and_leaves_the_others_as_they_are() -> None:
    take = read_take(demo.BUNDLED)
    jaw = SHAPE_INDEX["jawOpen"]
    frames = suggest_frames(take.weights, 8)
    made = retarget_weights(take, {frame: {"jawOpen": 0.5 * take.weights[frame, jaw]} for frame in frames})
    others = np.arange(len(SHAPES)) != jaw
    np.testing.assert_allclose(made.weights[:, others], np.clip(take.weights[:, others], 0, None), atol=1e-3)
    assert np.abs(made.weights[:, jaw] - 0.5 * take.weights[:, jaw]).mean() < 0.02
    with pytest.raises(EditError, match="no shape called 'grin'"):
        retarget_weights(take, {3: {"grin": 1.0}})


@pytest.mark.parametrize(
    ("labelled", "says"), [([], "no labelled frame"), ([3, 3], "twice"), ([500], "Frame 500"), ([-1], "Frame -1")]
)
def test_unusable_labels_are_named(labelled: list[int], says: str) -> None:
    source = np.random.default_rng(0).random((40, 6))
    with pytest.raises(EditError, match=says):
        Retargeter(source, source, np.array(labelled, np.int64))


def test_a_source_with_gaps_is_refused() -> None:
    source = np.random.default_rng(0).random((40, 6))
    source[3, 2] = np.nan
    with pytest.raises(EditError, match="finite"):
        Retargeter(source, source, np.array([0]))


def test_the_uncertainty_is_the_root_of_the_inverse_s_diagonal() -> None:
    rng = np.random.default_rng(5)
    source = rng.random((30, 6)).cumsum(axis=0)
    retargeter = Retargeter(source, source, np.array([3, 20]), Settings(neighbours=8, dimension=3))
    energy = alignment(coordinates(source), similar(coordinates(source), size=8), dimension=3, stiffness=1e-4)
    held = np.zeros(30)
    held[[3, 20]] = 1e3
    plain = np.sqrt(np.diag(np.linalg.inv(energy.toarray() + np.diag(held))))
    np.testing.assert_allclose(retargeter.uncertainty(), plain, rtol=1e-5)
    assert plain[[3, 20]].max() < np.median(plain)


def test_a_solve_from_labels_tells_its_share_and_stops_when_asked(random_take: Take) -> None:
    class Enough(Exception):
        pass

    def tell(share: float) -> None:
        assert 0 <= share <= 1
        raise Enough

    with pytest.raises(Enough):
        from_labels(random_take, {3: random_take.weights[3]}, progress=tell)


def test_frames_that_are_loosely_held_are_those_that_come_out_wrong() -> None:
    weights = read_take(demo.BUNDLED).weights[:250]
    rng = np.random.default_rng(1)
    gain = 1 + 0.8 * np.tanh((weights - weights.mean(axis=0)) @ rng.normal(0, 0.5, (52, 52)))
    truth = np.clip(weights * gain @ (np.eye(52) + rng.normal(0, 0.08, (52, 52))), 0, 1)
    made = from_labels(Take(weights, 30.0), {frame: truth[frame] for frame in suggest_frames(weights, 4)})
    error = np.sqrt(((made.take.weights - truth) ** 2).mean(axis=1))
    assert np.corrcoef(np.argsort(np.argsort(made.uncertainty)), np.argsort(np.argsort(error)))[0, 1] > 0.8
    assert (error < error[np.argmax(made.uncertainty)]).mean() > 0.9
