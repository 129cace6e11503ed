from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.controls import ALL_CONTROLS
from engine.quality import (
    TUNING,
    Seen,
)
from engine.quality.eyes import late, unblinking, unclosed
from engine.quality.seen import LIDS
from engine.take import SHAPE_INDEX, SHAPES, Array
from tests.engine.quality.takes import (
    found,
    looked,
    measure,
)


@pytest.mark.parametrize("fps", [30.0, 60.0])
def test_blinks_close_together_and_often_enough(fps: float) -> None:
    weights = np.zeros((round(40 * fps), len(SHAPES)))
    brief = round(0.2 * fps) // 2 * 2 + 1
    lids = [SHAPE_INDEX[f"eyeBlink{side}"] for side in ("Left", "Right")]
    for at_s in range(2, 38, 4):
        weights[round(at_s * fps) : round(at_s * fps) + brief, lids] = np.sin(np.linspace(0, np.pi, brief))[:, None]

    def kinds(rows: Array) -> dict[str, list[tuple[int, int]]]:
        seen = Seen(rows, measure(rows), fps, np.zeros(len(rows), bool))
        return {kind: found(seen, kind) for kind in ("unclosed", "late", "unblinking")}

    assert not any(kinds(weights).values())
    weak, late, few = weights.copy(), weights.copy(), weights.copy()
    here = slice(round(9.5 * fps), round(11 * fps))
    weak[here] *= 0.5
    late[here, lids[0]] = np.roll(late[here, lids[0]], round(0.12 * fps))
    few[round(9 * fps) : round(33 * fps)] *= 0.05
    middle = round(10 * fps) + brief // 2
    assert kinds(weak) == {"unclosed": [(middle, middle + 1)], "late": [], "unblinking": []}
    assert kinds(late)["late"] == [(middle, middle + round(0.12 * fps) + 1)]
    (start, stop), *more = kinds(few)["unblinking"]
    assert not more and stop - start > TUNING.unblinking_s * fps


