from __future__ import annotations

from pathlib import Path

import pytest

from engine.errors import FormatError
from engine.formats.base.textfile import read_text

TEXT = "frame, jawOpen\r\nümlaut 顔 – 3\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "notes.txt"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_a_text_comes_back_from_every_encoding_with_its_mark_or_without(path: Path, encoding: str) -> None:
    text = TEXT if encoding in ("utf-8", "utf-8-sig", "utf-16") else TEXT.replace("顔 –", "a")
    path.write_bytes(text.encode(encoding))
    assert read_text(path) == text
    path.write_bytes(b"\xfe\xff" + TEXT.encode("utf-16-be"))
    assert read_text(path) == TEXT


@pytest.mark.parametrize("length", [3, 4, 32, 40])
def test_utf_16_without_a_mark_is_known_by_the_zeros_beside_its_letters(path: Path, length: int) -> None:
    for encoding in ("utf-16-le", "utf-16-be"):
        path.write_bytes(("x" * length).encode(encoding))
        assert (read_text(path) == "x" * length) == (length >= 4)
    path.write_bytes(b"a\0b\0c\0d\0e\0f\0gh")
    assert "\0" in read_text(path)


def test_western_letters_are_read_where_they_are_expected_and_what_is_no_text_is_refused(path: Path) -> None:
    path.write_bytes("après – €".encode("cp1252"))
    assert read_text(path, latin=True) == "après – €"
    with pytest.raises(FormatError, match=r"notes\.txt is not a text file"):
        read_text(path)
    path.write_bytes(b"\x81\xe4")  # 0x81 is no letter of cp1252
    assert read_text(path, latin=True) == "\x81ä"
    path.write_bytes(b"\xff\xe4\0\0\x01")
    with pytest.raises(FormatError, match="not a text file"):
        read_text(path, latin=True)
    path.write_bytes(b"ab\0cd")
    assert read_text(path) == "ab\0cd"


def test_a_text_is_as_long_as_it_may_be_and_no_longer(path: Path) -> None:
    path.write_bytes(b"x" * (2 << 20))
    assert len(read_text(path, at_most=2 << 20)) == 2 << 20
    with pytest.raises(FormatError, match="larger than 1 MB"):
        read_text(path, at_most=(2 << 20) - 1)
