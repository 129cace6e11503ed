"""A movie is decoded again: what is seen and what is heard at one moment stay together, at every rate and codec."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest

from app.preview import encoding
from app.preview.encoding import CODECS, codec_named
from app.preview.muxing import write_mp4
from app.preview.soundtrack import Soundtrack
from engine.formats import audio
from engine.formats.audio import Audio
from engine.review.counting import rate_of

FLASH_S, LASTING_S = 0.7, 1.2
BEGINS_S = -0.4  # time of the take at which the recording begins: 0.4 s of it come before the first picture


def flashing(count: int, flash: int) -> Iterator[np.ndarray]:
    for index in range(count):
        yield np.full((64, 96, 3), 240 if index == flash else 16, np.uint8)


def clicking(rate: int, at_s: float) -> Soundtrack:
    samples = np.zeros(rate * 2, np.float32)
    first = round((at_s - BEGINS_S) * rate)
    samples[first : first + rate // 500] = 0.9
    return Soundtrack(Audio(samples, rate), BEGINS_S)


def decoded(path: Path) -> tuple[list[float], list[float]]:
    """Return when each picture is shown, by its own stamp, and how bright it is."""
    with av.open(str(path)) as file:
        frames = list(file.decode(file.streams.video[0]))
    assert all(frame.pts is not None for frame in frames)
    return [float(frame.pts * frame.time_base) for frame in frames], [
        float(frame.to_ndarray(format="gray").mean()) for frame in frames
    ]


def heard_at(path: Path) -> float:
    """Return when the click begins, by the stamps of the decoded sound."""
    with av.open(str(path)) as file:
        parts = list(file.decode(file.streams.audio[0]))
    loudest = max(parts, key=lambda part: float(np.abs(part.to_ndarray()).max()))
    samples = np.abs(loudest.to_ndarray()[0])
    return float(loudest.pts * loudest.time_base) + int(np.argmax(samples > 0.3)) / loudest.sample_rate


@pytest.mark.parametrize(
    ("fps", "codec"),
    [(24.0, None), (29.97, None), (30.0, None), (60.0, None), *((29.97, codec) for codec in CODECS if codec != "av1")],
)
def test_flash_and_click_stay_together(tmp_path: Path, fps: float, codec: str | None) -> None:
    rate, path = rate_of(fps), tmp_path / "a.mp4"
    count, flash = round(LASTING_S * rate), round(FLASH_S * rate)
    sound = clicking(44_100, float(flash / rate))
    write_mp4(path, flashing(count, flash), count=count, rate=rate, codec=codec_named(codec), sound=sound)
    times_s, bright = decoded(path)
    assert len(times_s) == count
    np.testing.assert_allclose(times_s, [float(index / rate) for index in range(count)], atol=1e-4)
    assert np.flatnonzero(np.array(bright) > 128).tolist() == [flash]
    period_s = float(1 / rate)
    assert abs(heard_at(path) - times_s[flash]) < period_s
    read = audio.read(path)  # as Retake itself reads it
    assert abs(np.argmax(np.abs(read.samples) > 0.3) / read.rate - times_s[flash]) < period_s
    assert abs(read.duration_s - count * period_s) < 0.03


def test_an_hour_at_29_97_does_not_drift(tmp_path: Path) -> None:
    """Pictures and sound are stamped by exact rates: at frame 107,892, one hour on, both are where they belong."""
    rate = rate_of(29.97)
    sound = Soundtrack(Audio(np.zeros(10, np.float32), 48_000))
    assert sum(map(len, sound.blocks(0.0, float(107_892 / rate)))) == round(107_892 / rate * 48_000)
    assert 107_892 / rate == Fraction(35_999_964, 10_000)


def test_a_recording_is_heard_where_it_lies_and_silence_elsewhere() -> None:
    sound = Soundtrack(Audio(np.ones((100, 2), np.float32), 100), offset_s=0.5)
    heard = np.concatenate(list(sound.blocks(0.25, 2.0)))
    assert heard.shape == (200, 2)
    np.testing.assert_array_equal(np.flatnonzero(heard[:, 0]), np.arange(25, 125))
    assert not np.concatenate(list(sound.blocks(9.0, 1.0))).any()


def test_without_opus_the_sound_is_aac(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    there = encoding._is_there
    monkeypatch.setattr(encoding, "_is_there", lambda name: name != "libopus" and there(name))
    sound = clicking(16_000, 0.2)
    write_mp4(tmp_path / "a.mp4", flashing(12, 6), count=12, rate=Fraction(30), codec=codec_named(None), sound=sound)
    with av.open(str(tmp_path / "a.mp4")) as file:
        assert file.streams.audio[0].codec_context.name == "aac"


def test_a_movie_that_breaks_off_leaves_no_file(tmp_path: Path) -> None:
    def breaking() -> Iterator[np.ndarray]:
        yield from flashing(3, 0)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_mp4(tmp_path / "a.mp4", breaking(), count=9, rate=Fraction(30), codec=codec_named(None))
    assert not list(tmp_path.iterdir())
