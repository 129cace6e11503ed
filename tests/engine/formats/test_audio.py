from __future__ import annotations

import errno
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import soundfile
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.errors import FormatError
from engine.formats import audio
from engine.formats.audio import BIN, Audio, beside, read
from tests.films import film, sound_only

RATE = 8_000


def noise(count: int, channels: int = 1) -> np.ndarray:
    shape = count if channels == 1 else (count, channels)
    return (np.random.default_rng(count).uniform(-0.9, 0.9, shape)).astype(np.float32)


def tones(count: int, channels: int) -> np.ndarray:
    waves = 0.4 * np.sin(np.arange(count)[:, None] * np.array([0.1, 0.17])[:channels])
    return waves.astype(np.float32).squeeze()


@pytest.mark.parametrize(
    ("ending", "subtype", "within"), [("wav", "FLOAT", 0), ("flac", "PCM_24", 2**-22), ("ogg", None, 0.03)]
)
@pytest.mark.parametrize("channels", [1, 2])
def test_what_is_read_is_what_was_recorded(tmp_path: Path, ending, subtype, within, channels) -> None:
    path, recorded = tmp_path / f"Ärger 顔.{ending}", tones(100_000, channels)
    soundfile.write(path, recorded, RATE, subtype)
    heard = read(path)
    assert (heard.rate, heard.channels, heard.path) == (RATE, channels, path)
    assert heard.samples.dtype == np.float32 and not heard.samples.flags.writeable
    np.testing.assert_allclose(heard.samples, recorded, atol=within)


def test_more_than_two_channels_become_their_mean(tmp_path: Path) -> None:
    recorded = noise(5_000, 5)
    soundfile.write(tmp_path / "a.wav", recorded, RATE, "FLOAT")
    np.testing.assert_allclose(read(tmp_path / "a.wav").samples, recorded.mean(axis=1), atol=1e-6)


@pytest.mark.parametrize("channels", [1, 2])
def test_a_long_recording_is_mapped_and_reads_the_same(tmp_path: Path, monkeypatch, channels: int) -> None:
    recorded = noise(3 * audio.BLOCK + 77, channels)
    soundfile.write(tmp_path / "a.wav", recorded, RATE, "FLOAT")
    short = read(tmp_path / "a.wav")
    monkeypatch.setattr(audio, "IN_MEMORY_SAMPLES", 1000)
    long = read(tmp_path / "a.wav")
    assert isinstance(long.samples if channels == 1 else long.samples.base, np.memmap)
    np.testing.assert_array_equal(long.samples, short.samples)
    for ours, measured in zip(long.levels, Audio(recorded, RATE).levels, strict=True):
        np.testing.assert_array_equal(ours.low, measured.low)
        np.testing.assert_allclose(ours.energy, measured.energy, rtol=1e-6)


