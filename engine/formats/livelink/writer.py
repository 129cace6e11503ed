"""Live Link Face CSV, written: rows that nobody changed as the text they came as, all others in full."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cached_property
from pathlib import Path

import numpy as np

from engine.formats.base.atomic import write_bytes
from engine.formats.base.reading import Sides
from engine.formats.livelink.clock import clock_of, timecodes_between
from engine.formats.livelink.columns import DEFAULT_HEADER, ROTATIONS, Columns, Places, column_name, columns_of
from engine.formats.livelink.origin import Origin, lost_frames
from engine.formats.livelink.sides import exchange_cells, recorded_name, written_recorded
from engine.formats.livelink.timecode import Style
from engine.take import SHAPE_INDEX, SHAPES, Array, Mask, Take

DECIMALS = 10  # as the app writes a value
UNSEEN = 0.01  # of a weight; a column that a file lacks is added to all of its rows only for more than this
SAME = 1e-9  # values that differ by less are written alike


def write(take: Take, path: Path, sides: Sides = "automatic") -> None:
    """Write a take as Live Link Face CSV.

    Rows of the file it came from are written as the text they came as, to the byte, where nobody changed them. A frame
    that was given motion has a full row, whether its row had no face or was absent; one that is still lost has none.
    With `sides` recorded or named, left and right of mouth and jaw are written as the app does or by their names,
    whatever the file had.
    """
    origin = _origin_of(take)
    swapped, names = (origin.swapped, origin.header) if origin is not None else (True, DEFAULT_HEADER)
    if written_recorded(sides, swapped=swapped) == swapped:
        write_bytes(path, encode(take))
    else:
        write_bytes(path, exchange_cells(_lines(encode(take)), [column_name(name) for name in names]))


def encode(take: Take) -> Iterator[bytes]:
    """Yield the bytes of a take's file, piece by piece; each ends where a row does."""
    origin = _origin_of(take)
    if origin is not None:
        yield from _Rewriting(take, origin).pieces()
    else:
        yield header()
        yield from rows(take.start_s + np.arange(len(take)) / take.fps, take.weights, take.rotations, take.lost)


def _origin_of(take: Take) -> Origin | None:
    return take.origin if isinstance(take.origin, Origin) and take.origin.fits(take) else None


def _lines(pieces: Iterable[bytes]) -> Iterator[bytes]:
    for piece in pieces:
        yield from (line for line in re.split(rb"(?<=\n)", piece) if line)


def header() -> bytes:
    """Return the first line of a file that grows row by row."""
    return ",".join(DEFAULT_HEADER).encode() + b"\n"


def rows(times_s: Array, weights: Array, rotations: Array, lost: Mask) -> Iterator[bytes]:
    """Yield the lines of frames at times of their own: weights (frames, 52), rotations (frames, 9), lost (frames,)."""
    order = [SHAPE_INDEX[recorded_name(name, swapped=True)] for name in SHAPES]
    values = np.concatenate([weights[:, order], rotations], axis=1)
    row_format = ",".join([f"%.{DECIMALS}f"] * values.shape[1])
    for time_s, row, is_lost in zip(times_s.tolist(), values, lost.tolist(), strict=True):
        body = "0" if is_lost else f"{values.shape[1]},{row_format % tuple(row.tolist())}"
        yield b"%s,%s\n" % (Style().write(time_s), body.encode())


