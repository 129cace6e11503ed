from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest

from app.playback import video
from app.playback.video import Video
from engine.errors import FormatError
from engine.formats import audio
from engine.formats.film import beside
from tests.films import film, flash_and_click, shade, sound_only, turned

STEADY_MS = [round(1000 * n / 30) for n in range(90)]
# as phones film: 30 Hz that drops to 12 and halts for a second
CHANGING_MS = np.cumsum([0] + [33] * 20 + [83] * 12 + [1000] + [17] * 30).tolist()


def shown(reader: Video, time_s: float) -> int | None:
    frame = reader.frame_at(time_s)
    return None if frame is None else int(np.median(frame.picture))


@pytest.mark.parametrize("times_ms", [STEADY_MS, CHANGING_MS], ids=["steady", "changing"])
@pytest.mark.parametrize("order", ["forwards", "backwards", "anyhow"])
def test_the_frame_shown_is_the_last_one_that_has_begun(tmp_path: Path, times_ms, order) -> None:
    reader = Video(film(tmp_path / "Ä 顔.mp4", times_ms))
    asked = np.arange(0, times_ms[-1] + 10, 11) / 1000
    asked = {"forwards": asked, "backwards": asked[::-1], "anyhow": np.random.default_rng(0).permutation(asked)}[order]
    for time_s in asked:
        number = int(np.searchsorted(times_ms, time_s * 1000 + 0.001, side="right")) - 1
        assert abs(shown(reader, time_s) - shade(number)) <= 2, time_s
    assert shown(reader, -0.1) is None and shown(reader, times_ms[-1] / 1000 + 1) is None
    reader.close()


def test_going_back_and_forth_decodes_each_frame_once(tmp_path: Path, monkeypatch) -> None:
    reader = Video(film(tmp_path / "a.mp4", STEADY_MS))
    made: list[int] = []
    small = video._small
    monkeypatch.setattr(video, "_small", lambda frame, aspect: (made.append(frame.pts), small(frame, aspect))[1])
    for time_s in [*np.arange(0, 2, 0.02), *np.arange(2, 0, -0.02), *np.arange(0, 2, 0.03)]:
        reader.frame_at(time_s)
    assert len(made) <= 65
    reader.close()


def test_what_is_kept_is_bounded_and_around_the_playhead(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(video, "CACHE_BYTES", 10 * 64 * 48 * 3)
    reader = Video(film(tmp_path / "a.mp4", STEADY_MS))
    for number in (0, 80, *range(40, 53)):
        assert abs(shown(reader, number / 30 + 0.01) - shade(number)) <= 2
        assert len(reader._frames) <= 10
    assert all(abs(start - 52 / 30) < 0.4 for start in reader._starts)
    reader.close()


def test_pictures_are_kept_no_larger_than_they_are_shown(tmp_path: Path) -> None:
    reader = Video(film(tmp_path / "a.mp4", STEADY_MS[:3], size=(1280, 720)))
    assert reader.frame_at(0.0).picture.shape == (270, 480, 3)
    reader.close()


def test_hostile_files_give_one_sentence(tmp_path: Path) -> None:
    good = film(tmp_path / "good.mp4", STEADY_MS).read_bytes()
    sound_only(tmp_path / "sound.mp4")
    secret = film(tmp_path / "secret.mp4", STEADY_MS[:5])
    (tmp_path / "list.mp4").write_text(f"#EXTM3U\n#EXTINF:1,\nfile:{secret}\n#EXT-X-ENDLIST\n")
    (tmp_path / "joined.mp4").write_text(f"ffconcat version 1.0\nfile '{secret}'\n")
    (tmp_path / "empty.mov").touch()
    (tmp_path / "text.mkv").write_text("no video\n" * 100)
    (tmp_path / "picture.avi").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(900))
    (tmp_path / "cut.mp4").write_bytes(good[:-400])  # its index is at its end
    (tmp_path / "folder.mp4").mkdir()
    names = (
        "sound.mp4",
        "list.mp4",
        "joined.mp4",
        "empty.mov",
        "text.mkv",
        "picture.avi",
        "cut.mp4",
        "folder.mp4",
        "none.mp4",
    )
    for name in names:
        with pytest.raises(FormatError) as caught:
            Video(tmp_path / name)
        assert caught.value.sentence.startswith(name), name
    with pytest.raises(FormatError, match="no moving picture"):
        Video(tmp_path / "sound.mp4")


def test_damage_inside_gives_a_sentence_or_another_frame_and_never_anything_else(tmp_path: Path) -> None:
    good = film(tmp_path / "good.mp4", STEADY_MS).read_bytes()
    rng = np.random.default_rng(0)
    opened = 0
    for trial in range(40):
        data = bytearray(good)
        for at in rng.integers(0, len(data), 30):
            data[at] = rng.integers(256)
        path = tmp_path / f"{trial}.mp4"
        path.write_bytes(data)
        try:
            reader = Video(path)
            opened += 1
            for time_s in (0.0, 1.5, 0.7, 2.9):
                reader.frame_at(time_s)
        except FormatError as error:
            assert error.sentence.startswith(path.name)
    assert opened > 5


