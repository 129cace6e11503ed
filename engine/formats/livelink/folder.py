"""A Live Link Face take as the app hands it over since 2024: a folder, or a zip of one, opened by any of its files.

It holds `NAME_raw.csv`, `NAME_cal.csv` (with the neutral face taken out), `NAME_neutral.csv`, a film and `take.json`.
Nothing of a zip is unpacked to its own names: a table is read in memory, a film is copied to a place that the caller
names, and both are refused where they hold more than their compressed bytes could.
"""

from __future__ import annotations

import json
import shutil
import zipfile
import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path, PurePosixPath

from engine.errors import FormatError
from engine.formats import film
from engine.formats.base.atomic import replacement
from engine.formats.base.content import content_of, require_file
from engine.formats.base.reading import AUTOMATIC, FASTEST_FPS, SLOWEST_FPS, Reading
from engine.formats.livelink import reader
from engine.formats.livelink.clock import FALLBACK_FPS
from engine.take import Take
from engine.words import counted

CARD = "take.json"
CARD_SAYS = {"slate", "subject", "videoTargetFrameRate", "startTimecode", "deviceModel", "calibrated"}
CALIBRATED, RAW, NEUTRAL = "_cal", "_raw", "_neutral"
KINDS = (CALIBRATED, RAW, NEUTRAL)
ADVICE = "Open the CSV file that you want."
MAX_ZIP_BYTES = 1 << 38
MAX_DIRECTORY_BYTES = 8 << 20  # of a zip's list of what it holds
MAX_TABLE_BYTES = 1 << 30
MAX_CARD_BYTES = 1 << 20
SMALL_BYTES, MAX_RATIO = 64 << 20, 100  # what any member may unpack to, and a larger one by its compressed bytes
MAX_FILES = 10_000  # in a folder
PIECE_BYTES = 1 << 20
SAME_RATE = 0.005  # a target of 60 fps is met by a recording of 59.94
FAULTS = (OSError, EOFError, RuntimeError, ValueError, NotImplementedError, zlib.error, zipfile.BadZipFile)


@dataclass(frozen=True)
class Parts:
    """What of a take lies together.

    Attributes
    ----------
    table : the file of its frames, calibrated where there is such a one
    calibrated, raw : the names of those files, where they are there
    film, card : the video, and what the app says of the take, where they are there
    """

    table: str
    calibrated: str | None
    raw: str | None
    film: str | None
    card: str | None


def is_one(path: Path) -> bool:
    """Whether a path leads to a take of several files: its folder, its zip, or one of them."""
    if path.suffix.lower() == ".zip" or _kind(path.name):
        return True
    if path.name.lower() == CARD:
        return bool(_said(path) & CARD_SAYS)
    return _is_folder(path) or (path.suffix.lower() in film.ENDINGS and has_table_beside(path))


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except OSError:  # a name that no file system takes
        return False


def has_table_beside(path: Path) -> bool:
    """Whether a film lies in the folder of a take that the app handed over."""
    try:
        tables = {name.casefold() for name in _listed(path.parent)}
    except FormatError:
        return False
    stem = path.stem.casefold().removesuffix("_iphone")
    return any(f"{base}{kind}.csv" in tables for base in (stem, path.stem.casefold()) for kind in (CALIBRATED, RAW))


def table_of(path: Path) -> Path:
    """Return the file in which the frames of a take are; the path itself where it is that, or a zip."""
    if path.suffix.lower() == ".zip" or _kind(path.name) in (CALIBRATED, RAW) or not is_one(path):
        return path
    folder, like = (_inner(path), None) if _is_folder(path) else (path.parent, path.name)
    return folder / _parts(_listed(folder), folder.name or str(folder), like).table


def _inner(folder: Path) -> Path:
    """Return the one folder in a folder of nothing else, as unzipping leaves it; else the folder itself."""
    try:
        inside = [entry for entry in islice(folder.iterdir(), MAX_FILES) if not entry.name.startswith((".", "__"))]
    except OSError:
        return folder
    return inside[0] if len(inside) == 1 and inside[0].is_dir() and not inside[0].is_symlink() else folder


def read(path: Path, report: Callable[[float], None] | None = None, reading: Reading = AUTOMATIC) -> Take:
    """Read the take of a folder, of a zip, or to which a file belongs; raises `FormatError`."""
    if path.suffix.lower() == ".zip":
        return _read_zip(path, report, reading)
    table = table_of(path)
    take = reader.read(table, report, reading)
    parts = _parts(_listed(table.parent), table.parent.name, like=table.name)
    card = _card(table.with_name(parts.card)) if parts.card is not None else None
    return _checked(take, parts, card, reading)


