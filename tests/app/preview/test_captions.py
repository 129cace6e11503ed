from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QApplication

from app.preview import captions as burning
from app.preview import movie
from app.preview.captions import SHOWN_S, Captions, Said, band, band_height, burnt_in
from engine.review.counting import counting_of
from engine.take import Take

NOTES = (Said(3, 4, "Ada: look"), Said(20, 200, "Bob: all of this"))


def captions(*, fps: float = 30.0, notes: tuple[Said, ...] = NOTES) -> Captions:
    counting = counting_of(fps)
    return Captions(("Before: a", "After: b"), counting, counting.count_at(3600.0), notes)


def test_a_frame_shows_its_timecode_and_the_notes_that_can_be_read() -> None:
    given = captions(fps=29.97)
    assert given.timecode(0) == "01:00:00;00" and given.timecode(1800) == "01:01:00;02"
    lasting = round(SHOWN_S * 30000 / 1001)
    shown = [given.note_at(frame) for frame in (2, 3, 19, 20, lasting + 3, 199, 200)]
    both = "Bob: all of this\nAda: look"
    assert shown == ["", "Ada: look", "Ada: look", both, "Bob: all of this", "Bob: all of this", ""]


def test_what_is_written_is_what_a_reviewer_reads(qapp: QApplication, monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[str] = []
    draw = QPainter.drawText
    monkeypatch.setattr(
        burning.QPainter, "drawText", lambda self, *given: (written.append(given[-1]), draw(self, *given))
    )
    band(captions(), 30, width=640, height=320)
    assert written == ["Before: a", "After: b", "01:00:01:00", "frame 30", "Bob: all of this\nAda: look"]


@pytest.mark.parametrize("text", ["<img src=x>{{ 1 }}\x1b[2J\u202e", "word " * 300, "日本語" * 200, "\n" * 50])
def test_a_note_of_any_kind_stays_in_its_place(qapp: QApplication, text: str) -> None:
    given = captions(notes=(Said(0, 5, text),))
    for width, height in ((640, 320), (104, 64)):
        drawn = band(given, 0, width=width, height=height)
        assert drawn.shape == (band_height(given, height), width, 3)
        assert band_height(given, height) % 2 == 0
        edge = drawn[-2:]  # nothing is written over the lower edge
        assert (edge == edge[0, 0]).all()


def test_a_decoded_movie_shows_the_frame_that_it_counts(
    qapp: QApplication, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each decoded band is nearer to the band of its own frame than to that of any other near it."""
    monkeypatch.setattr(movie, "picture", lambda takes, frame, height: np.full((height, 256, 3), 90, np.uint8))
    given, take = captions(), Take(weights=np.zeros((24, 52)), fps=30.0)
    movie.write(movie.Movie((take, take), 160, (4, 24), False, given), tmp_path / "a.mp4")
    with av.open(str(tmp_path / "a.mp4")) as file:
        decoded = [frame.to_ndarray(format="gray").astype(float) for frame in file.decode(file.streams.video[0])]
    expected = [band(given, frame, width=256, height=160).mean(axis=2) for frame in range(24)]
    assert len(decoded) == 20
    for index, picture in enumerate(decoded):
        away = [np.abs(picture[160:] - other).mean() for other in expected]
        assert int(np.argmin(away)) == index + 4


def test_the_picture_itself_is_left_as_it_is(qapp: QApplication) -> None:
    picture = np.random.default_rng(0).integers(0, 255, (80, 128, 3), np.uint8)
    np.testing.assert_array_equal(burnt_in(picture, captions(), 0)[:80], picture)
