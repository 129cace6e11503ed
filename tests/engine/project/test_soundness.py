from __future__ import annotations

from pathlib import Path

import pytest

from engine import project
from engine.errors import FormatError
from tests.engine.project.damage import damaged, marked
from tests.engine.project.projects import sql


@pytest.mark.parametrize(
    ("statement", "value"),
    [
        ("UPDATE take SET fps = ?", 1e-320),
        ("UPDATE take SET fps = ?", 1e-4),
        ("UPDATE take SET start_s = ?", 1e300),
        (
            "UPDATE edits SET kind = 'mark', inputs = ?",
            marked(media=[{"kind": "audio", "path": "a", "sha256": "b"}] * 2),
        ),
        ("UPDATE media SET kind = ?", "anything"),
    ],
)
def test_times_and_kinds_that_cannot_be_are_a_sentence(whole: bytes, tmp_path: Path, statement: str, value) -> None:
    if "mark" in statement:
        value = value.replace('"sha256": "b"}', '"sha256": "b", "offset_s": [1, 2]}')
    assert "damaged" in damaged(whole, tmp_path / "a.retake", statement, values=(value,))


@pytest.mark.parametrize("offset", ["[1, 2]", '"1"', "null", "true", "1" + "0" * 400, "1e300", "{}"])
def test_an_offset_that_is_no_time_is_a_sentence_wherever_it_stands(whole: bytes, tmp_path: Path, offset: str) -> None:
    media = marked(media=[{"kind": "audio", "path": "a.wav", "sha256": "00", "offset_s": 0.125}]).replace(
        "0.125", offset
    )
    text = damaged(whole, tmp_path / "a.retake", "UPDATE edits SET kind = 'mark', inputs = ?", values=(media,))
    assert "damaged" in text


@pytest.mark.parametrize("date", ["0001-01-01T00:00:00+23:59", "9999-12-31T23:59:59-23:59", "", "tomorrow", "5" * 400])
def test_a_date_that_no_calendar_has_is_a_sentence(whole: bytes, tmp_path: Path, date: str) -> None:
    path = tmp_path / "a.retake"
    path.write_bytes(whole)
    sql(path, "UPDATE state SET changed = ?", values=(date,))
    with pytest.raises(FormatError, match="last change"):
        project.peek(path)
