"""Sound beside a take: WAV, FLAC and OGG, with peaks ready to be drawn at any zoom."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats import film
from engine.formats.base.content import require_file, unread

if TYPE_CHECKING:
    import soundfile

Samples = npt.NDArray[np.float32]
Bins = tuple[Samples, Samples, Samples]  # lowest, highest, sum of squares

ENDINGS = (".wav", ".flac", ".ogg")
FAMILIES = ("WAV", "WAVEX", "RF64", "W64", "FLAC", "OGG")
BESIDE = ("", "_audio", "-audio", " audio")  # what a recording's file may carry behind the stem of its take
EXPECTED = "Retake plays WAV, FLAC and OGG files."
MIN_RATE, MAX_RATE = 4_000, 384_000
MAX_FILE_CHANNELS = 64
STEREO = 2
MAX_SAMPLES = 2**30  # of all channels, 4 GiB: three hours of stereo at 48 kHz; a tiny file can declare days of silence
IN_MEMORY_SAMPLES = 2**25  # 128 MiB; a longer recording lies in a temporary file that is mapped
BLOCK = 2**16  # samples of one channel
MAX_SILENCE_S = 300.0  # that is put where a film's sound begins later than its picture, or pauses
LEAST_GAP_S = 0.02  # stamps that are off by less are rounded; some kinds of film count in milliseconds or frames
BIN, GROW = 128, 4  # samples per bin of the finest peaks; bins of one level in a bin of the next


@dataclass(frozen=True, eq=False)
class Peaks:
    """What draws a stretch of sound, column by column.

    Attributes
    ----------
    first_s : time at which the first column begins
    column_s : length of a column
    low, high, rms : (columns,) float32, -1..1, over all channels; 0 where there is no sound
    """

    first_s: float
    column_s: float
    low: Samples
    high: Samples
    rms: Samples


@dataclass(frozen=True, eq=False)
class Level:
    """Lowest and highest value and sum of squares of each `bin` samples, (bins,) float32."""

    bin: int
    low: Samples
    high: Samples
    energy: Samples


@dataclass(frozen=True, eq=False)
class Audio:
    """A recording; the samples are read-only.

    Attributes
    ----------
    samples : (n,) or (n, 2) float32, -1..1; mapped from a temporary file where the recording is long
    rate : Hz
    path : where it came from, None for sound that was made
    levels : peaks over bins of 128, 512, 2,048 … samples; measured where they are not given
    """

    samples: Samples
    rate: int
    path: Path | None = None
    levels: tuple[Level, ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        self.samples.flags.writeable = False
        if not self.levels:
            parts = range(0, len(self.samples), BLOCK)
            object.__setattr__(self, "levels", _pyramid([_finest(self.samples[at : at + BLOCK]) for at in parts]))

    @property
    def channels(self) -> int:
        """How many channels there are, 1 or 2."""
        return 1 if self.samples.ndim == 1 else self.samples.shape[1]

    @property
    def duration_s(self) -> float:
        """Length in seconds."""
        return len(self.samples) / self.rate

    @property
    def loudest(self) -> float:
        """Return the largest sample without its sign."""
        return float(max(-self.levels[-1].low.min(), self.levels[-1].high.max()))

    def peaks(self, first_s: float, last_s: float, columns: int) -> Peaks:
        """Return lowest, highest and root mean square value of about `columns` columns from `first_s` to `last_s`.

        Columns begin on multiples of their length, or the picture would shimmer while panning. The cost grows with the
        columns alone: each is summed up from at most `BIN` samples or a few bins. Where bins are used, a column's
        edges fall on theirs.
        """
        column_s = max(last_s - first_s, 1e-6) / max(1, columns)
        number = int(np.floor(first_s / column_s))
        edges_s = column_s * np.arange(number, number + columns + 2)
        edges = np.clip(np.floor(edges_s * self.rate), 0, len(self.samples)).astype(np.int64)
        fitting = [level for level in self.levels if level.bin <= column_s * self.rate]
        low, high, energy = _summed(fitting[-1], edges) if fitting else _measured(self.samples, edges)
        size = fitting[-1].bin if fitting else 1
        counts = np.diff(np.minimum(-(-edges // size) * size, len(self.samples)))
        return Peaks(edges_s[0], column_s, low, high, np.sqrt(energy / np.maximum(counts, 1)).astype(np.float32))


def _summed(level: Level, edges: npt.NDArray[np.int64]) -> Bins:
    edges = -(-edges // level.bin)
    first, last = int(edges[0]), int(edges[-1])
    return _reduced(edges - first, level.low[first:last], level.high[first:last], level.energy[first:last])


def _measured(samples: Samples, edges: npt.NDArray[np.int64]) -> Bins:
    first = int(edges[0])
    part = samples[first : max(int(edges[-1]), first)]
    low, high, energy = _of_channels(part)
    return _reduced(edges - first, low, high, energy)


def _of_channels(part: Samples) -> Bins:
    if part.ndim == 1:
        return part, part, np.square(part)
    left, right = part[:, 0], part[:, 1]  # ten times faster than to reduce along an axis of two
    return np.minimum(left, right), np.maximum(left, right), (np.square(left) + np.square(right)) * np.float32(0.5)


def _reduced(edges: npt.NDArray[np.int64], low: Samples, high: Samples, energy: Samples) -> Bins:
    """Return minimum, maximum and sum over the columns between edges, which index the arrays; empty columns are 0."""
    counts = np.diff(edges)
    lowest, highest, total = np.zeros((3, len(counts)), np.float32)
    filled = counts > 0
    starts = edges[:-1][filled]
    if len(starts):
        lowest[filled] = np.minimum.reduceat(low, starts)
        highest[filled] = np.maximum.reduceat(high, starts)
        total[filled] = np.add.reduceat(energy, starts)
    return lowest, highest, total


def _finest(part: Samples) -> Bins:
    """Return a part of the samples in bins of `BIN`."""
    return _binned(_of_channels(part), BIN)


def _pyramid(parts: list[Bins]) -> tuple[Level, ...]:
    """Return the finest peaks, put together from parts of whole bins, and coarser and coarser ones."""
    low, high, energy = (np.concatenate([part[index] for part in parts]) for index in range(3))
    levels = [Level(BIN, low, high, energy)]
    while len(levels[-1].low) > GROW:
        finer = levels[-1]
        levels.append(Level(finer.bin * GROW, *_binned((finer.low, finer.high, finer.energy), GROW)))
    return tuple(levels)


def _binned(values: Bins, size: int) -> Bins:
    count = len(values[0])
    whole = count // size * size
    low, high, energy = (value[:whole].reshape(-1, size) for value in values)
    bins = low.min(axis=1), high.max(axis=1), energy.sum(axis=1)
    if whole == count:
        return bins
    low, high, energy = (value[whole:] for value in values)
    rest = low.min(), high.max(), energy.sum()
    return np.append(bins[0], rest[0]), np.append(bins[1], rest[1]), np.append(bins[2], rest[2])


# --- files


def beside(take: Path) -> Path | None:
    """Return the recording that lies beside a take under its name, or None."""
    names = {
        f"{stem}{extra}{ending}".casefold() for stem in film.stems_of(take) for extra in BESIDE for ending in ENDINGS
    }
    try:
        found = sorted(entry for entry in take.parent.iterdir() if entry.name.casefold() in names and entry.is_file())
    except OSError:
        return None
    return min(found, key=lambda entry: len(entry.name), default=None)


def read(path: Path) -> Audio:
    """Read a recording, or the sound of a film; more than two channels are mixed into one.

    A long one is decoded a part at a time into a temporary file that goes away by itself, so that memory stays
    bounded. Raises `FormatError` with one plain sentence.
    """
    ending = path.suffix.lower()
    if ending not in ENDINGS + film.ENDINGS:
        raise FormatError(f"{path.name} is not a kind of file that sound can be in.", EXPECTED)
    store, parts, rate = _Store(), [], 0
    for given_rate, block in _filmed(path) if ending in film.ENDINGS else _recorded(path):
        if not np.isfinite(block).all():
            raise FormatError(f"{path.name} holds samples that are not numbers.", "Export it again as 16 or 24 bit.")
        rate = given_rate
        store.add(block, path)
        parts.append(_finest(block))
    if not parts:
        raise FormatError(f"{path.name} holds no sound.", "It may have been cut off; export it again.")
    return Audio(store.finished(), rate, path, _pyramid(parts))


def _recorded(path: Path) -> Iterator[tuple[int, Samples]]:
    """Yield rate and decoded parts until the file really ends, whatever length its header gives."""
    import soundfile

    require_file(path, at_most=film.MAX_BYTES)
    try:
        with soundfile.SoundFile(os.fspath(path)) as file:
            _require_playable(file, path)
            while len(block := file.read(BLOCK, dtype="float32", always_2d=True)):
                yield file.samplerate, _narrowed(block)
    except (soundfile.SoundFileError, RuntimeError, TypeError, ValueError) as error:
        raise FormatError(f"{path.name} could not be read as sound.", EXPECTED) from error
    except OSError as error:
        raise unread(path, error) from error


def _filmed(path: Path) -> Iterator[tuple[int, Samples]]:
    """Yield rate and decoded parts of a film's first sound track."""
    import av

    with film.open_film(path) as file:
        if not file.streams.audio:
            raise FormatError(f"{path.name} has no sound.", EXPECTED)
        track = file.streams.audio[0]
        if track.codec_context is None or not track.time_base:
            raise FormatError(f"The sound of {path.name} is in a format that cannot be decoded here.", EXPECTED)
        if not MIN_RATE <= track.rate <= MAX_RATE:
            raise FormatError(f"{path.name} gives its rate as {track.rate:,} Hz, which cannot be played.", EXPECTED)
        layout = "stereo" if track.channels == STEREO else "mono"
        evened = av.AudioResampler("flt", layout, track.rate, frame_size=BLOCK)
        place = _Place(track.rate, film.begin_s(file), path)
        try:
            for frame in chain(file.decode(track), [None]):
                for part in evened.resample(frame):
                    samples = part.to_ndarray().astype(np.float32, copy=False)
                    block = _narrowed(samples.reshape(-1, part.layout.nb_channels))
                    at_s = None if part.pts is None or not part.time_base else float(part.pts * part.time_base)
                    for placed in place.put(block, at_s):
                        yield track.rate, placed
        except (av.FFmpegError, ValueError) as error:
            raise FormatError(f"The sound of {path.name} is damaged.", "Export the video again.") from error


