from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np

from engine.formats import read_take
from engine.lab.performer import demo
from engine.project import Drawing, Note, Reply, Verdict
from engine.quality import Dismissal, Flag, flags_of, seen_of
from engine.review.changes import Edited, compare
from engine.review.report import CHART_WIDTH, Entry, Pictures, Review, html, index
from engine.take import SHAPE_INDEX, Take

DEMO = read_take(demo.BUNDLED)
HOSTILE = '<img src="file:///dev/zero" onerror=alert(1)>{{ 7 * 7 }}&amp;'


class Tags(HTMLParser):
    """Counts tags and keeps the text."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.text += data


def parsed(text: str) -> Tags:
    tags = Tags()
    tags.feed(text)
    return tags


def review(**words: object) -> Review:
    weights = DEMO.weights.copy()
    weights[60:80, SHAPE_INDEX["jawOpen"]] += 0.4 * np.sin(np.linspace(0, np.pi, 22)[1:-1]) ** 2
    weights[200, SHAPE_INDEX["mouthSmileLeft"]] += 0.3  # a spike
    after = replace(DEMO.with_weights(weights), name=str(words.pop("name", "after.csv")))
    edits = words.pop("edits", ())
    assert isinstance(edits, tuple)
    compared = compare(DEMO, after, edits=edits)
    return Review(compared, flags_of(seen_of(DEMO)), flags_of(seen_of(after)), edits=edits, **words)  # type: ignore[arg-type]


def test_a_report_tells_changes_flags_notes_verdict_and_edits() -> None:
    found = review(
        verdicts=(Verdict("Approved", "", "Bob", "2026-01-01T10:00:00+00:00"), Verdict("Needs work", "the jaw", "Ada")),
        notes=(Note(61, "Ada", "2026-01-02T03:04:05+00:00", "too wide", 9, "lower", (Reply("Bob", "", "is it?"),)),),
        edits=(Edited("Drag", 60, 80),),
    )
    text = parsed(html(found)).text
    for expected in (
        *("✗ Needs work: the jaw", "too wide", "Ada, 02 Jan 2026, 03:04", "Drag", "frames 60 to 79", "lips apart"),
        *("a spike", "frames 61 to 69, Mouth and jaw", "is it?", "Open", "Approved", "Bob", "01 Jan 2026, 10:00"),
    ):
        assert expected in text
    assert f"{len(DEMO) - 21}" in text  # identical frames


def test_text_of_files_notes_and_edits_is_never_markup() -> None:
    who = Dismissal("spike", 0, 1, 1.0, HOSTILE, HOSTILE, HOSTILE, HOSTILE)
    found = review(
        name=HOSTILE,
        verdicts=(Verdict(HOSTILE, HOSTILE, HOSTILE, HOSTILE),),
        notes=(Note(1, HOSTILE, HOSTILE, HOSTILE, 1, HOSTILE, (Reply(*[HOSTILE] * 3),), HOSTILE, HOSTILE),),
        edits=(Edited(HOSTILE, 60, 80),),
        dismissed=((Flag("spike", 0, 1, 1.0, HOSTILE), who),),
    )
    plain, hostile = parsed(html(review())), parsed(html(found))
    assert not [tag for tag, _ in hostile.tags if tag in ("img", "script")]
    assert {tag for tag, _ in hostile.tags} <= {tag for tag, _ in plain.tags} | {
        "blockquote",
        "article",
        "ol",
        "li",
        "span",
    }
    assert HOSTILE in hostile.text


def test_nothing_is_fetched_from_elsewhere() -> None:
    done: list[tuple[int, int]] = []
    found = review(notes=(Note(1, "A", "", "x", drawing=Drawing((((0.0, 0.0),),))), Note(2, "A", "", "y")))
    drawn = Pictures(lambda change: b"\x89PNG", lambda note: b"\x89PNG", 10.0, lambda *so_far: done.append(so_far))
    text = html(found, pictures=drawn)
    assert done == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert not re.findall(r'(?:src|href)="(?!data:)', text)
    assert "<script" not in text and "default-src 'none'" in text
    assert text.count("data:image/png;base64,") == 3


def test_flags_that_came_and_went_are_told_apart() -> None:
    found = review()
    assert [flag.kind for flag in found.new_flags] == ["spike"]
    assert not found.gone_flags
    turned = Review(compare(found.comparison.after, DEMO), found.flags_after, found.flags_before)
    assert [flag.kind for flag in turned.gone_flags] == ["spike"]


def test_a_chart_keeps_a_peak_of_one_frame_in_an_hour() -> None:
    long = Take(np.tile(DEMO.weights, (60, 1)), DEMO.fps, name="long")
    weights = long.weights.copy()
    weights[7000, SHAPE_INDEX["jawOpen"]] += 0.5
    compared = compare(long, long.with_weights(weights))
    text = html(Review(compared, (), ()))
    points = re.search(r'<polyline points="([^"]*)"', text)
    assert points is not None
    xs, ys = zip(*(map(float, pair.split(",")) for pair in points.group(1).split()), strict=True)
    assert min(ys) == 0.0 and abs(xs[ys.index(0.0)] - 7000 / len(long) * CHART_WIDTH) < 2


def test_the_list_of_a_queue_links_what_was_written() -> None:
    tags = parsed(index([Entry("a <b>", "a%20b.html", "2 changes"), Entry("c", "", "cannot be read")]))
    assert [attrs["href"] for tag, attrs in tags.tags if tag == "a"] == ["a%2520b.html"]
    assert "a <b>" in tags.text and "cannot be read" in tags.text
