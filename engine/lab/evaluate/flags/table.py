"""Flags against planted faults: recall and precision of each kind, and false flags on takes as they were recorded."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from scipy.stats import binomtest, chi2

from engine.extended import bundled_face
from engine.formats import audio
from engine.lab.corpus import TEST, data_folder, load_takes
from engine.lab.evaluate.flags.planting import Planted
from engine.lab.evaluate.flags.plants import PLANTS
from engine.lab.reporting import Report, Row
from engine.quality import KINDS, TABLE, USUAL, Flag, FlagSettings, Seen, Sound, flags_of, sound_of
from engine.take import Take

EACH = 15  # planted faults of every kind: 315 in all
EXCERPT_S = 12.0
LONG_S = {"swapped": 60.0, "unblinking": 60.0, "unclosed": 60.0, "short": 40.0, "sound": 40.0}  # instead, for these
TRIES = 60  # excerpts that are tried for each
WHOLE = ("swapped", "sound")  # their flags cover the take, so that they lie on any plant
TOLERANCE_S = 0.1
OTHERS = ("slate_3",)  # recorded, of another person and rate, and never tuned on: measured beside the test split
SEED = 18
EVERY_KIND = FlagSettings(counts={kind.name: True for kind in TABLE})


@dataclass(frozen=True, eq=False)
class Source:
    """A recorded take that excerpts are cut from; the sound is its own, where there is one."""

    name: str
    take: Take
    rotations: np.ndarray
    sound: Sound | None


def table(data: Path | None, report: Report) -> list[Row]:
    """Return a row for each kind of flag, one for all that are looked for by themselves, and one for each take.

    A kind's row has its threshold, the recall and precision on plants, and how often a minute it comes in takes as they
    were recorded; shares and rates have their 95 % intervals.

    Each fault is planted alone into an excerpt. It is found where a flag of its kind touches its frames. A flag is right
    where it touches a plant of its kind, wrong where it touches none; one of another kind that lies on a plant is what
    the plant did beside, and counts as neither. No take here records the head: it turns as a smooth random one would.
    """
    sources = list(_sources(data))
    counts = _counted(sources, report)
    unplanted = _unplanted(sources)
    minutes = sum(source.take.duration_s for source in sources) / 60 or np.nan
    rows = [
        counts.row(kind.name, (kind.name,))
        | _per_minute("false_per_min", unplanted.counts[kind.name], minutes)
        | {"threshold": kind.threshold}
        for kind in TABLE
    ]
    usual = [kind.name for kind in TABLE if kind.on]
    return [*rows, counts.row("all", usual), *unplanted.rows]


@dataclass
class _Counts:
    """What became of the plants, by kind: found, planted, flags that are right and wrong, and whose takes they are in."""

    found: Counter[str] = field(default_factory=Counter)
    planted: Counter[str] = field(default_factory=Counter)
    right: Counter[str] = field(default_factory=Counter)
    wrong: Counter[str] = field(default_factory=Counter)
    people: dict[str, set[str]] = field(default_factory=lambda: {kind: set() for kind in KINDS})

    def row(self, name: str, kinds: Iterable[str]) -> Row:
        """Return the row of some kinds together."""
        listed = list(kinds)
        return _row(
            name,
            set().union(*(self.people[kind] for kind in listed)),
            found=sum(self.found[kind] for kind in listed),
            planted=sum(self.planted[kind] for kind in listed),
            right=sum(self.right[kind] for kind in listed),
            wrong=sum(self.wrong[kind] for kind in listed),
        )


def _counted(sources: list[Source], report: Report) -> _Counts:
    """Plant faults of every kind, look for flags, and count."""
    counts = _Counts()
    for kind in KINDS:
        for seen, plant, name in _planted(kind, sources):
            counts.planted[kind] += 1
            counts.people[kind].add(name)
            flags = flags_of(plant.seen, USUAL.with_count(kind, on=True))
            tolerance = seen.frames(TOLERANCE_S)
            counts.found[kind] += any(flag.kind == kind and _touches(flag, plant, tolerance) for flag in flags)
            for flag in flags:
                on = _touches(flag, plant, tolerance) and not (flag.kind in WHOLE and flag.kind != kind)
                counts.right[flag.kind] += on and flag.kind == kind
                counts.wrong[flag.kind] += not on
        report(f"{kind}: {counts.found[kind]} of {counts.planted[kind]} found")
    return counts


def _sources(data: Path | None) -> Iterator[Source]:
    rng = np.random.default_rng(SEED)
    folder = data or data_folder()
    for take, _ in load_takes(folder):
        name = Path(take.name).stem
        if data is None and name not in (*TEST, *OTHERS):
            continue
        beside = next(iter(sorted(folder.rglob(f"{name}.wav"))), None)
        heard = sound_of(audio.read(beside), fps=take.fps) if beside else None
        yield Source(name, take, _turning(len(take), take.fps, rng), heard)


def _turning(frames: int, fps: float, rng: np.random.Generator) -> np.ndarray:
    """Return a head, (frames, 3) radians, that turns to another random place (10 degrees rms) each half second."""
    knots = int(frames / fps * 2) + 4
    places = np.radians(rng.normal(0, 10, (knots, 3)))
    at = np.arange(frames) / fps * 2
    low = at.astype(int)
    share = 0.5 - 0.5 * np.cos(np.pi * (at - low))[:, None]
    return np.asarray(places[low] * (1 - share) + places[low + 1] * share)


def _cut(source: Source, start: int, stop: int) -> Seen:
    take, fps = source.take, source.take.fps
    weights = np.array(take.weights[start:stop])
    sound = source.sound
    if sound is not None:
        loudness = sound.loudness[start:stop]
        sound = Sound(loudness, len(loudness) / fps) if len(loudness) else None
    controls = bundled_face().measure(weights)
    return Seen(weights, controls, fps, take.lost[start:stop], rotations=source.rotations[start:stop], sound=sound)


def _planted(kind: str, sources: list[Source]) -> Iterator[tuple[Seen, Planted, str]]:
    """Yield excerpts with a fault of a kind, from each take in turn as far as it gives occasion for one."""
    rng = np.random.default_rng([SEED, list(KINDS).index(kind)])
    count = 0
    for attempt in range(TRIES * EACH):
        source = sources[attempt % len(sources)]
        length = min(len(source.take), round(LONG_S.get(kind, EXCERPT_S) * source.take.fps))
        start = int(rng.integers(0, len(source.take) - length + 1))
        seen = _cut(source, start, start + length)
        if any(flag.kind == kind for flag in flags_of(seen, USUAL.with_count(kind, on=True))):
            continue  # already there without a plant
        plant = PLANTS[kind](seen, rng)
        if plant is not None:
            yield seen, plant, source.name
            count += 1
        if count == EACH:
            return


def _touches(flag: Flag, plant: Planted, tolerance: int) -> bool:
    return flag.start < plant.stop + tolerance and flag.stop > plant.start - tolerance


def _row(kind: str, people: set[str], *, found: int, planted: int, right: int, wrong: int) -> Row:
    row: Row = {"kind": kind, "planted": planted, "found": found}
    row |= _share("recall", found, planted)
    row |= {"right": right, "wrong": wrong}
    row |= _share("precision", right, right + wrong)
    return {**row, "takes": ", ".join(sorted(people))}


def _share(name: str, part: int, whole: int) -> Row:
    """Return a share with its 95 % interval (Wilson)."""
    if not whole:
        return {name: None, f"{name}_low": None, f"{name}_high": None}
    interval = binomtest(part, whole).proportion_ci(method="wilson")
    return {name: part / whole, f"{name}_low": float(interval.low), f"{name}_high": float(interval.high)}


@dataclass(frozen=True)
class _Unplanted:
    """The flags of takes as they were recorded: a row for each take and one for all, and how many of each kind."""

    rows: list[Row]
    counts: Counter[str]


def _unplanted(sources: list[Source]) -> _Unplanted:
    """Return the flags of each take as it was recorded, and of all with the 95 % interval of a Poisson rate."""
    rows: list[Row] = []
    counts = Counter[str]()
    for source in sources:
        seen = replace(_cut(source, 0, len(source.take)), sound=source.sound)
        found = Counter(flag.kind for flag in flags_of(seen, EVERY_KIND))
        rows.append(_rate(source.name, found, source.take.duration_s / 60))
        counts += found
    if rows:
        rows.append(_rate("all", counts, sum(row["minutes"] for row in rows)))
    return _Unplanted(rows, counts)


def _rate(name: str, counts: Counter[str], minutes: float) -> Row:
    usual = Counter({kind.name: counts[kind.name] for kind in TABLE if kind.on and counts[kind.name]})
    row: Row = {"take": name, "minutes": round(minutes, 2), "flags": usual.total()}
    row |= _per_minute("flags_per_min", usual.total(), minutes)
    return {**row, "kinds": ", ".join(f"{kind} {count}" for kind, count in usual.most_common())}


def _per_minute(name: str, count: int, minutes: float) -> Row:
    """Return a rate with its 95 % interval (Poisson)."""
    return {
        name: count / minutes,
        f"{name}_low": float(chi2.ppf(0.025, 2 * count) / 2 / minutes) if count else 0.0,
        f"{name}_high": float(chi2.ppf(0.975, 2 * count + 2) / 2 / minutes),
    }