class _Place:
    """Puts decoded parts where their time stamps say: silence into gaps, and nothing twice.

    Parameters
    ----------
    rate : samples per second
    begin_s : the time stamp of the first sample that is kept
    path : named in errors
    """

    def __init__(self, rate: int, begin_s: float, path: Path) -> None:
        self._rate, self._begin_s, self._path = rate, begin_s, path
        self._count = 0  # samples so far, of one channel
        self._silence_s = 0.0

    def put(self, block: Samples, at_s: float | None) -> Iterator[Samples]:
        """Yield the silence before a part, if there is any, and what of the part does not overlap the one before."""
        late_s = 0.0 if at_s is None else at_s - self._begin_s - self._count / self._rate
        if late_s > LEAST_GAP_S:
            self._silence_s += late_s
            if self._silence_s > MAX_SILENCE_S:
                raise FormatError(
                    f"The sound of {self._path.name} begins, or pauses, for more than {MAX_SILENCE_S / 60:g} minutes.",
                    "Export the video again.",
                )
            silence = np.zeros((round(late_s * self._rate), *block.shape[1:]), np.float32)
            self._count += len(silence)
            yield from (silence[at : at + BLOCK] for at in range(0, len(silence), BLOCK))
        elif late_s < -LEAST_GAP_S:
            block = block[min(len(block), round(-late_s * self._rate)) :]
        self._count += len(block)
        if len(block):
            yield block


