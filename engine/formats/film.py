"""Opening files that hold pictures and sound, with nothing of theirs able to send the reader elsewhere."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from engine.errors import FormatError
from engine.formats.base.content import require_file

if TYPE_CHECKING:
    from av.container import InputContainer

ENDINGS = (".mov", ".mp4", ".m4v", ".mkv", ".webm", ".avi")
TABLES = ("_cal", "_raw", "_neutral")  # what the app adds to a take's name for its files
FAMILIES = "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi"  # no play lists: those name other files and addresses
FARTHEST_S = 1e7
MAX_BYTES = 1 << 44  # a film is never read whole
EXPECTED = "Retake reads MOV, MP4, MKV, WebM and AVI files."


def open_film(path: Path) -> InputContainer:
    """Open a film; raises `FormatError` with one plain sentence."""
    import av

    require_file(path, at_most=MAX_BYTES)
    options = {"format_whitelist": FAMILIES, "protocol_whitelist": "file"}
    try:
        return av.open(f"file:{path.resolve()}", container_options=options)
    except (av.FFmpegError, OSError, ValueError) as error:
        raise FormatError(f"{path.name} could not be read as a video.", EXPECTED) from error


def begin_s(file: InputContainer) -> float:
    """Return the time stamp, in seconds, at which a film begins for whoever watches it: that of its first track.

    Sound and picture are both placed from here on, so that one which begins later is heard or seen later. Samples
    that only prime a decoder have stamps before zero; a film never begins with them.
    """
    starts = [start_s(stream) for stream in (*file.streams.audio, *moving(file))]
    return max(0.0, min(starts, default=0.0))


def start_s(stream: Any) -> float:
    """Return the first time stamp of a track in seconds, 0 where it gives none that can be."""
    if stream.start_time is None or not stream.time_base:
        return 0.0
    start = float(stream.start_time * stream.time_base)
    return start if math.isfinite(start) and abs(start) < FARTHEST_S else 0.0


def moving(file: InputContainer) -> list[Any]:
    """Return the tracks of moving pictures; one that is attached to sound as its cover is none."""
    return [stream for stream in file.streams.video if "attached_pic" not in str(stream.disposition).lower()]


def beside(take: Path) -> Path | None:
    """Return the film that lies beside a take under its name, or None: `X.mov` or `X_iPhone.mov` beside `X_cal.csv`."""
    found = {path.name.casefold(): path for path in _films(take.parent)}
    names = (f"{stem}{ending}" for stem in stems_of(take) for ending in ENDINGS)
    return next((found[name] for name in names if name in found), None)


def stems_of(take: Path) -> list[str]:
    """Return the names, without endings and in small letters, that sound and film of a take may have, its own first."""
    stem, common = take.stem.casefold(), common_stem(take.stem)
    return list(dict.fromkeys([stem, *(stem.removesuffix(kind) for kind in TABLES), common, f"{common}_iphone"]))


def common_stem(stem: str) -> str:
    """Return the name that the files of one take have in common: `x` of `X_cal`, `X_iPhone` and `X_iPhone_raw`."""
    name = stem.casefold()
    for kind in TABLES:
        name = name.removesuffix(kind)
    return name.removesuffix("_iphone")


def _films(folder: Path) -> list[Path]:
    try:
        return sorted(path for path in folder.iterdir() if path.suffix.lower() in ENDINGS and path.is_file())
    except OSError:
        return []
