"""Movies are written without a codec under the GPL unless it is asked for, and can be read by Retake itself."""

from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest

from app import cli
from app.preview import encoding, movie
from app.preview.encoding import BY_DEFAULT, CODECS, codec_named
from engine.errors import EditError
from engine.formats import write_take
from engine.take import Take

GPL = {"libx264", "libx265"}
READ_AS = {"av1": "av1", "vp9": "vp9", "mpeg4": "mpeg4", "h264": "h264"}


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures without a renderer."""

    def picture(takes: object, frame: int, *, height: int) -> np.ndarray:
        width = 2 * round(height * movie.ASPECT / 2)
        shade = np.linspace(0, 200, width, dtype=np.uint8)[None, :, None] + np.uint8(frame)
        return np.ascontiguousarray(np.broadcast_to(shade, (2 * (height // 2), width, 3)))

    monkeypatch.setattr(movie, "picture", picture)


def a_take(frames: int = 12) -> Take:
    return Take(weights=np.zeros((frames, 52)), fps=30.0)


@pytest.mark.parametrize("codec", [None, *CODECS])
@pytest.mark.parametrize("height", [64, 270])
def test_every_codec_writes_a_movie_that_can_be_read(
    tmp_path: Path, drawn: None, codec: str | None, height: int
) -> None:
    movie.write_movie([a_take()], tmp_path / "a.mp4", height=height, codec=codec)
    with av.open(str(tmp_path / "a.mp4")) as container:
        (stream,) = container.streams.video
        frames = [frame.to_ndarray(format="gray") for frame in container.decode(stream)]
        assert stream.codec_context.name.removeprefix("lib").startswith(("dav1d", READ_AS[codec or "av1"]))
    assert len(frames) == 12 and frames[0].shape == (height // 2 * 2, 2 * round(height * movie.ASPECT / 2))


def test_nothing_under_the_gpl_is_used_unasked(monkeypatch: pytest.MonkeyPatch) -> None:
    for there in (set(), {"libx264"}, {"libx264", "mpeg4"}, {"mpeg4", "libvpx-vp9"}, {"libsvtav1", "mpeg4", "libx264"}):
        monkeypatch.setattr(encoding, "_is_there", there.__contains__)
        expected = [CODECS[name] for name in BY_DEFAULT if CODECS[name].encoder in there]
        if expected:
            assert codec_named(None) is expected[0] and codec_named(None).encoder not in GPL
        else:
            with pytest.raises(EditError, match="lacks a codec for movies"):
                codec_named(None)
    with pytest.raises(EditError, match="lacks the codec h264"):
        monkeypatch.setattr(encoding, "_is_there", set().__contains__)
        codec_named("h264")


def test_the_shell_refuses_a_codec_that_there_is_not(
    tmp_path: Path, drawn: None, capfd: pytest.CaptureFixture[str]
) -> None:
    write_take(a_take(), tmp_path / "take.csv")
    arguments = ["render", str(tmp_path / "take.csv"), "-o", str(tmp_path / "a.mp4"), "--size", "64"]
    assert cli.run([*arguments, "--codec", "divx"]) == 2 and not (tmp_path / "a.mp4").exists()
    assert "no codec called 'divx'" in capfd.readouterr().err
    assert cli.run(arguments) == 0 and (tmp_path / "a.mp4").stat().st_size > 500
    assert "Svt" not in capfd.readouterr().err
