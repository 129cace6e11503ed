from __future__ import annotations

import csv
import io
import json
import re
from pathlib import Path

import numpy as np
import pytest

from engine.errors import EditError
from engine.project import Note, Reply, Verdict
from engine.quality import Dismissal, Flag
from engine.review.changes import compare
from engine.review.counting import counting_of
from engine.review.markers import (
    FINDINGS,
    MARKERS,
    MOST_EVENTS,
    as_editors_table,
    as_edl,
    as_json,
    as_table,
    writer_for,
)
from engine.review.report import Review
from engine.take import Take

FLAGS = (Flag("spike", 1798, 1802, 0.9, "A shape leaps."), Flag("pop", 10, 11, 0.3, "=HYPERLINK(1)"))
WHO = (Flag("range", 5, 6, 0.4, "Too far."), Dismissal("range", 5, 6, 0.4, "Too far.", "Ada", "", "it is fine"))
NOTES = (
    Note(
        60,
        "Ada",
        "2026-01-02T03:04:05+00:00",
        "jaw |\r\n* LOC: 00:00:00:00 RED ü",
        20,
        replies=(Reply("Bob", "", "ok"),),
    ),
    Note(70, "Bob", "", "was done", resolved_by="Ada", resolved_at="2026-01-02T03:04:05+00:00"),
)


def review(fps: float = 30.0, *, start_s: float = 0.0, flags: tuple[Flag, ...] = FLAGS) -> Review:
    weights = np.random.default_rng(0).random((2000, 52)) * 0.1
    take = Take(weights, fps, name="shot\n<b>.csv", start_s=start_s)
    return Review(compare(take, take), (), flags, (Verdict("Approved"),), NOTES, (), (WHO,))


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def test_the_table_tells_each_flag_and_note_in_order_of_time() -> None:
    told = rows(as_table(review()))
    assert [(row["what"], row["frame"], row["stop"], row["state"]) for row in told] == [
        *(("dismissed", "5", "6", "open"), ("flag", "10", "11", "open"), ("note", "60", "80", "open")),
        *(("note", "70", "71", "done"), ("flag", "1798", "1802", "open")),
    ]
    assert told[1]["text"] == "'=HYPERLINK(1)" and told[2]["text"].endswith("\nBob: ok")
    assert told[4]["time"] == "00:00:59:28" and told[4]["weight"] == "0.90"


def test_json_holds_what_the_review_does() -> None:
    told = json.loads(as_json(review()))
    assert [flag["kind"] for flag in told["flags"]] == ["spike", "pop"] and told["fps"] == 30.0
    assert told["notes"][0]["replies"][0]["text"] == "ok" and told["dismissed"][0]["why"] == "it is fine"
    assert told["verdicts"][0]["judgement"] == "Approved"


@pytest.mark.parametrize(("fps", "mark", "second"), [(30.0, ":", "10:00:59:28"), (30000 / 1001, ";", "10:00:59;28")])
def test_an_edl_has_an_event_and_locators_at_the_takes_timecode(fps: float, mark: str, second: str) -> None:
    ten_hours_s = 1_078_920 / fps if mark == ";" else 36_000.0  # of which drop labels leave 80 ms a day to be told
    lines = as_edl(review(fps, start_s=ten_hours_s)).split("\r\n")
    assert lines[0] == "TITLE: shot <b>.csv"
    assert lines[1] == ("FCM: DROP FRAME" if mark == ";" else "FCM: NON-DROP FRAME")
    code = rf"\d\d:\d\d:\d\d{mark}\d\d"
    events = [
        line for line in lines if re.fullmatch(rf"\d{{3}}  AX       V     C        {code} {code} {code} {code}", line)
    ]
    locators = [line for line in lines if re.match(rf"\* LOC: {code} (RED|YELLOW|GREEN) +\S", line)]
    resolve = [line for line in lines if re.fullmatch(r" \|C:ResolveColor\w+ \|M:[^|]+ \|D:\d+", line)]
    assert len(events) == len(locators) == len(resolve) == 3
    assert lines[1:].count("") == 4 and all(line.isascii() for line in lines)
    assert f"001  AX       V     C        10:00:00{mark}10 10:00:00{mark}11" in events[0]
    assert events[2].split()[4] == second
    # frame 1802, past the minute: two labels are dropped there
    assert events[2].split()[5] == ("10:01:00;04" if mark == ";" else "10:01:00:02")


def test_markers_for_editors_say_where_they_begin_and_for_how_long() -> None:
    told = rows(as_editors_table(review()))
    assert [(row["In"], row["Out"], row["Duration"]) for row in told] == [
        ("00:00:00:10", "00:00:00:11", "00:00:00:01"),
        ("00:00:02:00", "00:00:02:20", "00:00:00:20"),
        ("00:00:59:28", "00:01:00:02", "00:00:00:04"),
    ]
    assert told[1]["Marker Name"] == "Note by Ada" and told[0]["Description"] == "'=HYPERLINK(1)"


def test_of_more_markers_than_an_edl_can_number_the_heaviest_are_kept() -> None:
    many = tuple(Flag("pop", frame, frame + 1, frame / 2000, "A step.") for frame in range(1500))
    text = as_edl(review(flags=many))
    numbers = [int(line[:3]) for line in text.splitlines() if re.match(r"\d{3}  AX", line)]
    assert numbers == list(range(1, MOST_EVENTS + 1))
    assert "Note by Ada" in text and counting_of(30.0).label(1499) in text and "00:00:16:00 00:00:16:01" not in text


@pytest.mark.parametrize("kinds", [FINDINGS, MARKERS])
def test_a_file_of_another_kind_is_refused(kinds: dict[str, object]) -> None:
    with pytest.raises(EditError, match=r"x\.doc is not a kind"):
        writer_for(Path("x.doc"), kinds)  # type: ignore[arg-type]
