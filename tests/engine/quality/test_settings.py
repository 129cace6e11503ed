"""A project's own thresholds and kinds, and findings that stay dismissed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.errors import EditError
from engine.quality import TABLE, TUNING, Dismissal, Flag, FlagSettings, flags_after, flags_of, parted
from tests.engine.test_quality import troubled

SETTABLE = [kind for kind in TABLE if kind.setting is not None]


@pytest.mark.parametrize("kind", SETTABLE, ids=lambda kind: kind.name)
def test_a_threshold_is_the_field_that_the_detector_reads_and_its_usual_value_is_within_its_limits(kind) -> None:
    usual = getattr(TUNING, kind.setting.name)
    assert kind.setting.lowest <= usual <= kind.setting.highest
    settings = FlagSettings().with_threshold(kind.name, kind.setting.highest)
    assert getattr(settings.tuning, kind.setting.name) == kind.setting.highest
    assert settings.with_threshold(kind.name, usual) == FlagSettings()


@pytest.mark.parametrize("kind", [kind for kind in SETTABLE if kind.name != "range"], ids=lambda kind: kind.name)
def test_a_higher_threshold_flags_no_frame_that_a_lower_one_does_not(kind) -> None:
    seen = troubled(2)
    low, high = (
        flags_of(seen, FlagSettings().with_threshold(kind.name, end))
        for end in (kind.setting.lowest, kind.setting.highest)
    )
    frames = [
        {frame for flag in flags if flag.kind == kind.name for frame in range(flag.start, flag.stop)}
        for flags in (low, high)
    ]
    assert frames[1] <= frames[0]
    others = [[flag for flag in flags if flag.kind != kind.name] for flags in (low, high)]
    assert others[0] == others[1]


def test_a_lower_threshold_finds_more_lips_that_stay_open() -> None:
    few = flags_of(troubled(1), FlagSettings(thresholds={"open": 6.0}))
    many = flags_of(troubled(1), FlagSettings(thresholds={"open": 0.5}))
    assert sum(flag.kind == "open" for flag in many) > sum(flag.kind == "open" for flag in few)


def test_a_kind_that_does_not_count_is_not_looked_for_and_all_others_are() -> None:
    seen = troubled(0)
    usual = flags_of(seen)
    without = flags_of(seen, FlagSettings().with_count("lost", on=False))
    assert any(flag.kind == "lost" for flag in usual)
    assert without == tuple(flag for flag in usual if flag.kind != "lost")
    assert FlagSettings().with_count("lost", on=False).with_count("lost", on=True) == FlagSettings()


def test_looking_again_after_an_edit_keeps_to_the_settings() -> None:
    seen = troubled(4)
    settings = FlagSettings({"lost": False}, {"spike": 0.3, "open": 5.0, "frozen": 5})
    edited = replace(seen, weights=seen.weights.copy())
    edited.weights[100:110] += 0.3
    assert flags_after(flags_of(seen, settings), edited, (100, 110), settings) == flags_of(edited, settings)


@pytest.mark.parametrize(("kind", "value"), [("open", 0.0), ("open", float("nan")), ("open", 9e9), ("lost", 1.0)])
def test_a_threshold_that_cannot_be_is_refused_with_its_limits(kind: str, value: float) -> None:
    with pytest.raises(EditError):
        FlagSettings().with_threshold(kind, value)


def test_settings_of_a_later_program_are_kept_and_change_nothing() -> None:
    seen = troubled(0)
    assert flags_of(seen, FlagSettings({"of a later one": False}, {"another": 3.0, "open": 2.0})) == flags_of(seen)


def dismissed(flag: Flag) -> Dismissal:
    return Dismissal(flag.kind, flag.start, flag.stop, flag.weight, flag.sentence, "Ana", "2025", "a squint")


def test_a_dismissed_finding_stays_dismissed_until_it_is_worse_or_elsewhere_or_another() -> None:
    flag = Flag("missed", 10, 20, 0.5, "Lips apart: 3.0 mm was asked for, a plausible face gets to 1.2 mm.")
    held = (dismissed(flag),)
    assert parted([flag], held) == ((), (flag,))
    nearly = replace(flag, start=12, stop=22, weight=0.55, sentence=flag.sentence.replace("1.2", "-1.4"))
    assert parted([nearly], held) == ((), (nearly,))
    for other in (
        replace(flag, weight=0.7),
        replace(flag, start=30, stop=40),
        replace(flag, start=10, stop=60),
        replace(flag, kind="open"),
        replace(flag, sentence="Mouth width: 3.0 mm was asked for, a plausible face gets to 1.2 mm."),
    ):
        assert parted([other], held) == ((other,), ())


def test_all_that_are_dismissed_are_and_no_other() -> None:
    flags = flags_of(troubled(3))
    counting, gone = parted(flags, [dismissed(flag) for flag in flags[::2]])
    assert set(flags[::2]) <= set(gone)
    assert sorted((*counting, *gone), key=flags.index) == list(flags)
