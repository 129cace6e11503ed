from __future__ import annotations

import numpy as np
import pytest

from engine.formats.livelink.origin import Origin, header_of, lost_frames, row_starts
from engine.take import SHAPES, Take

HEAD = b"\xef\xbb\xbfTimecode, BlendshapeCount ,JawOpen\r\n"


def origin(content: bytes, rows: int) -> Origin:
    curves = np.zeros((rows, len(SHAPES))), np.zeros((rows, 9))
    return Origin(content, row_starts(content, rows), np.arange(rows), np.zeros(rows, bool), *curves)


@pytest.mark.parametrize("end", [b"", b"\r\n", b"\r\n\r\n"])
def test_rows_are_the_text_between_line_endings(end: bytes) -> None:
    rows = [b"00:01 ,61,0.5\r\n", b" 00:02,0\r\n", b"00:03,61,1"]
    found = origin(HEAD + b"".join(rows) + end, 3)
    assert found.head == HEAD and found.header == ("Timecode", "BlendshapeCount", "JawOpen") and len(found) == 3
    assert found.timecodes == [b"00:01", b"00:02", b"00:03"]
    assert found.text(0, 2) == rows[0] + rows[1] and found.text(1, 1) == b""
    assert found.text(2, 3) == rows[2] + end[:2]


def test_rows_that_are_missing_are_an_error() -> None:
    content = HEAD + b"a,1\nb,2\n"
    assert row_starts(content, 2).tolist() == [len(HEAD), len(HEAD) + 4, len(HEAD) + 8]
    assert row_starts(content, 1).tolist() == [len(HEAD), len(HEAD) + 4]
    for rows in (3, 50):
        with pytest.raises(ValueError, match="rows are missing"):
            row_starts(content, rows)
    with pytest.raises(UnicodeDecodeError):
        header_of(b"\xff\xfe,a")


def test_an_origin_fits_a_take_of_as_many_frames() -> None:
    found = origin(HEAD + b"a,1\nb,2\n", 2)
    assert found.fits(Take(np.ones((2, len(SHAPES))), 30.0)) and not found.fits(Take(np.ones((3, len(SHAPES))), 30.0))


@pytest.mark.parametrize("fps", [24.0, 30.0, 60.0, 120.0])
def test_frames_are_lost_where_a_row_has_no_face_or_more_than_a_moment_is_absent(fps: float) -> None:
    """Against a plain rule: absent rows count from 0.05 s on, never a single one, always between two lost rows."""
    rng = np.random.default_rng(int(fps))
    for _ in range(200):
        rows = np.cumsum(np.r_[0, rng.integers(1, 12, 8)])
        lost = rng.random(9) < 0.4
        expected = np.zeros(rows[-1] + 1, bool)
        expected[rows[lost]] = True
        for at in range(8):
            absent = rows[at + 1] - rows[at] - 1
            if (lost[at] and lost[at + 1]) or (absent >= 2 and absent / fps > 0.05):
                expected[rows[at] + 1 : rows[at + 1]] = True
        np.testing.assert_array_equal(lost_frames(rows, lost, fps), expected)