def test_a_blink_that_an_edit_opens_is_flagged_even_among_weak_ones() -> None:
    before = np.zeros((300, len(SHAPES)))
    lids = [SHAPE_INDEX[f"eyeBlink{side}"] for side in ("Left", "Right")]
    for start, size in ((50, 0.5), (100, 1.0), (150, 0.5), (200, 0.5)):
        before[start : start + 5, lids] = size * np.sin(np.linspace(0, np.pi, 5))[:, None]
    after = before.copy()
    after[95:110] *= 0.5
    edited = looked(after, original_controls=measure(before))
    assert not found(looked(after), "unclosed")
    assert found(edited, "unclosed") == [(102, 103)]
    asked = np.where(np.arange(300)[:, None] // 10 == 10, edited.controls, np.nan)
    assert not found(replace(edited, asked=asked), "unclosed")


OPEN_MM = 10.0


def lids(right_mm: Array, left_mm: Array | None = None, **more: object) -> Seen:
    """What is looked at of eyes that are so far open, at 30 fps."""
    controls = np.full((len(right_mm), len(ALL_CONTROLS)), 30.0)
    controls[:, LIDS["Right"]], controls[:, LIDS["Left"]] = right_mm, right_mm if left_mm is None else left_mm
    weights = np.full((len(right_mm), len(SHAPES)), 0.3)
    return replace(Seen(weights, controls, 30.0, np.zeros(len(right_mm), bool)), **more)


def blinking(*blinks: tuple[int, float], frames: int = 300) -> Array:
    """Open eyes that blink at frames, down to so many mm."""
    gap = np.full(frames, OPEN_MM)
    for at, down_to in blinks:
        gap[at - 2 : at + 3] = [7, (7 + down_to) / 2, down_to, (7 + down_to) / 2, 7]
    return gap


def of(find: object, seen: Seen) -> list[tuple[int, int, float]]:
    return [(flag.start, flag.stop, round(flag.weight, 6)) for flag in find(seen, 0, seen.length)]  # type: ignore[operator]


SHUT = [(at, 0.5) for at in range(20, 290, 40)]


def test_a_blink_that_stays_farther_open_than_most_is_flagged_at_its_bottom() -> None:
    assert of(unclosed, lids(blinking(*SHUT, (120, 4.5)))) == [(120, 121, 0.6)]
    assert not of(unclosed, lids(blinking(*SHUT, (120, 3.4))))  # 2.9 mm more than the others
    assert of(unclosed, lids(blinking(*SHUT, (120, 3.6)))) == [(120, 121, round(0.2 + 0.8 * 0.2, 6))]
    for dip, flagged in ((4.4, False), (4.6, True)):  # of 10 mm: .45 of the way to shut
        gap = blinking(*SHUT)
        gap[120] -= dip
        assert bool(of(unclosed, lids(gap))) == flagged
    weak = [(at, 2.0) for at, _ in SHUT]
    assert not of(unclosed, lids(blinking(*weak, (120, 4.9)))) and of(unclosed, lids(blinking(*weak, (120, 5.1))))


def test_the_lid_that_is_farther_open_counts() -> None:
    both, one = blinking(*SHUT), blinking(*SHUT, (120, 4.5))
    assert of(unclosed, lids(both, one)) == [] == of(unclosed, lids(both, both))
    gap = np.maximum(one, blinking(*SHUT, (120, 0.5)))
    assert (
        of(unclosed, lids(blinking(*SHUT, (120, 0.5)), gap))
        == of(unclosed, lids(gap, blinking(*SHUT, (120, 0.5))))
        != []
    )


@pytest.mark.parametrize(("before", "after", "flagged"), [(0.0, 0.0, False), (0.3, 0.0, False), (0.15, 0.15, True)])
def test_lids_that_fall_with_the_gaze_do_not_blink(before: float, after: float, flagged: bool) -> None:
    seen = lids(blinking(*SHUT, (120, 4.5)))
    weights = seen.weights.copy()
    for side in LIDS:
        weights[:, SHAPE_INDEX[f"eyeLookDown{side}"]] = 0.0
    weights[:120, SHAPE_INDEX["eyeLookDownLeft"]], weights[120, SHAPE_INDEX["eyeLookDownLeft"]] = before, 0.3
    weights[121:, SHAPE_INDEX["eyeLookDownLeft"]] = after
    assert bool(of(unclosed, replace(seen, weights=weights))) == flagged


def test_a_blink_that_was_shut_before_the_edits_counts_unless_the_lids_were_asked_for() -> None:
    weak = [(at, 4.0) for at, _ in SHUT]
    seen = lids(blinking(*weak, (120, 4.0)), original_controls=lids(blinking(*weak, (120, 1.0))).controls)
    assert of(unclosed, seen) == [(120, 121, round(0.2 + 0.8 / 3, 6))]
    assert not of(unclosed, replace(seen, original_controls=lids(blinking(*weak, (120, 1.6))).controls))
    assert not of(unclosed, replace(seen, original_controls=lids(np.full(300, 1.0)).controls))
    for side in LIDS:
        asked = np.full_like(seen.controls, np.nan)
        asked[120, LIDS[side]] = 4.0
        assert not of(unclosed, replace(seen, asked=asked))
    elsewhere = np.where(np.arange(seen.controls.shape[1]) == 0, seen.controls, np.nan)
    assert of(unclosed, replace(seen, asked=elsewhere)) != []
    assert not of(unclosed, replace(seen, lost=np.arange(300) == 120))
    moved = replace(seen, controls=lids(blinking(*weak, (122, 2.0))).controls)
    assert not of(unclosed, moved) and of(unclosed, replace(seen, controls=lids(blinking(*weak, (123, 2.0))).controls))


@pytest.mark.parametrize(("by", "flagged"), [(1, False), (2, True), (-2, True), (6, True), (10, True), (11, False)])
def test_one_eye_is_late_by_more_than_two_frames_and_less_than_another_blink(by: int, flagged: bool) -> None:
    flags = of(late, lids(blinking((100, 0.5)), blinking((100 + by, 0.5))))
    first, last = min(100, 100 + by), max(100, 100 + by) + 1
    expected = [(first, last, round(min(1.0, 0.2 + 0.8 * (abs(by) / 30 - 0.06) / 0.14), 6))]
    assert flags == expected * flagged
    assert not of(late, lids(blinking((100, 0.5)), blinking((100 + by, 0.5)), lost=np.arange(300) == 100))


def test_each_bottom_goes_with_the_nearest_of_the_other_eye() -> None:
    ones, others = blinking((100, 0.5), (140, 0.5)), blinking((104, 0.5), (143, 0.5))
    assert [flag[:2] for flag in of(late, lids(ones, others))] == [(100, 105), (140, 144)]
    assert not of(late, lids(ones, blinking()))


@pytest.mark.parametrize(("frames", "flagged"), [(600, False), (601, True)])
def test_a_stretch_without_a_blink_is_flagged_once_it_is_long(frames: int, flagged: bool) -> None:
    total = 50 + 1 + frames + 1 + 50
    gap = blinking((50, 0.5), (51 + frames, 0.5), frames=total)
    flags = of(unblinking, lids(gap))
    assert [flag[:2] for flag in flags] == [(51, 51 + frames)] * flagged
    assert not of(unblinking, lids(gap, lost=np.arange(total) == 300))
    still_eyes = lids(gap)
    assert not of(unblinking, replace(still_eyes, weights=still_eyes.weights * 0))


def test_no_blink_at_all_weighs_by_how_long_the_take_is() -> None:
    assert of(unblinking, lids(np.full(1200, 9.0))) == [(0, 1200, 0.6)]
    assert "for 40 s" in next(iter(unblinking(lids(np.full(1200, 9.0)), 0, 1200))).sentence
