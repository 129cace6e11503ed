from __future__ import annotations

from pathlib import Path

import pytest

from engine.formats.base.unfinished import is_unfinished, whole_rows


@pytest.mark.parametrize(
    ("name", "unfinished"),
    [
        ("take.partial.csv", True),
        ("take.partial12.csv", True),
        ("a.b.partial.csv", True),
        ("take.csv", False),
        ("partial.csv", False),
        ("take.partial.txt", False),
        ("take.partial.csv.bak", False),
    ],
)
def test_a_recording_that_was_not_ended_is_known_by_its_name(name: str, unfinished: bool) -> None:
    assert is_unfinished(Path("folder.partial.csv") / name) == unfinished


def test_rows_count_up_to_the_last_whole_one() -> None:
    content = b"head\n1,2\n3,4\n"
    for cut in range(len(content) + 1):
        expected = content[:cut][: content[:cut].rfind(b"\n") + 1]
        for tail in (b"", b"\0" * 9, b"\0\n5,6\n"):
            assert whole_rows(content[:cut] + tail) == expected