class _Rewriting:
    """A take written over the file that it came from.

    Parameters
    ----------
    take : what is written
    origin : its file, which has the same frames
    """

    def __init__(self, take: Take, origin: Origin) -> None:
        self._take, self._origin = take, origin
        self._header = origin.header
        self._columns: Columns = columns_of(self._header, take.name, swapped=origin.swapped)
        self._moved = take.weights != origin.weights
        self._turned = take.rotations != origin.rotations
        differs = self._moved.any(axis=1) | self._turned.any(axis=1)
        now_lost = take.lost[origin.rows]
        self._touched: Mask = np.where(now_lost, ~origin.lost, origin.lost | differs[origin.rows])
        self._inserted = _inserted(take, origin)
        self._full = np.flatnonzero(~origin.lost)

    def pieces(self) -> Iterator[bytes]:
        """Yield the file from its head to its end."""
        origin, extra = self._origin, self._extra
        yield self._head
        added = np.searchsorted(origin.rows, self._inserted) - 1  # the row that each inserted frame follows
        stops = self._touched.copy()
        stops[added] = True
        if extra:
            stops |= ~origin.lost
        done = 0
        for row in np.flatnonzero(stops).tolist():
            yield origin.text(done, row)
            yield self._row(row) if self._touched[row] or extra else origin.text(row, row + 1)
            for frame in self._inserted[added == row].tolist():
                yield self._new_row(row, frame)
            done = row + 1
        yield origin.content[origin.starts[done] :]

    @cached_property
    def _timecodes(self) -> dict[int, bytes]:
        """Timecodes of the inserted frames, in sequence and as the file writes them."""
        origin, frames = self._origin, self._inserted.tolist()
        texts = timecodes_between(origin.timecodes, origin.rows, frames, fps=self._take.fps)
        return dict(zip(frames, texts, strict=True))

    @cached_property
    def _extra(self) -> list[tuple[str, Array]]:
        """Columns that the file lacks although the take has something to say there, with their values, (frames,)."""
        columns, take = self._columns, self._take
        found = []
        for index in np.setdiff1d(np.arange(len(SHAPES)), columns.shapes).tolist():
            found.append((f"{SHAPES[index][0].upper()}{SHAPES[index][1:]}", take.weights[:, index]))
        for index in np.setdiff1d(np.arange(len(ROTATIONS)), columns.rotations).tolist():
            found.append((ROTATIONS[index], take.rotations[:, index]))
        return [(name, values) for name, values in found if np.abs(values).max() > UNSEEN]

    @property
    def _head(self) -> bytes:
        head = self._origin.head
        line = head.rstrip(b"\r\n")
        return b",".join([line, *(name.encode() for name, _ in self._extra)]) + head[len(line) :]

    def _row(self, row: int) -> bytes:
        """Return the line of a row that changed: cells whose values did not are the text they came as."""
        origin, frame = self._origin, int(self._origin.rows[row])
        line, ending = _line_and_ending(origin.text(row, row + 1))
        if self._take.lost[frame]:
            return (line if origin.lost[row] else line.partition(b",")[0] + b",0") + ending
        cells = line.split(b",")
        if origin.lost[row] or len(cells) != len(self._header):
            return self._in_full(cells[0], row, frame) + ending
        columns = self._columns
        self._put(cells, frame, self._moved[frame, columns.shapes], self._turned[frame, columns.rotations])
        return self._joined(cells, frame) + ending

    def _new_row(self, row: int, frame: int) -> bytes:
        """Return the line of a frame that has no row, between a row and the next."""
        origin = self._origin
        _, ending = _line_and_ending(origin.text(row, row + 1))
        timecode = self._timecodes[frame]
        return (timecode + b",0" if self._take.lost[frame] else self._in_full(timecode, row, frame)) + ending

    def _in_full(self, timecode: bytes, row: int, frame: int) -> bytes:
        """Return a line with every value of a frame; columns that are none of a take's are as in the row nearest to it."""
        place = min(int(np.searchsorted(self._full, row)), len(self._full) - 1)
        near = int(self._full[place])
        cells = _line_and_ending(self._origin.text(near, near + 1))[0].split(b",")
        if len(cells) != len(self._header):
            cells = [b"", str(len(self._header) - 2).encode(), *[b"0"] * (len(self._header) - 2)]
        cells[0] = timecode
        self._put(cells, frame, np.ones(len(self._columns.shapes), bool), np.ones(len(self._columns.rotations), bool))
        return self._joined(cells, frame)

    def _put(self, cells: list[bytes], frame: int, shapes: Mask, rotations: Mask) -> None:
        columns, take = self._columns, self._take
        for index, cell in zip(columns.shapes[shapes].tolist(), columns.shape_cells[shapes].tolist(), strict=True):
            cells[cell] = _number(take.weights[frame, index])
        turned = columns.rotations[rotations].tolist(), columns.rotation_cells[rotations].tolist()
        for index, cell in zip(*turned, strict=True):
            cells[cell] = _number(take.rotations[frame, index])

    def _joined(self, cells: list[bytes], frame: int) -> bytes:
        extra = [_number(values[frame]) for _, values in self._extra]
        if extra and cells[1].strip() == str(len(self._header) - 2).encode():
            cells[1] = str(len(self._header) - 2 + len(extra)).encode()
        return b",".join([*cells, *extra])


def _inserted(take: Take, origin: Origin) -> Places:
    """Return the frames without a row that must have one, lest a reader makes something else of them.

    A gap of absent rows is written whole or not at all; one that is not, reads as the take has it.
    """
    rows, absent = origin.rows, np.setdiff1d(np.arange(len(take)), origin.rows)
    gap = np.searchsorted(origin.rows, absent)
    inserted: Places = np.zeros(0, np.int64)
    fps = clock_of(origin.timecodes).fps if len(absent) else take.fps
    while len(absent):
        lost = take.lost[rows]
        seen = rows[~lost]
        told_lost = lost_frames(rows, lost, fps)[absent]
        wrong = told_lost != take.lost[absent]
        if len(seen):
            for curves in (take.weights, take.rotations):
                interpolated = np.stack([np.interp(absent, seen, curve) for curve in curves[seen].T], axis=1)
                wrong |= ~take.lost[absent] & (np.abs(interpolated - curves[absent]) > SAME).any(axis=1)
        now = np.isin(gap, gap[wrong])
        if not now.any():
            break
        inserted, rows = np.union1d(inserted, absent[now]), np.union1d(rows, absent[now])
        absent, gap = absent[~now], gap[~now]
    return inserted


def _number(value: float) -> bytes:
    return f"{value:.{DECIMALS}f}".encode()


def _line_and_ending(text: bytes) -> tuple[bytes, bytes]:
    line = text.rstrip(b"\r\n")
    return line, text[len(line) :]
