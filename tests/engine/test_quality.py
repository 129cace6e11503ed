from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.anatomy import EXCLUSIVE, pairs
from engine.controls import CONTROL_INDEX
from engine.errors import AssetError
from engine.extended import bundled_face
from engine.formats import read_take
from engine.formats.audio import Audio
from engine.formats.livelink.sides import exchange
from engine.lab.performer import demo
from engine.quality import (
    CLOSED_MM,
    KINDS,
    MISSED_MM,
    TABLE,
    TUNING,
    FlagSettings,
    Seen,
    Sound,
    flags_after,
    flags_of,
    leaps,
    repeats,
    seen_of,
    sound_of,
)
from engine.speech.lane import attached
from engine.speech.visemes import Cue
from engine.take import SHAPE_INDEX, SHAPES, Array, runs

FPS = 30.0
measure = bundled_face().measure
EVERY = FlagSettings(counts={name: True for name in KINDS})
SAID = ["M", "AA1", "B", "P", "IY", "M", "V", "B", "F", "M", "P", "B"]
STEADY = [i for i, name in enumerate(SHAPES) if name.startswith(("brow", "cheek", "nose"))]
CLOSED_FACE = {"jawOpen": 0.0, "mouthClose": 0.3, "mouthShrugLower": 1.0, "mouthRollUpper": 1.0}
CLOSED = [SHAPE_INDEX[name] for name in CLOSED_FACE]
WHOLE = {"swapped", "unblinking", "short", "sound"}  # need a longer take, or sound: each has a test of its own
LIPS, JAW = CONTROL_INDEX["lips_vertical"], SHAPE_INDEX["jawOpen"]


