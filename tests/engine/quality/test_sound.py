from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.quality import (
    Sound,
    flags_of,
)
from engine.quality.sound import offset_of, out_of_step, short
from tests.engine.quality.takes import (
    FPS,
    LIPS,
    found,
    looked,
    spoken,
)


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


@pytest.mark.parametrize(
    ("length_s", "offset_s", "weight"), [(20.2, 0.0, None), (20.21, 0.0, 0.2), (21.1, 0.0, 0.6), (20.1, 1.0, 0.6)]
)
def test_sound_that_goes_on_weighs_by_how_long(length_s: float, offset_s: float, weight: float | None) -> None:
    weights, opening = spoken(600)
    flags = list(short(looked(weights, sound=Sound(opening, length_s, offset_s)), 0, 600))
    assert [flag.weight for flag in flags] == ([] if weight is None else [pytest.approx(weight, abs=0.01)])
    assert all(f"{length_s + offset_s - 20:.2f} s" in flag.sentence for flag in flags)


@pytest.mark.parametrize("late", [-12, -3, 0, 3, 12])
@pytest.mark.parametrize("offset_frames", [-40, 0, 40])
def test_the_lag_between_lips_and_loudness_equals_a_plain_search(late: int, offset_frames: int) -> None:
    weights, opening = spoken(600)
    seen = looked(np.roll(weights, late, axis=0))
    heard = np.roll(opening, -offset_frames)
    sound = Sound(heard[: 600 - offset_frames] if offset_frames > 0 else heard, 20.0, offset_frames / FPS)
    found = offset_of(replace(seen, sound=sound))
    first, last = max(0, offset_frames), min(600, offset_frames + len(sound.loudness))
    lips = seen.controls[first:last, LIPS]
    loud = sound.loudness[first - offset_frames : last - offset_frames]
    loud = np.log(loud + 0.01 * loud.max())
    core = loud[18:-18]
    plain = [np.corrcoef(lips[18 + lag : len(lips) - 18 + lag], core)[0, 1] for lag in range(-18, 19)]
    assert found is not None
    assert found == pytest.approx(((int(np.argmax(plain)) - 18) / FPS, max(plain), plain[18]), abs=1e-6)
    assert found[0] == pytest.approx(late / FPS)


def test_too_little_in_common_or_no_motion_tells_nothing() -> None:
    weights, opening = spoken(600)
    assert offset_of(looked(weights)) is None
    assert offset_of(looked(weights[:299], sound=Sound(opening[:299], 10.0))) is None
    assert offset_of(looked(weights[:300], sound=Sound(opening[:300], 10.0))) is not None
    assert offset_of(looked(weights, sound=Sound(np.ones(600), 20.0))) is None
    assert offset_of(looked(np.repeat(weights[:1], 600, axis=0), sound=Sound(opening, 20.0))) is None
    assert not list(out_of_step(looked(weights), 0, 600)) and not list(short(looked(weights), 0, 600))


def test_lips_out_of_step_weigh_by_how_far_and_need_something_in_common() -> None:
    weights, opening = spoken(600)
    for late, weight in ((7, 0.2 + 0.8 * (7 / 30 - 0.08) / 0.32), (15, 1.0)):
        (flag,) = out_of_step(looked(np.roll(weights, late, axis=0), sound=Sound(opening, 20.0)), 0, 600)
        assert (flag.start, flag.stop, flag.weight) == (0, 600, pytest.approx(weight, abs=1e-6))
    noise = np.random.default_rng(3).random(600)
    assert not list(out_of_step(looked(weights, sound=Sound(noise, 20.0)), 0, 600))
