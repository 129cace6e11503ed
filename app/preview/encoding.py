"""Which codec a movie is written with: those that may go into any bundle first, H.264 only where it is asked for.

Measured on 120 frames of 1152x720 of two heads side by side, on two cores, as KiB, seconds of processor time and PSNR:
x264 (crf 18) 275, 2.6, 42.5 dB; SVT-AV1 208, 1.5, 42.0 dB; VP9 (realtime) 357, 1.3, 42.5 dB; MPEG-4 1180, 0.5, 42.0 dB.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass

from engine.errors import EditError


@dataclass(frozen=True)
class Codec:
    """A way to write a movie.

    Attributes
    ----------
    encoder : its name in FFmpeg
    options : for the encoder; all at about 42 dB
    sound : the encoder of the sound beside it: Opus where whoever plays the picture plays that too
    """

    encoder: str
    options: Mapping[str, str]
    sound: str = "libopus"


# AV1 and VP9 are free of licences to pay; their encoders, and MPEG-4's, are BSD or LGPL. x264 is GPL: see THIRD_PARTY.md.
CODECS: dict[str, Codec] = {
    "av1": Codec("libsvtav1", {"crf": "24", "preset": "9", "svtav1-params": "lp=2"}),
    "vp9": Codec("libvpx-vp9", {"crf": "24", "b": "0", "deadline": "realtime", "cpu-used": "6", "row-mt": "1"}),
    "mpeg4": Codec("mpeg4", {"qmin": "2", "qmax": "2"}, sound="aac"),
    "h264": Codec("libx264", {"crf": "18"}, sound="aac"),
}
BY_DEFAULT = ("av1", "vp9", "mpeg4")


def codec_named(name: str | None) -> Codec:
    """Return the codec of a name, or the best that FFmpeg has here; raises `EditError` where it has none of it."""
    if name is not None and name not in CODECS:
        raise EditError(f"There is no codec called {name!r}.", f"Codecs are: {', '.join(CODECS)}.")
    for each in BY_DEFAULT if name is None else (name,):
        if _is_there(CODECS[each].encoder):
            if each == "av1":
                os.environ.setdefault("SVT_LOG", "1")  # errors alone: it greets on the error stream
            return CODECS[each]
    asked = f"the codec {name}" if name else "a codec for movies"
    raise EditError(f"The FFmpeg that Retake runs on lacks {asked}.", "Install the av package from its makers.")


def sound_encoder(codec: Codec) -> str:
    """Return the encoder of the sound beside a codec's pictures, AAC where FFmpeg lacks the better one."""
    return codec.sound if _is_there(codec.sound) else "aac"


def _is_there(encoder: str) -> bool:
    from av.codec import codecs_available

    return encoder in codecs_available
