"""What a reviewer should look at: flags on frames that a tracker spoilt or an edit could not do well.

Each kind of flag is a row of `TABLE`. Most need a frame and a few beside it, so that after an edit only the frames near
it are looked at again; the others are few and cheap, and are looked for in the whole take.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from engine.quality.kinds import TABLE, Kind
from engine.quality.record import Flag, in_order
from engine.quality.seen import Seen, Sound, seen_of, sound_of
from engine.quality.settings import Dismissal, FlagSettings, dismissal_of, parted
from engine.quality.tracker import leaps, repeats
from engine.quality.tuning import TUNING, Tuning

__all__ = [
    "CLOSED_MM",
    "KINDS",
    "MISSED_MM",
    "TABLE",
    "TUNING",
    "USUAL",
    "Dismissal",
    "Flag",
    "FlagSettings",
    "Kind",
    "Seen",
    "Sound",
    "Tuning",
    "dismissal_of",
    "flags_after",
    "flags_of",
    "leaps",
    "parted",
    "repeats",
    "seen_of",
    "sound_of",
]

KINDS: dict[str, str] = {kind.name: kind.title for kind in TABLE}
CLOSED_MM, MISSED_MM = TUNING.closed_mm, TUNING.missed_mm
USUAL = FlagSettings()
Frames = tuple[int, int]


def flags_of(seen: Seen, settings: FlagSettings = USUAL) -> tuple[Flag, ...]:
    """Return every flag of a take that a project's settings count, by their first frame."""
    seen = _with(seen, settings)
    return in_order(flag for kind in TABLE if settings.counted(kind) for flag in kind.find(seen, 0, seen.length))


def flags_after(flags: Sequence[Flag], seen: Seen, touched: Frames, settings: FlagSettings = USUAL) -> tuple[Flag, ...]:
    """Return what `flags_of` would, looking again only near the frames that an edit touched, [start, stop)."""
    seen = _with(seen, settings)
    known: dict[str, list[Flag]] = {kind.name: [] for kind in TABLE}
    for flag in flags:
        known[flag.kind].append(flag)
    return in_order(
        flag for kind in TABLE if settings.counted(kind) for flag in _again(kind, known[kind.name], seen, touched)
    )


def _with(seen: Seen, settings: FlagSettings) -> Seen:
    """Return what is seen with a project's thresholds; as it is where the project sets none."""
    return replace(seen, tuning=settings.tuning) if settings.thresholds else seen


def _again(kind: Kind, known: Iterable[Flag], seen: Seen, touched: Frames) -> Iterator[Flag]:
    """Yield the flags of one kind after an edit: those away from it as they are known, those near it found again."""
    if kind.reach is None:
        yield from kind.find(seen, 0, seen.length)
        return
    reach = kind.reach(seen)
    low, high = max(0, touched[0] - reach), min(seen.length, touched[1] + reach)
    known = list(known)
    grown = True
    while grown:  # a flag that is cut in two or joined to another is looked at as a whole
        near = [flag for flag in known if flag.start <= high and flag.stop >= low]
        wider = min([low, *(flag.start for flag in near)]), max([high, *(flag.stop for flag in near)])
        grown, (low, high) = wider != (low, high), wider
    yield from (flag for flag in known if flag.stop < low or flag.start > high)
    yield from kind.find(seen, low, high)