def test_pictures_too_large_to_show_are_refused(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(video, "MAX_PIXELS", 1000)
    with pytest.raises(FormatError, match="64 × 48"):
        Video(film(tmp_path / "a.mp4", STEADY_MS[:3]))


def test_the_video_beside_a_take_is_found(tmp_path: Path) -> None:
    assert beside(tmp_path / "Slate_4.csv") is None
    (tmp_path / "Slate_4.MOV").touch()
    assert beside(tmp_path / "Slate_4.csv") == tmp_path / "Slate_4.MOV"


@pytest.mark.parametrize("ending", [".mp4", ".mov", ".mkv"])
@pytest.mark.parametrize(("sound_from_s", "picture_from_s"), [(0.0, 0.0), (0.5, 0.0), (1.3, 0.0), (0.0, 0.6)])
def test_flash_and_click_are_met_at_one_time(tmp_path: Path, ending: str, sound_from_s: float, picture_from_s: float):
    path = flash_and_click(tmp_path / f"a{ending}", sound_from_s=sound_from_s, picture_from_s=picture_from_s)
    sound = audio.read(path)
    assert abs(int(np.argmax(np.abs(sound.samples) > 0.3)) / sound.rate - 2.0) < 0.01
    reader = Video(path)
    assert [reader.frame_at(at_s).picture.mean() > 128 for at_s in (1.99, 2.02, 2.05)] == [False, True, False]
    assert (reader.frame_at(0.3) is None) == (picture_from_s > 0.3)
    reader.close()


def test_a_film_whose_stamps_begin_anywhere_begins_at_its_first_track(tmp_path: Path) -> None:
    path = flash_and_click(tmp_path / "a.mkv", sound_from_s=0.8, picture_from_s=0.4)
    sound, reader = audio.read(path), Video(path)
    assert abs(int(np.argmax(np.abs(sound.samples) > 0.3)) / sound.rate - 1.6) < 0.01
    assert reader.frame_at(1.62).picture.mean() > 128 and reader.frame_at(0.0) is not None
    reader.close()


def test_sound_that_begins_later_than_anyone_waits_is_one_sentence(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(audio, "MAX_SILENCE_S", 1.0)
    with pytest.raises(FormatError, match="begins, or pauses"):
        audio.read(flash_and_click(tmp_path / "a.mkv", sound_from_s=1.5))


CORNER = {"as it is": (1, 0, 0, 1), "right": (0, 1, -1, 0), "over": (-1, 0, 0, -1), "left": (0, -1, 1, 0)}
CORNER |= {"mirrored": (-1, 0, 0, 1), "upside down": (1, 0, 0, -1), "transposed": (0, 1, 1, 0)}


@pytest.mark.parametrize("matrix", CORNER.values(), ids=CORNER)
def test_a_film_is_turned_and_mirrored_as_it_says(tmp_path: Path, matrix: tuple[int, int, int, int]) -> None:
    path = tmp_path / "a.mp4"
    with av.open(str(path), "w") as file:
        stream = file.add_stream("libx264", rate=25, options={"crf": "5"})
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        picture = np.zeros((48, 64, 3), np.uint8)
        picture[:24, :32] = 255  # the upper left quarter
        frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
        frame.pts, frame.time_base = 0, Fraction(1, 25)
        file.mux(stream.encode(frame))
        file.mux(stream.encode())
    reader = Video(turned(path, matrix))
    shown = reader.frame_at(0.0).picture.mean(axis=2)
    reader.close()
    a, b, c, d = matrix
    assert shown.shape == ((48, 64) if a else (64, 48))
    x, y = a * -1 + c * -1, b * -1 + d * -1  # where the corner at (-1, -1) goes
    lit = [(i, j) for i in (-1, 1) for j in (-1, 1) if shown[:: 1 if j < 0 else -1, :: 1 if i < 0 else -1][8, 8] > 128]
    assert lit == [(x, y)]


def test_pixels_that_are_not_square_are_drawn_as_wide_as_they_are(tmp_path: Path) -> None:
    reader = Video(film(tmp_path / "a.mp4", STEADY_MS[:3], size=(320, 240), pixel_aspect=1.5))
    assert reader.frame_at(0.0).picture.shape == (240, 480, 3)
    reader.close()
    turned(tmp_path / "a.mp4", CORNER["right"])
    reader = Video(tmp_path / "a.mp4")
    assert reader.frame_at(0.0).picture.shape == (480, 240, 3)
    reader.close()


def test_a_picture_that_no_decoder_here_knows_is_a_sentence(tmp_path: Path) -> None:
    path = film(tmp_path / "a.mp4", STEADY_MS[:3])
    path.write_bytes(path.read_bytes().replace(b"avc1", b"zzzz"))
    with pytest.raises(FormatError, match=r"a\.mp4"):
        Video(path)
