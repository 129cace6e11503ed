from __future__ import annotations

import zlib
from pathlib import Path

import pytest

from engine.formats.livelink.origin import Origin
from engine.formats.livelink.writer import encode
from tests.engine.project.damage import damaged, zeros
from tests.engine.project.projects import reopened, sql


@pytest.mark.parametrize(
    ("statement", "value"),
    [
        ("UPDATE origin SET rows = ?", 10**12),
        ("UPDATE origin SET rows = ?", -1),
        ("UPDATE origin SET frames = ?", zeros(9)),
        ("UPDATE origin SET frames = ?", zeros(8 * 275)),
        ("UPDATE origin SET lost = ?", zlib.compress(bytes([1]) * 275)),
        ("UPDATE origin_text SET bytes = ?", 10**12),
        ("UPDATE origin_text SET bytes = ?", 0),
        ("UPDATE origin_text SET text = ?", zeros(9)),
        ("UPDATE origin_text SET place = place + ?", 1),
        ("DELETE FROM origin_text WHERE place = ?", 0),
        ("UPDATE origin_text SET bytes = 300, text = ?", zlib.compress(b"\xff\n" * 150)),
        ("UPDATE origin_text SET bytes = 300, text = ?", zlib.compress(b"a\n" * 150)),
        ("UPDATE origin_text SET bytes = 600, text = ?", zlib.compress(b"a\n" * 300)),
    ],
)
def test_an_origin_that_cannot_be_is_a_sentence(recorded: bytes, tmp_path: Path, statement: str, value: object) -> None:
    assert "damaged" in damaged(recorded, tmp_path / "a.retake", statement, values=(value,))


def test_a_take_whose_stored_text_is_no_row_is_written_all_the_same(recorded: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.retake"
    path.write_bytes(recorded)
    take = reopened(path).original
    assert isinstance(take.origin, Origin)
    head, *lines = take.origin.content.splitlines(keepends=True)
    text = head + b"".join(b"junk\n" if 20 <= index < 30 else line for index, line in enumerate(lines))
    sql(path, "UPDATE origin_text SET bytes = ?, text = ?", values=(len(text), zlib.compress(text)))
    opened = reopened(path).original
    edited = opened.with_rows(22, opened.weights[22:25] + 0.125)
    written = b"".join(encode(edited)).splitlines()
    assert len(written) == len(lines) + 1 and {len(line.split(b",")) for line in written[23:26]} == {63}
