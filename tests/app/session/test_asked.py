from __future__ import annotations

import time
from types import SimpleNamespace

import numpy as np
import pytest

from app.session import Document
from app.session.asked import LARGEST_KEPT, Asked, Base, _length
from engine.editing import PasteRequest, SmoothRequest
from engine.take import SHAPES, Take


@pytest.fixture
def base() -> Base:
    return Base.of(Document(Take(np.full((40, len(SHAPES)), 0.25), 30.0)))


def test_what_is_asked_of_is_the_document_as_it_is() -> None:
    document = Document(Take(np.full((40, len(SHAPES)), 0.25), 30.0))
    base = Base.of(document)
    assert base.take is document.take and base.controls is document.controls and base.asked is document.asked


def test_a_wish_is_about_its_request_s_frames_or_the_whole_take(base: Base) -> None:
    assert Asked("smooth", SmoothRequest((3, 9), 4.0), base).frames == (3, 9)
    everything = SimpleNamespace(frames=None)
    assert Asked("fit", everything, base).frames == (0, 40)  # type: ignore[arg-type]


def test_a_project_keeps_the_request_and_what_else_it_should_remember(base: Base) -> None:
    request = SmoothRequest((3, 9), 4.0)
    stored = Asked("smooth", request, base, also={"seen": True}).stored
    assert stored == {"seen": True, "request": "smooth", **request.stored()}
    assert Asked("smooth", request, base, variants=3).stored["variants"] == 3 and "variants" not in stored


def test_arrays_are_kept_up_to_a_length_in_all(base: Base) -> None:
    class Request:
        verb, frames = "paste", None

        def __init__(self, *lengths: int) -> None:
            self.lengths = lengths

        def stored(self) -> dict[str, object]:
            packed = {f"a{place}": {"f8": "x" * length} for place, length in enumerate(self.lengths)}
            return {"start": 3, "name": "y" * 2 * LARGEST_KEPT, "nested": {"inner": packed}, **packed}

    half = LARGEST_KEPT // 2
    kept = Asked("paste", Request(half // 2, half // 2), base).stored  # type: ignore[arg-type]
    assert {"a0", "a1", "nested"} <= set(kept)
    for lengths in ((half // 2, half // 2 + 1), (half + 1,)):  # each counts twice: it is nested as well
        stored = Asked("paste", Request(*lengths), base).stored  # type: ignore[arg-type]
        assert set(stored) == {"request", "start", "name"}


def test_only_packed_numbers_have_a_length() -> None:
    assert _length({"f8": "abc", "other": {"f8": "x" * 9}}) == 3
    assert _length({"a": {"f8": "abc"}, "b": {"c": {"f8": "de"}}, "d": 7, "e": "text", "f": [1, 2]}) == 5
    assert _length(7) == _length("text") == 0


def test_a_wish_remembers_when_it_was_asked(base: Base) -> None:
    before = time.perf_counter()
    since = Asked("paste", PasteRequest(0, np.zeros((1, len(SHAPES)))), base).since
    assert before <= since <= time.perf_counter()
