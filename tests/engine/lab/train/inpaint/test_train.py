from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from engine.inpaint.base import base_of
from engine.inpaint.features import FEATURES
from engine.inpaint.gap import gap_of
from engine.inpaint.infer import load, save_filler
from engine.inpaint.network import TUNING, noise_curves
from engine.inpaint.statistics import statistics_of
from engine.lab.corpus import Piece
from engine.lab.train.inpaint import train as training
from engine.lab.train.inpaint.losses import Batch, Shares, fill_losses, scatter
from engine.lab.train.inpaint.material import (
    Help,
    Performance,
    draw,
    performances,
    random_gap,
    random_hole,
    roughened,
    said_in,
    synthetic,
    window,
)
from engine.lab.train.inpaint.train import Settings, Trainer, make_batches
from engine.speech.visemes import NAMES, Cue
from engine.take import SHAPES

SMALL = Settings(frames=64, hidden=16, batch=4, shared_steps=2, parted_steps=2, help=Help(synthetic_minutes=0.3))


@pytest.fixture(scope="module")
def material() -> list[Performance]:
    return synthetic(0.3, np.random.default_rng(0))


def test_synthetic_performances_say_where_their_lips_are_shut(material: list[Performance]) -> None:
    from engine.controls import measure
    from engine.speech.visemes import NAMES

    one = material[0]
    assert len(one.weights) == len(one.visemes) and (one.visemes >= 0).mean() > 0.95
    lips = measure(one.weights)[:, 0]
    shut, wide = one.visemes == NAMES.index("mbp"), one.visemes == NAMES.index("aa")
    assert np.median(lips[shut]) < 2.0 < np.median(lips[wide])


def test_pieces_of_the_mouth_alone_get_a_whole_face() -> None:
    rng = np.random.default_rng(0)
    face = Piece(rng.random((100, len(SHAPES))), True, "face")
    mouth = Piece(np.zeros((150, len(SHAPES))), False, "mouth")
    made = performances([face, mouth], Help(synthetic_minutes=0.0, read_lips=False), rng)
    blink = SHAPES.index("eyeBlinkLeft")
    assert made[1].weights[:, blink].std() > 0.1 and not made[1].weights[:, SHAPES.index("jawOpen")].any()


def test_a_window_longer_than_its_curves_runs_to_and_fro() -> None:
    np.testing.assert_array_equal(window(np.arange(4.0)[:, None], 9, 2)[:, 0], [2, 3, 2, 1, 0, 1, 2, 3, 2])


def test_a_gap_shows_nothing_of_the_truth_inside_but_what_it_should(material: list[Performance]) -> None:
    rng = np.random.default_rng(1)
    for _ in range(40):
        truth = draw(material, 80, rng)
        gap = random_gap(truth, Help(unguided=1.0), rng)
        there = np.isfinite(gap.known)
        np.testing.assert_array_equal(gap.known[there], truth.weights[there])
        if not gap.known.any(where=there):
            continue
        assert not np.isfinite(gap.guide).any() and not gap.visemes.any()


def test_holes_reach_both_ends_and_everything() -> None:
    rng = np.random.default_rng(0)
    holes = [random_hole(60, rng) for _ in range(300)]
    assert any(hole[0].any() for hole in holes) and any(hole[-1].any() for hole in holes)
    assert any(hole.all() for hole in holes) and all(hole.any() for hole in holes)


def test_a_rough_guide_is_rough_and_in_range(material: list[Performance]) -> None:
    rough = roughened(material[0].weights, np.random.default_rng(0))
    assert rough.min() >= 0 and rough.max() <= 1 and np.abs(rough - material[0].weights).mean() > 1e-3


def test_the_ground_keeps_what_is_known_and_features_are_finite(material: list[Performance]) -> None:
    rng = np.random.default_rng(2)
    statistics = statistics_of(material[0].weights)
    for _ in range(40):
        gap = random_gap(draw(material, 80, rng), Help(), rng)
        base = base_of(gap, statistics)
        there = np.isfinite(gap.known)
        np.testing.assert_array_equal(base.base[there], gap.known[there])
        assert not base.blend[there].any() and (base.blend[~there] > 0).all()
        assert base.features.shape == (80, FEATURES) and np.isfinite(base.features).all()


def test_losses_equal_a_plain_sum_over_the_hole(material: list[Performance]) -> None:
    statistics = statistics_of(material[0].weights)
    batch = make_batches(material, statistics, SMALL, np.random.default_rng(0), size=2)[0]
    terms = fill_losses(batch.base, batch, training.six_distances(), Shares(far=1.0, values=1.0, squares=1.0))
    for index in range(2):
        off = (batch.base[index] - batch.truth[index])[batch.hole[index].bool()]
        torch.testing.assert_close(terms["values"][index], off.abs().mean())
        torch.testing.assert_close(terms["squares"][index], off.square().mean())


