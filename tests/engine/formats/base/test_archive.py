"""What an npz may hold that is no array: a sentence, and no memory."""

from __future__ import annotations

import io
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats.base.archive import arrays_of


def npy(header: str, *, version: tuple[int, int] = (1, 0), data: bytes = b"") -> bytes:
    text = header.encode("latin-1")
    length = struct.pack("<H" if version == (1, 0) else "<I", len(text))
    return b"\x93NUMPY" + bytes(version) + length + text + data


def archive(path: Path, content: bytes) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("a.npy", content)
    return path


GOOD = "{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }\n"


def test_an_array_is_read(tmp_path: Path) -> None:
    path = archive(tmp_path / "a.npz", npy(GOOD, data=np.arange(3.0).tobytes()))
    np.testing.assert_array_equal(arrays_of(path, ("a", "b"))["a"], np.arange(3.0))


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\x93NUMPY",
        npy(GOOD, version=(9, 9)),
        npy(GOOD)[:20],
        npy("{'descr': '<f8', 'fortran_order': False, 'shape': (3,)"),
        npy("(" * 9000),
        npy("{'descr': '<f8', 'fortran_order': False, 'shape': 'x', }"),
        npy("{'descr': '<f8', 'fortran_order': False, 'shape': (-3,), }"),
        npy("{'descr': '<f8', 'fortran_order': False, 'shape': (3L,), }", data=bytes(24)),
        npy("{'descr': '<f8', 'fortran_order': False, 'shape': (10**9,), }"),
        npy("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999, 9999999999999999999999), }"),
        npy("{'descr': '|V0', 'fortran_order': False, 'shape': (4000000000,), }"),
        npy("{'descr': '<U0', 'fortran_order': False, 'shape': (4000000000,), }"),
        npy("{'descr': '|O', 'fortran_order': False, 'shape': (3,), }", data=b"cos\nsystem\n(S'true'\ntR."),
        npy("{'descr': 7, 'fortran_order': False, 'shape': (3,), }"),
        npy("{'descr': ('<f8', (99999999,)), 'fortran_order': False, 'shape': (99999,), }"),
        npy("{'descr': [('a', '<f8')] * 3, 'fortran_order': False, 'shape': (3,), }"),
        npy("\n\t  indented: ["),
        npy("'''"),
    ],
    ids=range(19),
)
def test_a_header_that_is_damaged_is_a_sentence(tmp_path: Path, content: bytes) -> None:
    path = archive(tmp_path / "a.npz", content)
    if content == npy("{'descr': '<f8', 'fortran_order': False, 'shape': (3L,), }", data=bytes(24)):
        assert len(arrays_of(path, ("a",))["a"]) == 3  # as Python 2 wrote it
        return
    with pytest.raises(FormatError, match=r"a\.npz"):
        arrays_of(path, ("a",))


def test_a_zip_that_is_damaged_anywhere_is_a_sentence(tmp_path: Path) -> None:
    made = io.BytesIO()
    np.savez_compressed(made, a=np.arange(100.0))
    whole, path = made.getvalue(), tmp_path / "a.npz"
    refused = 0
    for at in range(0, len(whole), 3):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0xFF]) + whole[at + 1 :])
        try:
            arrays_of(path, ("a",))
        except FormatError:
            refused += 1
    assert refused > 20
