"""The C3D file itself: its header, its parameters and its points, each counted against the file before it is read.

As the C3D User Guide (2021) describes it: blocks of 512 bytes, parameters in groups, points as floats or as scaled
16-bit numbers, in the byte order of Intel or, with floats of their own, of DEC machines. Written here, since a parser
that takes what a file declares for granted ends the whole program.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from engine.formats.base.budget import Budget
from engine.take import Array

BLOCK = 512
DEC, SGI = 85, 86  # numbers of processors; INTEL is 84
MAX_PARAMETERS = 10_000
TEXT, BYTE, WORD, FLOAT = -1, 1, 2, 4  # kinds of values
Parameters = Mapping[tuple[str, str], "Parameter"]


class C3DError(ValueError):
    """What is wrong with a file, as the rest of a sentence that begins with its name."""


@dataclass(frozen=True)
class Parameter:
    """One parameter: texts, or numbers in the order of the file; empty where it holds none."""

    texts: tuple[str, ...] = ()
    numbers: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class C3D:
    """What a file holds of points.

    Attributes
    ----------
    positions : (frames, n, 3) in the file's unit
    residuals : (frames, n); below zero where a point was not seen
    parameters : by group and name, both in capitals
    rate : frames per second, as the header says
    """

    positions: Array
    residuals: Array
    rate: float
    parameters: Parameters = field(default_factory=dict)


def parse(content: bytes, name: str, budget: Budget) -> C3D:
    """Return the points of a file's content; raises `C3DError`, or `FormatError` where it asks for too much."""
    if len(content) < BLOCK or content[1] != 0x50:
        raise C3DError("is not a C3D file")
    start = (content[0] - 1) * BLOCK
    if not 0 <= start <= len(content) - 4:
        raise C3DError("is cut off: its parameters are beyond its end")
    processor = content[start + 3]
    parameters = _parameters(content, start, dec=processor == DEC)
    points, analog, first, last, _ = struct.unpack_from("<5H", content, 2)
    scale, rate = (_float(content, at, dec=processor == DEC) for at in (12, 20))
    (block,) = struct.unpack_from("<H", content, 16)
    frames = _frames(first, last, parameters)
    width = 4 * points + analog  # the word counts all analog values of a frame, however many samples it has
    size = 4 if scale < 0 else 2
    begin = (block - 1) * BLOCK
    if points == 0 or frames <= 0 or begin < 0 or not math.isfinite(scale) or not math.isfinite(rate):
        raise C3DError("holds no points")
    budget.require(name, frames=frames, values=4 * points * frames)
    if begin + frames * width * size > len(content):
        raise C3DError("declares more points than it holds")
    values = _values(content, begin, frames * width, floats=scale < 0, dec=processor == DEC).reshape(frames, width)
    table = values[:, : 4 * points].reshape(frames, points, 4)
    factor = 1.0 if scale < 0 else scale
    with np.errstate(invalid="ignore"):  # damaged bytes may be no number
        wide = table.astype(np.float64)
    return C3D(wide[..., :3] * factor, wide[..., 3], rate, parameters)


def _frames(first: int, last: int, parameters: Parameters) -> int:
    """Return how many frames there are; 16 bits of the header hold 65,535, and longer takes say it in parameters."""
    starts, ends = (parameters.get(("TRIAL", f"ACTUAL_{end}_FIELD"), Parameter()).numbers for end in ("START", "END"))
    if len(starts) == len(ends) == 2:
        low, high = (int(pair[0]) % 65536 + 65536 * (int(pair[1]) % 65536) for pair in (starts, ends))
        if high - low >= last - first:
            return high - low + 1
    longer = parameters.get(("POINT", "LONG_FRAMES"), Parameter()).numbers
    if longer and math.isfinite(longer[0]) and last - first + 1 < longer[0] < 2**31:
        return int(longer[0])
    return last - first + 1


def _parameters(content: bytes, start: int, *, dec: bool) -> dict[tuple[str, str], Parameter]:
    """Return the parameters by group and name; what is cut off or points nowhere ends the list."""
    groups: dict[int, str] = {}
    found: list[tuple[int, str, Parameter]] = []
    at = start + 4
    for _ in range(MAX_PARAMETERS):
        if at + 2 > len(content):
            break
        length, number = struct.unpack_from("<bb", content, at)
        length = abs(length)
        behind = at + 2 + length
        if length == 0 or behind + 2 > len(content):
            break
        name = content[at + 2 : behind].decode("latin-1").strip().upper()
        (step,) = struct.unpack_from("<h", content, behind)
        if number < 0:
            groups[-number] = name
        elif (value := _parameter(content, behind + 2, dec=dec)) is not None:
            found.append((number, name, value))
        if step <= 0:
            break
        at = behind + step
    return {(groups.get(number, ""), name): value for number, name, value in found}


def _parameter(content: bytes, at: int, *, dec: bool) -> Parameter | None:
    if at + 2 > len(content):
        return None
    kind, dimensions = struct.unpack_from("<bB", content, at)
    sizes = list(content[at + 2 : at + 2 + dimensions])
    begin, count = at + 2 + dimensions, math.prod(sizes)
    if abs(kind) not in (1, 2, 4) or len(sizes) < dimensions or begin + count * abs(kind) > len(content):
        return None
    if kind == TEXT:
        width = sizes[0] if sizes else 1
        text = content[begin : begin + count].decode("utf-8", "replace")
        if len(text) != count:
            text = content[begin : begin + count].decode("latin-1")
        return Parameter(texts=tuple(text[at : at + width].strip(" \0") for at in range(0, count, max(1, width))))
    if kind == BYTE:
        return Parameter(numbers=tuple(map(float, content[begin : begin + count])))
    numbers = _values(content, begin, count, floats=kind == FLOAT, dec=dec)
    return Parameter(numbers=tuple(numbers.tolist()))


def _float(content: bytes, at: int, *, dec: bool) -> float:
    return float(_values(content, at, 1, floats=True, dec=dec)[0])


def _values(content: bytes, at: int, count: int, *, floats: bool, dec: bool) -> npt.NDArray[Any]:
    """Return 32-bit floats or 16-bit numbers; the halves of a DEC float are exchanged, and it is four times as large."""
    if not floats:
        return np.frombuffer(content, "<i2", count, at)
    if not dec:
        return np.frombuffer(content, "<f4", count, at)
    halves = np.frombuffer(content, "<u2", 2 * count, at).reshape(count, 2)[:, ::-1]
    with np.errstate(all="ignore"):  # damaged bytes may be no number
        return np.ascontiguousarray(halves).view("<f4").reshape(count) / np.float32(4)
