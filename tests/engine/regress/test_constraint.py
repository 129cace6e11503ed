from __future__ import annotations

import numpy as np
import pytest
import torch

from engine.controls import ALL_INDEX
from engine.extended import bundled_face
from engine.lab.performer.corpus import synthetic_performances
from engine.regress.areas import AREAS, EXTENDED_AREAS, Area
from engine.regress.constraint import Constraint
from engine.take import SHAPE_INDEX, SHAPES, Array

HOLDING = [area for area in (*AREAS, *EXTENDED_AREAS) if area.held]


@pytest.fixture
def face() -> Array:
    return synthetic_performances(0.2, seed=1)[0][:120]


def _constraint(area: Area) -> Constraint:
    return Constraint(area.held, area.shape_columns.tolist()).double().eval()


def _batch(curves: Array) -> torch.Tensor:
    return torch.from_numpy(np.ascontiguousarray(curves.T))[None]


def _brought(area: Area, guess: Array, asked: Array, still: Array) -> Array:
    """Return the face, (frames, 52), whose shapes of an area are brought from a guess onto asked curves, (frames, held)."""
    with torch.inference_mode():
        made = _constraint(area)(_batch(guess), _batch(asked), _batch(still), doubting=False)
    whole = still.copy()
    whole[:, area.shape_columns] = made[0].numpy().T
    return whole


def _columns(area: Area) -> list[int]:
    return [ALL_INDEX[name] for name in area.held]


@pytest.mark.parametrize("area", HOLDING, ids=lambda area: area.name)
def test_a_wrong_guess_is_brought_onto_the_controls_and_nearer_the_truth(area: Area, face: Array) -> None:
    asked = bundled_face().measure(face)[:, _columns(area)]
    truth = face[:, area.shape_columns]
    guess = np.clip(truth + 0.1 * np.random.default_rng(0).standard_normal(truth.shape), 0.0, 1.0)
    wrong = face.copy()
    wrong[:, area.shape_columns] = guess
    made = _brought(area, guess, asked, face)
    missed, before = (np.abs(bundled_face().measure(one)[:, _columns(area)] - asked) for one in (made, wrong))
    assert missed.mean() < 0.15 * before.mean()
    error, begun = (((one - face)[:, area.shape_columns] ** 2).mean() for one in (made, wrong))
    assert error < begun
    assert made.min() >= 0.0 and made.max() <= 1.0


def test_what_is_not_asked_is_not_held(face: Array) -> None:
    area = AREAS[2]
    guess = face[:, area.shape_columns]
    np.testing.assert_allclose(_brought(area, guess, np.full((len(face), 2), np.nan), face), face, atol=1e-12)


def test_where_the_eyes_look_counts_for_the_lids(face: Array) -> None:
    area, face = AREAS[2], face.copy()
    face[:, area.shape_columns] = 0.3
    down = face.copy()
    down[:, [SHAPE_INDEX[f"eyeLookDown{side}"] for side in ("Left", "Right")]] = 0.3
    asked = bundled_face().measure(face)[:, _columns(area)]
    made = _brought(area, face[:, area.shape_columns], asked, down)
    assert np.abs(bundled_face().measure(down)[:, _columns(area)] - asked).mean() > 0.5
    assert np.abs(bundled_face().measure(made)[:, _columns(area)] - asked).mean() < 0.05


def test_lips_that_close_as_far_as_the_jaw_is_open_are_measured_as_they_are_drawn(face: Array) -> None:
    area, shut = AREAS[0], face.copy()
    shut[:, SHAPE_INDEX["mouthClose"]] = 1.0
    constraint = _constraint(area)
    around = constraint.rest.expand(len(shut), -1, -1) + (torch.from_numpy(shut) @ constraint.others).view(
        len(shut), -1, 3
    )
    read, _ = constraint._measured(torch.from_numpy(shut[:, area.shape_columns]), around)
    np.testing.assert_allclose(read.numpy(), bundled_face().measure(shut)[:, _columns(area)], atol=1e-2)


def test_slopes_are_derivatives(face: Array) -> None:
    area = AREAS[0]
    constraint = _constraint(area)
    weights = torch.from_numpy(np.random.default_rng(3).uniform(0.1, 0.9, (1, len(area.shape_columns))))
    around = constraint.rest[None]
    _, slope = constraint._measured(weights, around)
    found = torch.autograd.functional.jacobian(lambda one: constraint._measured(one, around)[0], weights)
    torch.testing.assert_close(slope[0], found[0, :, 0], atol=1e-6, rtol=1e-5)


def test_a_request_that_the_face_misses_by_far_is_doubted(face: Array) -> None:
    area = AREAS[2]
    constraint = _constraint(area)
    guess, asked = _batch(face[:, area.shape_columns]), _batch(bundled_face().measure(face)[:, _columns(area)] + 60.0)
    with torch.inference_mode():
        believed, doubted = (constraint(guess, asked, _batch(face), doubting=doubting) for doubting in (False, True))
    assert (doubted - guess).abs().max() < 1e-6
    assert (believed - guess).abs().max() > 0.05


def test_training_goes_through_it(face: Array) -> None:
    area = AREAS[0]
    constraint = Constraint(area.held, area.shape_columns.tolist())
    guess = torch.rand(2, len(area.shape_columns), 16, requires_grad=True)
    asked = torch.tensor(bundled_face().measure(face[:32])[:, _columns(area)], dtype=torch.float32).view(2, 16, -1).mT
    constraint(guess, asked, doubting=True).square().sum().backward()
    for gradient in (guess.grad, constraint.noise.grad, constraint.tolerance.grad):
        assert gradient is not None and gradient.isfinite().all() and gradient.abs().max() > 0
    assert len(SHAPES) == constraint.others.shape[0]