def test_scatter_is_least_for_fills_drawn_as_the_truth_is() -> None:
    """Truths are drawn at random; neither the one best guess nor too wide a scatter may score as well as such draws."""
    draws, shape = 400, (1, 64, 2)
    torch.manual_seed(0)
    whole = torch.ones(shape)
    scores = {spread: 0.0 for spread in (0.0, 0.5, 1.0, 1.5, 2.0)}
    for _ in range(draws):
        truth, one, other = (torch.randn(1, 1, 2).expand(shape) for _ in range(3))
        batch = Batch(truth, whole, whole, whole, whole, torch.zeros(1, 64, 1))
        for spread in scores:
            scores[spread] += float(scatter(spread * one, spread * other, batch)) / draws
    assert min(scores, key=lambda spread: scores[spread]) == 1.0


def test_scatter_asks_nothing_where_the_pose_is_settled(material: list[Performance]) -> None:
    batch = make_batches(material, statistics_of(material[0].weights), SMALL, np.random.default_rng(0), size=2)[0]
    settled = replace(batch, certainty=torch.ones_like(batch.certainty))
    assert not scatter(settled.base, settled.base + 0.1, settled).any()


def test_noise_has_unit_variance_and_each_curve_its_own_memory() -> None:
    noise = noise_curves(200_000, np.random.default_rng(0))
    np.testing.assert_allclose(noise.std(axis=0), 1.0, atol=0.05)
    for curve, memory in zip(noise.T, TUNING.memory_frames, strict=True):
        lag = max(1, round(memory))
        expected = np.exp(-lag / memory) if memory else 0.0
        assert np.corrcoef(curve[:-lag], curve[lag:])[0, 1] == pytest.approx(expected, abs=0.05)


def test_sound_is_matched_to_the_piece_that_was_cut_from_its_take() -> None:
    cues = [Cue(0.0, 1.0, "SIL"), Cue(1.0, 2.0, "M"), Cue(2.0, 3.0, "AA")]
    piece = Piece(np.zeros((60, len(SHAPES))), False, "mouth", first=45)
    classes = said_in(piece, cues)
    assert [NAMES[classes[frame]] for frame in (0, 14, 15, 44)] == ["mbp", "mbp", "aa", "aa"] and classes[50] == -1
    with_sound, without = (
        performances([piece, Piece(np.zeros((60, len(SHAPES))), True, "face")], Help(synthetic_minutes=0), rng, heard)
        for rng, heard in ((np.random.default_rng(0), {"mouth": cues}), (np.random.default_rng(0), None))
    )
    assert len(with_sound) == len(without) + Help().heard_copies
    np.testing.assert_array_equal(with_sound[-1].visemes, classes)


@pytest.mark.parametrize("adversary", [True, False])
def test_training_goes_on_exactly_where_it_stopped(material: list[Performance], *, adversary: bool) -> None:
    whole = Trainer(material, SMALL, adversary=adversary)
    terms = [whole.advance(step) for step in range(4)]
    assert ("adversary" in terms[-1]) == adversary and all(np.isfinite(list(one.values())).all() for one in terms)
    first = Trainer(material, SMALL, adversary=adversary)
    for step in range(3):
        first.advance(step)
    second = Trainer(material, SMALL, adversary=adversary)
    second.restore(first.state())
    assert second.advance(3) == terms[-1]
    for one, other in zip(whole.generator.parameters(), second.generator.parameters(), strict=True):
        assert torch.equal(one, other)


def test_both_ways_have_the_steps_before_they_part_in_common(
    monkeypatch: pytest.MonkeyPatch, material: list[Performance], tmp_path: Path
) -> None:
    monkeypatch.setattr(training, "split", lambda data: ([], [], []))
    monkeypatch.setattr(training, "listened", lambda data: {})
    monkeypatch.setattr(training, "performances", lambda *rest: material)
    monkeypatch.setattr(training, "validation_figures", lambda *rest: {})
    monkeypatch.setattr(training, "EVERY", 1)
    lines: list[str] = []
    training.train(tmp_path, tmp_path, SMALL, lines.append)
    assert [line for line in lines if "going on" in line] == ["going on after inpaint_feedforward 2/4"]
    assert not list(tmp_path.glob("*.partial.safetensors"))


def test_a_saved_filler_fills_alike(material: list[Performance], tmp_path: Path) -> None:
    trainer = Trainer(material, SMALL, adversary=False)
    trainer.advance(0)
    known = material[0].weights[:80].copy()
    known[30:60] = np.nan
    save_filler(tmp_path / "inpaint.safetensors", trainer.filler())
    made, again = (
        f.fill(gap_of(known), seeds=(3,)) for f in (trainer.filler(), load(tmp_path / "inpaint.safetensors"))
    )
    np.testing.assert_allclose(made, again, atol=1e-6)