def copy_film(path: Path, folder: Path) -> Path | None:
    """Copy the film in a zip to a folder, under a name of its own, and return its path; None where there is none.

    Raises `FormatError` where the zip is damaged, or holds more than the disk or its bytes can.
    """
    with _opened(path) as archive:
        parts = _parts(archive.namelist(), path.name)
        if parts.film is None:
            return None
        info = archive.getinfo(parts.film)
        _require_possible(info, path, at_most=MAX_ZIP_BYTES)
        target = folder / f"{path.stem}-{info.CRC:08x}{_path(info.filename).suffix.lower()}"
        if target.is_file() and target.stat().st_size == info.file_size:
            return target
        folder.mkdir(parents=True, exist_ok=True)
        if shutil.disk_usage(folder).free < info.file_size + MAX_TABLE_BYTES:
            raise FormatError(f"There is no room on the disk for the film in {path.name}.", "Make room, or unzip it.")
        try:
            with replacement(target) as temporary, archive.open(info) as source, temporary.open("wb") as copy:
                left = info.file_size
                while left > 0 and (piece := source.read(min(PIECE_BYTES, left))):
                    copy.write(piece)
                    left -= len(piece)
        except FAULTS as error:
            raise FormatError(f"The film in {path.name} is damaged.", "Unzip it, and attach the film.") from error
        return target


def _read_zip(path: Path, report: Callable[[float], None] | None, reading: Reading) -> Take:
    with _opened(path) as archive:
        parts = _parts(archive.namelist(), path.name)
        content = _member(archive, parts.table, path, at_most=MAX_TABLE_BYTES)
        written = _member(archive, parts.card, path, at_most=MAX_CARD_BYTES) if parts.card is not None else None
    name = Path(_path(parts.table).name)
    take = reader.parse(content, name, report, reading)
    return _checked(take, parts, _rate_in(written), reading)


def _checked(take: Take, parts: Parts, target_fps: float | None, reading: Reading) -> Take:
    """Return a take with what is to be said of its files, and with the target rate where its clock tells none."""
    sentences = []
    name = _path(parts.table).name
    if parts.table == parts.calibrated and parts.raw is not None:
        sentences.append(f"{name}, the calibrated file of the take, was opened; the raw one lies beside it.")
    elif parts.table == parts.raw:
        other = f"; {_path(parts.calibrated).name} is the calibrated one" if parts.calibrated is not None else ""
        sentences.append(f"{name} is the raw file of the take{other}.")
    if target_fps is not None and reading.fps is None:
        assumed = any("row by row" in notice or notice.startswith(("One frame", "The rows")) for notice in take.notices)
        if assumed and take.fps == FALLBACK_FPS:
            kept = [notice for notice in take.notices if "row by row" not in notice]
            notices = (f"Taken as {target_fps:g} fps, from {CARD}; the timecodes make no sense.", *kept, *sentences)
            return replace(take, fps=target_fps, notices=notices)
        if abs(target_fps / take.fps - 1) > SAME_RATE:
            sentences.append(
                f"{CARD} says {target_fps:g} fps, the timecodes {take.fps:.5g}; the timecodes are believed."
            )
    return replace(take, notices=(*take.notices, *sentences))


# --- what lies together


def _parts(names: Iterable[str], where: str, like: str | None = None) -> Parts:
    """Return what of the one take there is; `like` a file of it where there may be several."""
    listed = [name for name in names if not _path(name).name.startswith((".", "__MACOSX"))]
    listed = [name for name in listed if "__MACOSX" not in name and not name.endswith("/")]
    tables = sorted((name for name in listed if name.lower().endswith(".csv")), key=lambda name: name.casefold())
    like_stem = _stem(like) if like is not None and _path(like).name.lower() != CARD else None
    groups: dict[tuple[str, str], list[str]] = {}
    for name in tables:
        if like_stem is None or _stem(name) == like_stem:
            groups.setdefault((str(_path(name).parent), _stem(name)), []).append(name)
    known = {key: group for key, group in groups.items() if any(_kind(name) in (CALIBRATED, RAW) for name in group)}
    groups = known or groups
    if not groups:
        raise FormatError(f"{where} holds no take.", "A take is a CSV file that Live Link Face records.")
    if len(groups) > 1:
        raise FormatError(f"{where} holds {counted(len(groups), 'take')}.", ADVICE)
    (folder, stem), group = next(iter(groups.items()))
    table = like if like in group and _kind(like or "") != NEUTRAL else _best(group)
    beside = [name for name in listed if str(_path(name).parent) == folder]
    films = [name for name in beside if _path(name).suffix.lower() in film.ENDINGS]
    own = [name for name in films if _stem(name) == stem]
    card = next((name for name in beside if _path(name).name.lower() == CARD), None)
    chosen = own[0] if own else films[0] if len(films) == 1 and card is not None else None
    by_kind = {_kind(name): name for name in group}
    return Parts(table or group[0], by_kind.get(CALIBRATED), by_kind.get(RAW), chosen, card)


