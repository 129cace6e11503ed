"""Arrays out of an npz of unknown origin: what it declares is compared with what it holds before memory is taken."""

from __future__ import annotations

import lzma
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.base.budget import BUDGET
from engine.formats.base.content import require_file

MAX_BYTES = 512 << 20  # of all arrays that are read, unpacked; zeros are packed a thousandfold
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


def arrays_of(path: Path, required: Iterable[str]) -> dict[str, npt.NDArray[Any]]:
    """Return those of the wanted arrays that an npz holds, never an object; raises `FormatError` where it is damaged."""
    require_file(path, at_most=MAX_BYTES)
    try:
        with zipfile.ZipFile(path) as archive:
            present = [name for name in required if f"{name}.npy" in archive.namelist()]
            left = replace(BUDGET, bytes=MAX_BYTES)
            left.require(path.name, bytes=sum(archive.getinfo(f"{name}.npy").file_size for name in present))
            for name in present:
                left = left.spend(path.name, values=_declared(archive, f"{name}.npy", path))
        with np.load(path, allow_pickle=False) as stored:
            return {name: np.asarray(stored[name]) for name in present}
    except DAMAGED as error:
        raise FormatError(f"{path.name} is damaged.") from error


def _declared(archive: zipfile.ZipFile, member: str, path: Path) -> int:
    """Return how many values an array declares; raises `FormatError` where its bytes do not fill them.

    A value without width, such as a text of no letters, fills no bytes in any number: it is refused where there are more
    than the bytes of its file.
    """
    with archive.open(member) as file:
        old = np.lib.format.read_magic(file) == (1, 0)
        shape, _, dtype = (np.lib.format.read_array_header_1_0 if old else np.lib.format.read_array_header_2_0)(file)
    count = int(np.prod(shape, dtype=object))
    if dtype.subdtype is not None or dtype.names is not None:
        raise FormatError(f"{path.name} holds tables where a character has numbers.")
    if min(shape, default=0) < 0 or count * max(dtype.itemsize, 1) > archive.getinfo(member).file_size:
        raise FormatError(f"{path.name} declares more data than it holds.")
    return count
