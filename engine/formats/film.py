"""Opening files that hold pictures and sound, with nothing of theirs able to send the reader elsewhere."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from engine.errors import FormatError
from engine.formats.content import require_file

if TYPE_CHECKING:
    from av.container import InputContainer

ENDINGS = (".mov", ".mp4", ".m4v", ".mkv", ".webm", ".avi")
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
    """Return the film that lies beside a take under its name, or None."""
    names = {f"{take.stem}{ending}".casefold() for ending in ENDINGS}
    try:
        return min((p for p in take.parent.iterdir() if p.name.casefold() in names and p.is_file()), default=None)
    except OSError:
        return None
