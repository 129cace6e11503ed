"""Opening files that hold pictures and sound, with nothing of theirs able to send the reader elsewhere."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from engine.errors import FormatError
from engine.formats.content import require_file

if TYPE_CHECKING:
    from av.container import InputContainer

ENDINGS = (".mov", ".mp4", ".m4v", ".mkv", ".webm", ".avi")
TABLES = ("_cal", "_raw", "_neutral")  # what the app adds to a take's name for its files
FAMILIES = "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi"  # no play lists: those name other files and addresses
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