def _best(group: list[str]) -> str:
    order = {CALIBRATED: 0, "": 1, RAW: 2, NEUTRAL: 3}
    best = min(group, key=lambda name: order[_kind(name)])
    if _kind(best) == NEUTRAL:
        raise FormatError(f"{_path(best).name} is a face at rest, and its take is not beside it.", ADVICE)
    return best


def _path(name: str) -> PurePosixPath:
    return PurePosixPath(name.replace("\\", "/"))


def _kind(name: str) -> str:
    """Return which table of a take a file is by its name; empty where it is a take's only one, or no table."""
    lower = name.lower()
    return next((kind for kind in KINDS if lower.endswith(f"{kind}.csv")), "")


def _stem(name: str) -> str:
    """Return the name that the files of a take have in common."""
    return film.common_stem(_path(name).stem)


def _listed(folder: Path) -> list[str]:
    try:
        names = []
        for number, entry in enumerate(folder.iterdir()):
            if number >= MAX_FILES:
                raise FormatError(f"{folder.name} holds more than {MAX_FILES:,} files.", ADVICE)
            if entry.is_file():
                names.append(entry.name)
    except OSError as error:
        reason = (error.strerror or "unknown reason").lower()
        raise FormatError(f"{folder.name} could not be read: {reason}.") from error
    return names


# --- take.json


def _card(path: Path) -> float | None:
    try:
        return _rate_in(content_of(path, at_most=MAX_CARD_BYTES))
    except FormatError:
        return None  # the timecodes tell the rate


def _said(path: Path) -> set[str]:
    """Return what a card says something of; mouth cues may have its name too, and say none of it."""
    try:
        card = json.loads(content_of(path, at_most=MAX_CARD_BYTES))
    except (FormatError, ValueError, RecursionError):
        return set()
    return set(card) if isinstance(card, dict) else set()


def _rate_in(content: bytes | None) -> float | None:
    """Return the frames per second that a take's card says, None where it says none that can be."""
    try:
        card = json.loads(content or b"{}")
        rate = float(card["videoTargetFrameRate"])
    except (ValueError, TypeError, KeyError, RecursionError, OverflowError):
        return None
    return rate if SLOWEST_FPS <= rate <= FASTEST_FPS else None


# --- zips


def _opened(path: Path) -> zipfile.ZipFile:
    """Open a zip, whose list of members must be of a size that lists have."""
    require_file(path, at_most=MAX_ZIP_BYTES)
    try:
        with path.open("rb") as file:
            size = file.seek(0, 2)
            file.seek(max(0, size - (1 << 16) - 22))
            tail = file.read()
        at = tail.rfind(b"PK\x05\x06")
        listed = int.from_bytes(tail[at + 12 : at + 16], "little") if at >= 0 else 0
        wide = tail.rfind(b"PK\x06\x06")
        if listed == 0xFFFFFFFF:
            listed = int.from_bytes(tail[wide + 40 : wide + 48], "little") if wide >= 0 else listed
        if listed > MAX_DIRECTORY_BYTES:
            raise FormatError(f"{path.name} holds more files than a take has.", ADVICE)
        return zipfile.ZipFile(path)
    except FAULTS as error:
        raise FormatError(f"{path.name} is no zip file, or damaged.", "Unzip it, and open the folder.") from error


def _require_possible(info: zipfile.ZipInfo, path: Path, *, at_most: int) -> None:
    """Refuse a member that is locked, packed in an unusual way, or larger than its bytes can be."""
    if info.flag_bits & 1:
        raise FormatError(f"{path.name} is locked with a password.", "Unzip it, and open the folder.")
    if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise FormatError(f"{path.name} is packed in a way that is not read here.", "Unzip it, and open the folder.")
    if info.file_size > min(at_most, max(SMALL_BYTES, MAX_RATIO * info.compress_size)):
        raise FormatError(f"{path.name} declares more than it can hold.")


def _member(archive: zipfile.ZipFile, name: str, path: Path, *, at_most: int) -> bytes:
    """Return what a member holds; never more than it declares."""
    info = archive.getinfo(name)
    _require_possible(info, path, at_most=at_most)
    try:
        with archive.open(info) as member:
            content = member.read(info.file_size + 1)
    except FAULTS as error:
        raise FormatError(f"{_path(name).name} in {path.name} is damaged.") from error
    if len(content) != info.file_size:
        raise FormatError(f"{_path(name).name} in {path.name} is damaged.")
    return content
