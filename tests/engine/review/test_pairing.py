"""Two takes as one that can be opened, and the take before put at another time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine import project
from engine.errors import EditError, EngineError
from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.project import Contents, Project, replay
from engine.review.align import on_clock_of
from engine.review.pairing import (
    align_edit,
    alignment_of,
    contents_of,
    found_again,
    on_its_clock,
    pair,
    paired_by,
)
from engine.take import Take

DEMO = read_take(demo.BUNDLED)


def part(start: int, stop: int) -> Take:
    return Take(DEMO.weights[start:stop].copy(), DEMO.fps, name="part.csv", lost=DEMO.lost[start:stop].copy())


def test_the_edit_of_a_pair_turns_the_first_take_into_the_second(tmp_path: Path) -> None:
    after = part(30, 200)
    write_take(after, tmp_path / "part.csv")
    made = contents_of(demo.BUNDLED, tmp_path / "part.csv", beside=tmp_path / "reviews" / "part.retake")
    state = replay(made)
    read = read_take(tmp_path / "part.csv")
    np.testing.assert_array_equal(state.take.weights, read.weights)
    np.testing.assert_array_equal(state.take.lost, read.lost)
    np.testing.assert_allclose(made.original.weights, DEMO.weights[30:200], atol=1e-9)
    told = paired_by(made.edits)
    assert told is not None and alignment_of(told).offset_s == pytest.approx(1.0) and alignment_of(told).alike
    (tmp_path / "reviews").mkdir()
    assert found_again({"before": "../part.csv"}, tmp_path / "reviews" / "part.retake") is not None
    assert found_again({"before": "../gone.csv"}, tmp_path / "reviews" / "part.retake") is None


def test_nothing_differs_where_the_take_before_has_no_frame() -> None:
    after = part(0, 100)
    found = pair(part(40, 140), after, offset_s=-40 / DEMO.fps)
    np.testing.assert_array_equal(found.before.weights[:40], after.weights[:40])
    np.testing.assert_allclose(found.before.weights[40:], after.weights[40:], atol=1e-12)
    assert found.apart == 40 and not found.same_clock


def test_takes_without_a_common_frame_are_a_sentence() -> None:
    with pytest.raises(EditError, match="no frame in common"):
        pair(part(0, 50), part(0, 50), offset_s=9.0)
    with pytest.raises(EditError, match="no frame in common"):
        on_its_clock(part(0, 50), part(0, 50), 9.0)


@pytest.mark.parametrize("position", range(4))
def test_the_take_before_is_where_the_last_step_in_effect_put_it(tmp_path: Path, position: int) -> None:
    after, raw = part(30, 200), part(0, 220)
    found = pair(raw, after)
    from engine.review.pairing import compare_edit

    edits = [compare_edit(found, {})]
    for offset_s in (0.5, 0.25):
        weights, lost, _ = on_its_clock(raw, after, offset_s)
        edits.append(align_edit("align", weights, lost, {"offset_s": offset_s, "by": "offset"}))
    made = Contents(found.before, tuple(edits), position)
    project.create(tmp_path / "a.retake", made).close()
    read = Project.open(tmp_path / "a.retake", read_only=True).contents
    state = replay(read)
    assert state.original is not None
    offset_s = [30 / DEMO.fps, 30 / DEMO.fps, 0.5, 0.25][position]
    expected, common = on_clock_of(after, raw, offset_s)
    np.testing.assert_allclose(state.original.weights[common], expected[common], atol=1e-12)
    np.testing.assert_array_equal(state.take.weights, after.weights if position else found.before.weights)
    np.testing.assert_array_equal(state.before[2][0], edits[1].weights)
    told = paired_by(read.edits[:position])
    assert (None if told is None else told["offset_s"]) == (None if not position else pytest.approx(offset_s))


def test_a_take_before_of_another_length_is_damage(tmp_path: Path) -> None:
    from tests.engine.project.projects import sql

    found = pair(part(0, 220), part(30, 200))
    weights, lost, _ = on_its_clock(found.raw, found.after, 0.5)
    edit = align_edit("align", weights[:50], lost[:50], {})
    project.create(tmp_path / "a.retake", Contents(found.before, (edit,), 1)).close()
    with pytest.raises(EngineError, match="damaged"):
        Project.open(tmp_path / "a.retake")
    sql(tmp_path / "a.retake", "UPDATE edits SET kind = 'drag'")
    Project.open(tmp_path / "a.retake").close()
