from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import pytest

from engine.errors import FormatError
from engine.formats.film import ENDINGS, begin_s, beside, common_stem, moving, open_film, start_s, stems_of
from tests.films import film, flash_and_click, sound_only


def track(
    start: int | None, base: Fraction | None = Fraction(1, 1000), disposition: str = "default"
) -> SimpleNamespace:
    return SimpleNamespace(start_time=start, time_base=base, disposition=disposition)


@pytest.mark.parametrize(
    ("start", "base", "seconds"),
    [
        (1500, Fraction(1, 1000), 1.5),
        (-40, Fraction(1, 1000), -0.04),
        (None, Fraction(1, 1000), 0.0),
        (5, None, 0.0),
        (10**7, Fraction(1), 0.0),
        (10**7 - 1, Fraction(1), 1e7 - 1),
        (-(10**8), Fraction(1), 0.0),
    ],
)
def test_a_track_begins_at_its_first_stamp_where_that_can_be(start, base, seconds: float) -> None:
    assert start_s(track(start, base)) == seconds


def test_a_film_begins_with_its_first_track_and_never_before_zero() -> None:
    cover = track(-9000, disposition="<Disposition.attached_pic: 1024>")
    streams = SimpleNamespace(audio=[track(700)], video=[cover, track(300)])
    opened = SimpleNamespace(streams=streams)
    assert moving(opened) == streams.video[1:] and begin_s(opened) == 0.3
    streams.audio.append(track(-20))
    assert begin_s(opened) == 0.0
    streams.audio, streams.video = [], [cover]
    assert begin_s(opened) == 0.0


def test_tracks_of_real_films_are_told_apart(tmp_path: Path) -> None:
    with open_film(
        flash_and_click(tmp_path / "a.mp4", sound_from_s=0.5, picture_from_s=0.25, length_s=1.0, at_s=0.6)
    ) as opened:
        assert len(moving(opened)) == len(opened.streams.audio) == 1
        assert 0 <= begin_s(opened) < 0.5
    with open_film(sound_only(tmp_path / "b.mp4")) as opened:
        assert moving(opened) == []


@pytest.mark.parametrize(
    "content", [b"", b"no film", b"#EXTM3U\nhttp://127.0.0.1/a.ts\n", b"ffconcat version 1.0\nfile '/etc/passwd'\n"]
)
def test_what_is_no_film_or_leads_elsewhere_is_a_sentence(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.mov").write_bytes(content)
    with pytest.raises(FormatError, match=r"a\.mov could not be read as a video"):
        open_film(tmp_path / "a.mov")
    with pytest.raises(FormatError, match="is a folder"):
        open_film(tmp_path)


@pytest.mark.parametrize(
    ("take", "film_name"),
    [
        ("X.csv", "X.mov"),
        ("X_cal.csv", "x.MP4"),
        ("X_raw.csv", "X_raw.mkv"),
        ("X_iPhone_raw.csv", "X_iPhone.mov"),
        ("X_cal.csv", "X_iPhone.webm"),
        ("X_neutral.csv", "X.avi"),
    ],
)
def test_the_film_beside_a_take_is_found_by_its_name(tmp_path: Path, take: str, film_name: str) -> None:
    (tmp_path / take).touch()
    for other in ("Y.mov", "X.txt", "X_other.mov"):
        (tmp_path / other).touch()
    assert beside(tmp_path / take) is None
    (tmp_path / film_name).touch()
    assert beside(tmp_path / take) == tmp_path / film_name
    (tmp_path / "folder" / f"{Path(film_name).stem}.mov").mkdir(parents=True)
    assert beside(tmp_path / "folder" / take) is None and beside(tmp_path / "nowhere" / take) is None


def test_a_take_s_own_name_comes_first_and_kinds_of_film_in_their_order(tmp_path: Path) -> None:
    for name in ("x_cal.mp4", "x.mov", "x_iphone.mov"):
        (tmp_path / name).touch()
    assert beside(tmp_path / "X_cal.csv").name == "x_cal.mp4"
    assert beside(tmp_path / "X.csv").name == "x.mov"
    assert stems_of(Path("X_cal.csv")) == ["x_cal", "x", "x_iphone"]
    assert common_stem("X_iPhone_raw") == common_stem("x_CAL") == "x" and ENDINGS[:2] == (".mov", ".mp4")
    film(tmp_path / "y.mp4", [0, 40])
    assert beside(tmp_path / "Y.csv").name == "y.mp4"