@settings(deadline=None, max_examples=60)
@given(count=st.integers(1, 40_000), channels=st.sampled_from([1, 2]), first=st.floats(-2, 6), width=st.floats(1e-3, 9))
def test_peaks_are_those_of_the_samples_in_each_column(count: int, channels: int, first: float, width: float) -> None:
    """Against a plain loop: each column holds the extremes and mean square of its samples, edges rounded to bins."""
    sound = Audio(noise(count, channels), RATE)
    drawn = sound.peaks(first, first + width, 50)
    assert drawn.first_s <= first + 1e-9 and drawn.first_s + drawn.column_s * len(drawn.low) >= first + width - 1e-9
    number = round(drawn.first_s / drawn.column_s)
    per_column = drawn.column_s * RATE
    bin_ = 1 if per_column < BIN else max(level.bin for level in sound.levels if level.bin <= per_column)
    edges = np.clip(np.floor(drawn.column_s * (number + np.arange(len(drawn.low) + 1)) * RATE), 0, count)
    edges = -(-edges.astype(int) // bin_) * bin_
    for column, (a, b) in enumerate(pairwise(edges)):
        part = sound.samples[a : min(b, count)].astype(float)
        low, high, rms = (part.min(), part.max(), np.sqrt((part**2).mean())) if part.size else (0.0, 0.0, 0.0)
        np.testing.assert_allclose(
            (drawn.low[column], drawn.high[column], drawn.rms[column]), (low, high, rms), atol=1e-4
        )


def test_no_click_is_lost_at_any_zoom() -> None:
    samples = np.zeros(RATE * 60, np.float32)
    samples[123_456] = -0.8
    sound = Audio(samples, RATE)
    for columns in (10, 300, 5_000, 100_000):
        assert sound.peaks(0, 60, columns).low.min() == np.float32(-0.8)


def test_panning_does_not_change_the_columns() -> None:
    sound = Audio(noise(RATE * 20), RATE)
    here, there = sound.peaks(0.0, 10.0, 500), sound.peaks(1.0, 11.0, 500)
    shift = round((there.first_s - here.first_s) / here.column_s)
    np.testing.assert_array_equal(here.low[shift : shift + 400], there.low[:400])


def test_the_recording_beside_a_take_is_found(tmp_path: Path) -> None:
    take = tmp_path / "Slate_4.csv"
    assert beside(take) is None
    for name in ("Slate_44.wav", "Slate_4_audio.WAV", "other.wav"):
        (tmp_path / name).touch()
    assert beside(take) == tmp_path / "Slate_4_audio.WAV"
    (tmp_path / "slate_4.flac").touch()
    assert beside(take) == tmp_path / "slate_4.flac"
    assert beside(tmp_path / "nowhere" / "a.csv") is None


def hostile(folder: Path) -> dict[str, bytes]:
    good = folder / "good.wav"
    soundfile.write(good, noise(4_000), RATE, "PCM_16")
    data = good.read_bytes()
    soundfile.write(folder / "f.wav", np.array([0.1, np.nan, 0.2], np.float32), RATE, "FLOAT")
    soundfile.write(folder / "n.wav", np.zeros(0, np.float32), RATE)
    soundfile.write(folder / "a.aiff", noise(100), RATE)
    soundfile.write(folder / "c.wav", noise(100, 80), RATE)
    return {
        "empty.wav": b"",
        "text.flac": b"not sound at all\n" * 50,
        "picture.ogg": b"\x89PNG\r\n\x1a\n" + bytes(500),
        "head.wav": data[:30],
        "no_samples.wav": (folder / "n.wav").read_bytes(),
        "nan.wav": (folder / "f.wav").read_bytes(),
        "other_kind.wav": (folder / "a.aiff").read_bytes(),
        "eighty_channels.wav": (folder / "c.wav").read_bytes(),
        "rate_one.wav": data[:24] + (1).to_bytes(4, "little") + data[28:],
        "rate_zero.wav": data[:24] + bytes(4) + data[28:],
        "no_channels.wav": data[:22] + bytes(2) + data[24:],
        "sound.raw": data,
    }


def test_hostile_files_give_one_sentence(tmp_path: Path) -> None:
    for name, data in hostile(tmp_path).items():
        (tmp_path / name).write_bytes(data)
        with pytest.raises(FormatError) as caught:
            read(tmp_path / name)
        assert caught.value.sentence.startswith(name) and caught.value.sentence.count(". ") == 0, name
    with pytest.raises(FormatError):
        read(tmp_path / "absent.wav")
    with pytest.raises(FormatError):
        read(tmp_path)


def test_a_header_that_promises_more_than_there_is_is_not_believed(tmp_path: Path) -> None:
    path = tmp_path / "a.wav"
    soundfile.write(path, noise(4_000), RATE, "PCM_16")
    data = path.read_bytes()
    path.write_bytes(data[:40] + (2**31).to_bytes(4, "little") + data[44:-1000])
    assert len(read(path).samples) == 3_500


def test_hours_of_silence_in_a_small_file_are_refused(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(audio, "MAX_SAMPLES", 500_000)
    soundfile.write(tmp_path / "a.flac", np.zeros(600_000, np.float32), RATE)
    with pytest.raises(FormatError, match="longer than Retake plays"):
        read(tmp_path / "a.flac")


def test_the_sound_of_a_film_is_read_in_step(tmp_path: Path) -> None:
    rate = 48_000
    recorded = tones(rate * 3, 1) * np.linspace(0.1, 1, rate * 3, dtype=np.float32)
    heard = read(sound_only(tmp_path / "a.mov", recorded, rate))
    assert heard.rate == rate and 0 <= len(heard.samples) - len(recorded) < 2048
    np.testing.assert_allclose(heard.samples[2048 : rate * 3 - 2048], recorded[2048:-2048], atol=0.02)
    for ours, measured in zip(heard.levels, Audio(heard.samples, rate).levels, strict=True):
        np.testing.assert_array_equal(ours.high, measured.high)


def test_a_silent_film_gives_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="has no sound"):
        read(film(tmp_path / "a.mp4", [0, 33, 67]))


def test_sound_that_no_decoder_here_knows_is_a_sentence(tmp_path: Path) -> None:
    path = sound_only(tmp_path / "a.mkv")
    content = path.read_bytes()
    assert content.count(b"A_AAC") == 1
    path.write_bytes(content.replace(b"A_AAC", b"A_ZZZ"))
    with pytest.raises(FormatError, match="cannot be decoded here"):
        audio.read(path)


def test_no_room_for_the_samples_is_a_sentence(tmp_path: Path, monkeypatch) -> None:
    """As under a limit on the size of files, or on a full disk."""
    wave = tmp_path / "a.wav"
    soundfile.write(wave, np.zeros(200_000, np.float32), 48_000)

    def full(*_: object) -> int:
        raise OSError(errno.EFBIG, "File too large")

    monkeypatch.setattr("tempfile.SpooledTemporaryFile.write", full)
    with pytest.raises(FormatError, match="found no room, file too large"):
        audio.read(wave)