def troubled(seed: int, frames: int = 420) -> Seen:
    """A slow random performance with every fault in it."""
    rng = np.random.default_rng(seed)
    knots = rng.random((frames // 12 + 2, len(SHAPES))) * rng.random(len(SHAPES))
    at = np.linspace(0, len(knots) - 1.001, frames)
    low = at.astype(int)
    weights = knots[low] + (at - low)[:, None] * (knots[low + 1] - knots[low])
    weights[rng.integers(1, frames - 1, 4), rng.integers(0, len(SHAPES), 4)] += 0.5
    weights[rng.integers(1, frames) :, int(rng.choice(STEADY))] += 0.4
    begin = int(rng.integers(0, frames - 40))
    weights[begin : begin + 40, SHAPE_INDEX["browInnerUp"]] += rng.normal(0, 0.1, 40)
    weights[60:70] = 0.0
    weights[60:70, CLOSED] = list(CLOSED_FACE.values())
    _blink(weights, rng)
    for start in rng.integers(0, frames - 9, 3):
        weights[start : start + rng.integers(2, 8)] = weights[start]
    lost = np.zeros(frames, bool)
    lost[frames // 2 : frames // 2 + 5] = True
    before = weights.copy()
    before[100:160] = np.clip(weights[100:160] - rng.random((60, len(SHAPES))) * 0.4, 0, 1)
    original = measure(np.clip(weights - rng.random(weights.shape) * 0.4, 0, 1))
    cues = [Cue(start, start + 0.1, label) for start, label in zip(rng.random(12) * 14, SAID, strict=True)]
    turned = np.cumsum(rng.normal(0, 0.01, (frames, 3)), axis=0)
    turned[rng.integers(5, frames) :, 1] += 0.4
    seen = Seen(weights, measure(weights), FPS, lost, None, original, attached(cues, "t"), before, turned)
    return with_weights(seen, weights)


def _blink(weights: Array, rng: np.random.Generator) -> None:
    """Put in blinks: most close, some do not, some with one eye late; between them the lids are at rest."""
    weights[:, [i for i, name in enumerate(SHAPES) if name.startswith("eye")]] = 0.0
    for number, start in enumerate(range(10, len(weights) - 20, 40)):
        late = 4 if number == 3 else 0
        size = 0.5 if number == 7 else 1.0
        for side, shift in (("Left", 0), ("Right", late)):
            weights[start + shift : start + shift + 5, SHAPE_INDEX[f"eyeBlink{side}"]] = size * np.sin(
                np.linspace(0, np.pi, 5)
            )


def with_weights(seen: Seen, weights: Array) -> Seen:
    controls = measure(weights)
    wave = np.sin(np.arange(controls.shape[1])) * 4
    asked = np.where(np.arange(len(weights))[:, None] % 40 < 9, controls + wave, np.nan)
    return replace(seen, weights=weights, controls=controls, asked=asked)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 20), st.integers(0, 418), st.integers(1, 30), st.sampled_from(["still", "noise", "jump", "lost"]))
def test_looking_again_near_an_edit_finds_what_looking_at_everything_does(
    seed: int, start: int, length: int, edit: str
) -> None:
    before = troubled(seed)
    flags = flags_of(before, EVERY)
    stop = min(len(before.weights), start + length)
    weights, lost = before.weights.copy(), before.lost.copy()
    if edit == "still":
        weights[start:stop] = weights[max(0, start - 1)]
    elif edit == "noise":
        weights[start:stop] = np.random.default_rng(seed).random((stop - start, len(SHAPES)))
    elif edit == "jump":
        weights[start:stop] += 0.4
    else:
        lost[start:stop] ^= True
    after = with_weights(replace(before, lost=lost), weights)
    assert flags_after(flags, after, (start, stop), EVERY) == flags_of(after, EVERY)


def test_a_troubled_take_has_every_kind_of_flag_and_each_is_told() -> None:
    found = [flag for seed in range(8) for flag in flags_of(troubled(seed), EVERY)]
    assert {flag.kind for flag in found} == set(KINDS) - WHOLE
    assert all(flag.start < flag.stop and 0 < flag.weight <= 1 and flag.sentence.endswith(".") for flag in found)


def test_each_kind_is_where_a_plain_rule_says() -> None:
    seen = troubled(3)
    frames = range(len(seen.weights))
    found = {kind: [(f.start, f.stop) for f in flags_of(seen) if f.kind == kind] for kind in KINDS}
    assert found["lost"] == runs(seen.lost)
    wide = np.array([EXCLUSIVE[row][1] == "mouthStretch" for *_, row in pairs()])
    both = np.array([np.minimum(seen.weights[:, a], seen.weights[:, b]) for a, b, _ in pairs()])
    assert found["impossible"] == runs((both > np.where(wide, TUNING.both_wide, TUNING.both)[:, None]).any(axis=0))
    most = np.array([TUNING.most_gaze if name.startswith("eyeLook") else TUNING.most_weight for name in SHAPES])
    beyond = (seen.weights < TUNING.least_weight) | (seen.weights > most)
    assert found["range"] == runs(beyond.any(axis=1) & ~seen.lost)
    same = [
        i > 0 and not seen.lost[i - 1 : i + 1].any() and (seen.weights[i] == seen.weights[i - 1]).all() for i in frames
    ]
    assert found["frozen"] == [run for run in runs(np.array(same)) if run[1] - run[0] >= 5]  # .15 s at 30 fps
    for start, stop in found["missed"]:
        away = np.abs(seen.asked[start:stop] - seen.controls[start:stop])
        assert (away > MISSED_MM).all(axis=0).any()


def test_a_leap_that_returns_is_a_spike_and_one_that_stays_is_none() -> None:
    weights = np.tile(np.linspace(0, 0.2, 30)[:, None], (1, len(SHAPES)))
    kept = np.ones(30, bool)
    assert not leaps(weights, kept).any()
    weights[10, JAW] += 0.3
    assert np.flatnonzero(leaps(weights, kept)).tolist() == [10]
    kept[11] = False
    assert not leaps(weights, kept).any()
    weights[10:, JAW] += 0.3
    weights[10, JAW] -= 0.3
    assert not leaps(weights, np.ones(30, bool)).any()
    assert not repeats(weights, np.ones(30, bool)).any()


def test_lips_that_are_told_to_meet_are_flagged_until_they_do() -> None:
    take = read_take(demo.BUNDLED)
    lips = measure(take.weights)[:, LIPS]
    wide = int(np.argmax(np.where(take.lost, -1, lips)))
    lane = attached([Cue((wide - 1) / take.fps, (wide + 2) / take.fps, "B")], "t")
    nothing = np.zeros(len(take), bool)
    seen = Seen(take.weights, measure(take.weights), take.fps, nothing, visemes=lane)
    (flag,) = [flag for flag in flags_of(seen) if flag.kind == "open"]
    assert (flag.start, flag.stop) == (wide - 1, wide + 2) and "where B is said" in flag.sentence
    shut = seen.controls.copy()
    shut[wide, LIPS] = CLOSED_MM / 2
    assert not [flag for flag in flags_of(replace(seen, controls=shut)) if flag.kind == "open"]


def test_lips_that_an_edit_parts_are_flagged_unless_that_was_asked() -> None:
    take = read_take(demo.BUNDLED)
    original = measure(take.weights)
    start, stop = next(
        run for run in runs(original[:, LIPS] < CLOSED_MM) if run[1] - run[0] < 8 and not take.lost[slice(*run)].any()
    )
    weights = take.weights.copy()
    weights[start:stop, JAW] += 0.5
    seen = Seen(weights, measure(weights), take.fps, take.lost, original_controls=original)
    opened = [flag for flag in flags_of(seen) if flag.kind == "open"]
    assert [(flag.start, flag.stop) for flag in opened] == [(start, stop)]
    asked = np.full_like(original, np.nan)
    asked[start:stop, LIPS] = seen.controls[start:stop, LIPS]
    assert not [flag for flag in flags_of(replace(seen, asked=asked)) if flag.kind == "open"]


def test_a_lost_frame_that_was_filled_is_not_flagged() -> None:
    take = read_take(demo.BUNDLED)
    (start, stop), *_ = runs(take.lost)
    filled = take.with_rows(start, take.weights[start:stop] + 0.01)
    assert "lost" in {flag.kind for flag in flags_of(seen_of(take, take))}
    assert "lost" not in {flag.kind for flag in flags_of(seen_of(filled, take))}


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_the_shortest_takes_are_looked_at(frames: int) -> None:
    weights = np.zeros((frames, len(SHAPES)))
    seen = Seen(weights, measure(weights), 30.0, np.zeros(frames, bool))
    assert all(flag.kind == "frozen" for flag in flags_of(seen))


def still(frames: int = 300) -> Array:
    """A face that moves a little, smoothly and alike on both sides, as no tracker fault does."""
    time_s = np.arange(frames) / FPS
    return 0.3 + 0.05 * np.sin(2 * np.pi * 0.7 * time_s)[:, None] * np.ones(len(SHAPES))


def looked(weights: Array, **more: object) -> Seen:
    return replace(Seen(weights, measure(weights), FPS, np.zeros(len(weights), bool)), **more)


def found(seen: Seen, kind: str) -> list[tuple[int, int]]:
    return [(flag.start, flag.stop) for flag in flags_of(seen, EVERY) if flag.kind == kind]


def test_a_kind_tells_its_name_its_threshold_and_its_reach() -> None:
    assert len({kind.name for kind in TABLE}) == len(TABLE) == len(KINDS)
    for kind in TABLE:
        assert kind.title and kind.threshold
        assert kind.reach is None or kind.reach(looked(still())) >= 1


def test_a_peak_of_three_frames_is_an_articulation_and_no_spike() -> None:
    weights = still()
    weights[100:103, JAW] += [0.2, 0.4, 0.2]
    assert not found(looked(weights), "spike")
    weights[101, JAW] += 0.5
    assert found(looked(weights), "spike") == [(101, 102)]


def test_a_face_at_rest_is_not_frozen_and_one_that_holds_is() -> None:
    weights = still()
    weights[50:60] = 0.0
    weights[100:110] = weights[100]
    assert found(looked(weights), "frozen") == [(101, 110)]


def test_trembling_is_flagged_over_its_stretches_and_one_spike_is_none() -> None:
    weights = still()
    weights[40, JAW] += 0.5
    assert not found(looked(weights), "jitter")
    weights[90:150, JAW] += 0.05 * (-1.0) ** np.arange(60)
    assert found(looked(weights), "jitter") == [(90, 150)]


def test_a_step_that_stays_is_a_pop_except_for_eyes_and_tongue() -> None:
    weights = still()
    weights[120:, SHAPE_INDEX["mouthFunnel"]] += 0.3
    weights[200:, SHAPE_INDEX["eyeLookInLeft"]] += 0.5
    weights[220:, SHAPE_INDEX["tongueOut"]] += 0.5
    assert found(looked(weights), "pop") == [(120, 121)]


def test_a_head_that_turns_fast_is_fine_and_one_that_jumps_is_not() -> None:
    turned = np.radians(25 * np.sin(2 * np.pi * 1.5 * np.arange(300) / FPS))[:, None] * np.ones(3)
    assert not found(looked(still(), rotations=turned), "head")
    turned[150:] += np.radians([0.0, 12.0, 0.0])
    assert found(looked(still(), rotations=turned), "head") == [(150, 151)]
    assert not found(looked(still()), "head")


def test_mouth_close_above_the_jaw_is_flagged() -> None:
    weights = still()
    weights[70:80, SHAPE_INDEX["mouthClose"]] = weights[70:80, JAW] + 0.3
    assert found(looked(weights), "close") == [(70, 80)]


def test_lips_that_pass_through_each_other_are_flagged() -> None:
    weights = still()
    weights[70:80] = 0.0
    weights[70:80, CLOSED] = list(CLOSED_FACE.values())
    assert found(looked(weights), "through") == [(70, 80)]


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


def test_exchanged_sides_are_flagged() -> None:
    rng = np.random.default_rng(0)
    weights = still(600)
    way = np.convolve(rng.normal(0, 1, 650), np.ones(51) / 7, "valid")
    for shape in ("mouth", "mouthDimple", "mouthStretch", "cheekSquint", "mouthUpperUp"):
        weights[:, SHAPE_INDEX[f"{shape}Left"]] = 0.2 + 0.1 * np.clip(way, 0, 2)
        weights[:, SHAPE_INDEX[f"{shape}Right"]] = 0.2 + 0.1 * np.clip(-way, 0, 2)
    assert not found(looked(weights), "swapped")
    assert found(looked(exchange(weights)), "swapped") == [(0, 600)]


def test_a_lip_that_leaves_the_teeth_is_flagged() -> None:
    weights = np.zeros((90, len(SHAPES)))
    weights[:, JAW] = 0.6
    lane = attached([Cue(1.0, 1.2, "F")], "t")
    assert found(looked(weights, visemes=lane), "teeth") == [(30, 36)]
    weights[32:34, JAW] = 0.0
    assert not found(looked(weights, visemes=lane), "teeth")


def test_an_edit_with_hard_borders_shows_and_an_eased_one_does_not() -> None:
    before = still()
    eased, hard, kinked = before.copy(), before.copy(), before.copy()
    eased[100:160, JAW] += 0.3 * np.sin(np.linspace(0, np.pi, 60)) ** 2
    hard[100:160, JAW] += 0.3
    kinked[100:160, JAW] += 0.5 * (1 - np.abs(np.linspace(-1, 1, 62)[1:-1])) * 2
    assert not found(looked(eased, original_weights=before), "seam")
    assert found(looked(hard, original_weights=before), "seam") == [(100, 101), (160, 161)]
    kinked[100:104, JAW] = before[100:104, JAW] + [0.05, 0.3, 0.55, 0.5]
    assert (100, 101) in found(looked(kinked, original_weights=before), "seam")
    assert not found(looked(hard), "seam")


def spoken(frames: int) -> tuple[Array, Array]:
    """A mouth that opens and closes at random, and how loud that is."""
    rng = np.random.default_rng(1)
    opening = np.clip(np.convolve(rng.normal(0, 1, frames + 8), np.ones(9) / 5, "valid"), 0, 1)
    weights = still(frames)
    weights[:, JAW] = 0.5 * opening
    return weights, opening


@pytest.mark.parametrize("late", [-9, 0, 2, 6])
def test_lips_out_of_step_with_the_sound_are_flagged(late: int) -> None:
    weights, opening = spoken(600)
    seen = looked(np.roll(weights, late, axis=0), sound=Sound(opening, 20.0))
    flags = [flag for flag in flags_of(seen) if flag.kind == "sound"]
    if abs(late) < 3:
        assert not flags
    else:
        (flag,) = flags
        assert f"{abs(late) / FPS:.2f} s {'after' if late > 0 else 'before'} the sound" in flag.sentence


def test_a_take_that_ends_before_its_sound_is_flagged() -> None:
    weights, opening = spoken(600)
    assert not found(looked(weights, sound=Sound(opening, 20.1)), "short")
    assert found(looked(weights, sound=Sound(opening, 20.1, offset_s=1.0)), "short") == [(599, 600)]


def test_loudness_is_measured_once_a_frame() -> None:
    samples = np.zeros(16_000, np.float32)
    samples[8_000:9_600] = 0.5  # from 0.5 s to 0.6 s
    sound = sound_of(Audio(samples, 16_000), fps=50.0, offset_s=2.0)
    assert sound.duration_s == 1.0 and sound.offset_s == 2.0 and len(sound.loudness) == 50
    assert np.flatnonzero(sound.loudness > 0.4).tolist() == [25, 26, 27, 28, 29]


def test_gaze_may_go_a_little_beyond_one_as_trackers_report_it() -> None:
    weights = still()
    weights[50:60, SHAPE_INDEX["eyeLookInRight"]] = 1.08
    weights[80:90, SHAPE_INDEX["mouthLeft"]] = 1.08
    weights[120:130, SHAPE_INDEX["eyeLookInRight"]] = 1.2
    assert found(looked(weights), "range") == [(80, 90), (120, 130)]


def test_lips_that_are_rounded_and_wide_may_go_as_far_as_people_did() -> None:
    weights = still() * 0.1
    for start, strength in ((50, 0.56), (100, 0.7)):
        for name in ("mouthFunnel", "mouthStretchLeft", "mouthStretchRight"):
            weights[start : start + 10, SHAPE_INDEX[name]] = strength
    weights[150:160, [SHAPE_INDEX["mouthSmileLeft"], SHAPE_INDEX["mouthFrownLeft"]]] = 0.56
    assert found(looked(weights), "impossible") == [(100, 110), (150, 160)]


@pytest.mark.parametrize(("fps", "held", "frozen"), [(30.0, 4, 0), (30.0, 5, 1), (60.0, 8, 0), (60.0, 9, 1)])
def test_a_pose_is_frozen_when_it_is_held_for_long_enough_at_any_rate(fps: float, held: int, frozen: int) -> None:
    weights = still()
    weights[100 : 100 + held] = weights[99]
    assert len(found(replace(looked(weights), fps=fps), "frozen")) == frozen


def test_a_mouth_that_nobody_was_recorded_to_make_is_flagged_and_a_missing_prior_takes_no_other_flag_away(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    weights = still() * 0.3
    names = ("mouthStretchLeft", "mouthStretchRight", "mouthFrownLeft", "mouthLeft", "mouthUpperUpRight", "jawOpen")
    weights[60:70, [SHAPE_INDEX[name] for name in names]] = 1.0
    assert found(looked(weights), "unlike") == [(60, 70)]
    text = next(flag.sentence for flag in flags_of(looked(weights), EVERY) if flag.kind == "unlike")
    assert "further from its mean pose than all 4,000 recorded faces" in text

    def missing() -> None:
        raise AssetError("The model file is missing.", "Train it.")

    monkeypatch.setattr("engine.quality.shape.recorded", missing)
    weights[200, JAW] += 0.5
    assert not found(looked(weights), "unlike") and found(looked(weights), "spike") == [(200, 201)]
