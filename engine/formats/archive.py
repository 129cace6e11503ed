"""Arrays out of an npz of unknown origin: what it declares is compared with what it holds before memory is taken."""

from __future__ import annotations

import lzma
import math
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.budget import BUDGET
from engine.formats.content import require_file

MAX_BYTES = 4 << 30
# What numpy and zipfile raise over damaged bytes; RuntimeError stands for encryption.
FAULTS = (
    *(
        OSError,
        EOFError,
        LookupError,
        ValueError,
        TypeError,
        RuntimeError,
        ArithmeticError,
        MemoryError,
        AttributeError,
    ),
    *(struct.error, zlib.error, lzma.LZMAError, tokenize.TokenError, SyntaxError),
)
DAMAGED = (*FAULTS, zipfile.BadZipFile)


def names_in(path: Path) -> set[str]:
    """Return the names of the arrays in an npz; none where it is no such file."""
    try:
        require_file(path, at_most=MAX_BYTES)
        with zipfile.ZipFile(path) as archive:
            return {name.removesuffix(".npy") for name in archive.namelist()}
    except (FormatError, *DAMAGED):
        return set()


def arrays_of(path: Path, wanted: Iterable[str]) -> dict[str, npt.NDArray[Any]]:
    """Return those of the wanted arrays that an npz holds, never an object; raises `FormatError` where it is damaged."""
    require_file(path, at_most=MAX_BYTES)
    try:
        with zipfile.ZipFile(path) as archive:
            held = [name for name in wanted if f"{name}.npy" in archive.namelist()]
            if sum(archive.getinfo(f"{name}.npy").file_size for name in held) > MAX_BYTES:
                raise FormatError(f"{path.name} declares more data than a character can hold.")
            for name in held:
                _require_held(archive, f"{name}.npy", path)
        with np.load(path, allow_pickle=False) as stored:
            return {name: np.asarray(stored[name]) for name in held}
    except DAMAGED as error:
        raise FormatError(f"{path.name} is damaged.") from error


def _require_held(archive: zipfile.ZipFile, member: str, path: Path) -> None:
    """Refuse an array that would take more memory than its bytes fill."""
    with archive.open(member) as file:
        old = np.lib.format.read_magic(file) == (1, 0)
        shape, _, dtype = (np.lib.format.read_array_header_1_0 if old else np.lib.format.read_array_header_2_0)(file)
    count = math.prod(int(size) for size in shape)
    if count * max(1, dtype.itemsize) > archive.getinfo(member).file_size:
        raise FormatError(f"{path.name} declares more data than it holds.")
    BUDGET.require(path.name, bytes=count * dtype.itemsize, values=count)
