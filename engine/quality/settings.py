"""Which kinds of flags count in a project, from which thresholds, and which findings a person has dismissed."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from engine.errors import EditError
from engine.quality.kinds import TABLE, Kind, Threshold
from engine.quality.record import Flag
from engine.quality.tuning import TUNING, Tuning

BY_NAME: dict[str, Kind] = {kind.name: kind for kind in TABLE}
HEAVIER = 0.1  # weight by which a finding may grow and is still the one that was dismissed
COVERED = 0.5  # share of a finding's frames that a dismissal must cover
_NUMBERS = re.compile(r"[-+−]?\d[\d.,]*")


@dataclass(frozen=True)
class FlagSettings:
    """What is looked for; kinds that this program does not know are kept and change nothing.

    Attributes
    ----------
    counts : whether a kind is looked for, by its name; others as `Kind.on` says
    thresholds : from where on a kind is flagged, by its name, in the unit of its `Threshold`
    """

    counts: Mapping[str, bool] = field(default_factory=dict)
    thresholds: Mapping[str, float] = field(default_factory=dict)

    def counted(self, kind: Kind) -> bool:
        """Return whether a kind is looked for."""
        return self.counts.get(kind.name, kind.on)

    @property
    def tuning(self) -> Tuning:
        """The constants of the detectors with these thresholds in place, each within its limits."""
        own = {
            threshold.name: type(getattr(TUNING, threshold.name))(threshold.within(self.thresholds[name]))
            for name, threshold in _thresholds().items()
            if name in self.thresholds
        }
        return replace(TUNING, **own)

    def threshold(self, name: str) -> float:
        """Return the threshold in effect of a kind that has one."""
        return float(getattr(self.tuning, _thresholds()[name].name))

    def with_count(self, name: str, *, on: bool) -> FlagSettings:
        """Return the same with a kind looked for, or not."""
        counts = {other: of_kind for other, of_kind in self.counts.items() if other != name}
        return replace(self, counts=counts if BY_NAME[name].on == on else {**counts, name: on})

    def with_threshold(self, name: str, value: float) -> FlagSettings:
        """Return the same with another threshold of a kind.

        Raises `EditError` for a kind without one, and for a value that is no number or beyond its limits.
        """
        threshold = _thresholds().get(name)
        if threshold is None:
            known = ", ".join(_thresholds())
            raise EditError(f"{name} has no threshold to set.", f"Thresholds belong to: {known}.")
        if not (math.isfinite(value) and threshold.lowest <= value <= threshold.highest):
            limits = f"{threshold.lowest:g} to {threshold.highest:g} {threshold.unit}".strip()
            raise EditError(f"{value:g} is no threshold for {name}.", f"It goes from {limits}.")
        others = {other: of_kind for other, of_kind in self.thresholds.items() if other != name}
        usual = math.isclose(value, float(getattr(TUNING, threshold.name)))
        return replace(self, thresholds=others if usual else {**others, name: float(value)})


@dataclass(frozen=True)
class Dismissal:
    """A finding that somebody looked at and does not mind.

    Attributes
    ----------
    kind, start, stop, weight, sentence : of the flag
    author, time : who and when, ISO 8601 with its zone
    why : in their words
    """

    kind: str
    start: int
    stop: int
    weight: float
    sentence: str
    author: str
    time: str
    why: str

    def covers(self, flag: Flag) -> bool:
        """Return whether a flag is the one that was dismissed: kind, words and frames alike, and not much heavier."""
        if flag.kind != self.kind or flag.weight > self.weight + HEAVIER:
            return False
        shared = min(flag.stop, self.stop) - max(flag.start, self.start)
        return shared >= COVERED * (flag.stop - flag.start) and wording(flag.sentence) == wording(self.sentence)


def dismissal_of(flag: Flag, dismissals: Iterable[Dismissal]) -> Dismissal | None:
    """Return who dismissed a flag, None where nobody did."""
    return next((each for each in dismissals if each.covers(flag)), None)


def parted(flags: Iterable[Flag], dismissals: Iterable[Dismissal]) -> tuple[tuple[Flag, ...], tuple[Flag, ...]]:
    """Return the flags that count, and those that were dismissed."""
    of_kind: dict[str, list[Dismissal]] = {}
    for each in dismissals:
        of_kind.setdefault(each.kind, []).append(each)
    counting: list[Flag] = []
    dismissed: list[Flag] = []
    for flag in flags:
        (counting if dismissal_of(flag, of_kind.get(flag.kind, ())) is None else dismissed).append(flag)
    return tuple(counting), tuple(dismissed)


def wording(sentence: str) -> str:
    """Return a sentence without its numbers, which change with every edit."""
    return _NUMBERS.sub("#", sentence)


def _thresholds() -> dict[str, Threshold]:
    return {kind.name: kind.setting for kind in TABLE if kind.setting is not None}
