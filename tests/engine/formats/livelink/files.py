"""Live Link Face files of many writers, built to test with."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from hypothesis import strategies as st

from engine.formats.livelink.columns import DEFAULT_HEADER, ROTATIONS

LOST_ROWS = ("two cells", "empty cells", "zeros", "short of cells")


@dataclass(frozen=True)
class Writer:
    """How a file is written.

    Attributes
    ----------
    numbers : "fixed" (ten decimals), "repr" (as Python prints them), "short" (three decimals)
    lost_rows : what follows the count 0, of `LOST_ROWS`
    ending : of lines; `closed` whether the last one has it
    more, fewer : columns that are no shapes; shapes that it leaves out
    """

    fps: float = 30.0
    numbers: str = "fixed"
    lost_rows: str = "two cells"
    ending: str = "\n"
    closed: bool = True
    mark: str = ""
    more: tuple[str, ...] = ()
    fewer: tuple[str, ...] = ()
    at_rest_first: bool = False
    header: tuple[str, ...] = field(init=False, default=())

    def __post_init__(self) -> None:
        names = tuple(name for name in DEFAULT_HEADER if name not in self.fewer)
        object.__setattr__(self, "header", (*names, *self.more))


def timecode(time_s: float) -> str:
    """Return a time as the app writes it."""
    ticks = round(time_s * 60 * 1000) % (86400 * 60 * 1000)
    second, part = divmod(ticks, 60_000)
    return f"{second // 3600:02d}:{second // 60 % 60:02d}:{second % 60:02d}:{part / 1000:06.3f}"


def number(value: float, writer: Writer) -> str:
    return {"fixed": f"{value:.10f}", "repr": repr(float(value)), "short": f"{value:.3f}"}[writer.numbers]


def content_of(writer: Writer, lost: np.ndarray, absent: np.ndarray, seed: int, *, start_s: float = 3600.0) -> bytes:
    """Return a file with a row for each frame that is not `absent`, (frames,); those that are `lost` have no face."""
    rng = np.random.default_rng(seed)
    columns = len(writer.header) - 2
    curves = np.cumsum(rng.normal(0, 0.05, (len(lost), columns)), axis=0)
    values = np.abs((curves + rng.random(columns)) % 2 - 1)  # walks folded into 0..1
    if writer.at_rest_first:
        values[0] = 0.0
    lines = [",".join(writer.header)]
    for frame in np.flatnonzero(~absent).tolist():
        cells = [number(value, writer) for value in values[frame]]
        if lost[frame]:
            padded = {
                "two cells": [],
                "empty cells": [""] * columns,
                "zeros": ["0"] * columns,
                "short of cells": ["", ""],
            }
            line = [timecode(start_s + frame / writer.fps), "0", *padded[writer.lost_rows]]
        else:
            line = [timecode(start_s + frame / writer.fps), str(columns), *cells]
        lines.append(",".join(line))
    return (writer.mark + writer.ending.join(lines) + (writer.ending if writer.closed else "")).encode()


writers = st.builds(
    Writer,
    fps=st.sampled_from([24.0, 25.0, 30000 / 1001, 30.0, 48.0, 50.0, 60000 / 1001, 60.0, 120.0]),
    numbers=st.sampled_from(["fixed", "repr", "short"]),
    lost_rows=st.sampled_from(LOST_ROWS),
    ending=st.sampled_from(["\n", "\r\n"]),
    closed=st.booleans(),
    mark=st.sampled_from(["", "\ufeff"]),
    more=st.sampled_from([(), ("Confidence", "TearLeft")]),
    fewer=st.sampled_from([(), ROTATIONS, ("TongueOut",)]),
    at_rest_first=st.booleans(),
)


@dataclass(frozen=True)
class File:
    """A file to test with: its writer, what each frame is (0 recorded, 1 lost, 2 without a row), and a seed."""

    writer: Writer
    runs: tuple[tuple[int, int, int], ...]
    frames: int
    seed: int

    @property
    def content(self) -> bytes:
        """Its bytes."""
        state = np.zeros(self.frames, int)
        for start, length, kind in self.runs:
            state[1 + start % (self.frames - 2) :][:length] = kind
        state[-1] = 0
        if (state == 2).sum() > self.frames // 3:  # else its clock is not to be believed
            state[state == 2] = 1
        return content_of(self.writer, state == 1, state == 2, self.seed)


# Runs of lost and absent rows, long and short, beside one another too.
files = st.builds(
    File,
    writers,
    st.lists(
        st.tuples(st.integers(0, 200), st.sampled_from([1, 1, 2, 3, 8, 30]), st.sampled_from([1, 2])), max_size=5
    ).map(tuple),
    st.integers(40, 120),
    st.integers(0, 2**16),
)