def _narrowed(block: Samples) -> Samples:
    """Return (n, channels) as (n,) or (n, 2)."""
    return block[:, 0] if block.shape[1] == 1 else block if block.shape[1] == STEREO else block.mean(axis=1)


def _require_playable(file: soundfile.SoundFile, path: Path) -> None:
    if file.format not in FAMILIES:
        raise FormatError(f"{path.name} is a {file.format} file under another name.", EXPECTED)
    if not MIN_RATE <= file.samplerate <= MAX_RATE:
        raise FormatError(f"{path.name} gives its rate as {file.samplerate:,} Hz, which cannot be played.", EXPECTED)
    if file.channels > MAX_FILE_CHANNELS:
        raise FormatError(f"{path.name} has {file.channels} channels.", "Export it as mono or stereo.")


class _Store:
    """Samples as they come: in memory while they are few, then in a temporary file without a name."""

    def __init__(self) -> None:
        self._count, self._channels = 0, 1
        # a large file had better not lie where some systems keep /tmp, in memory
        folder = "/var/tmp" if os.path.isdir("/var/tmp") else None
        self._file = tempfile.SpooledTemporaryFile(max_size=4 * IN_MEMORY_SAMPLES, dir=folder)  # noqa: SIM115

    def add(self, block: Samples, path: Path) -> None:
        """Append a part, (n,) or (n, 2)."""
        self._count += block.size
        self._channels = block.shape[1] if block.ndim > 1 else 1
        if self._count > MAX_SAMPLES:
            raise FormatError(f"{path.name} is longer than Retake plays.", "Cut out the part that belongs to the take.")
        try:
            self._file.write(np.ascontiguousarray(block).data)
        except OSError as error:
            reason = (error.strerror or "unknown reason").lower()
            raise FormatError(
                f"{path.name} could not be decoded: its samples found no room, {reason}.", "Make room on the disk."
            ) from error

    def finished(self) -> Samples:
        """Return all samples, (n,) or (n, 2)."""
        if self._count <= IN_MEMORY_SAMPLES:
            self._file.seek(0)
            flat = np.frombuffer(self._file.read(), np.float32)
        else:
            self._file.flush()
            flat = np.memmap(self._file, np.float32, "r", shape=(self._count,))
        return flat if self._channels == 1 else flat.reshape(-1, self._channels)
