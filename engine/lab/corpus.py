"""The recorded takes and their fixed splits: what is trained on, what is only ever measured on."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from engine import assets
from engine.errors import EngineError
from engine.formats import livelink
from engine.lab import facegood
from engine.models.resample import to_model_rate
from engine.take import MODEL_FPS, Array, Mask, Take, runs

TEST = ("alex_rom_4", "facial", "1114_3_16")
NEVER_TRAINED = (
    "slate_3",
)  # a person and a rate that nothing is trained or tuned on, and no part of the fixed test split
VALIDATION_SHARE = 0.15  # the last part of each training take
SHORTEST = 16  # frames; what lies between two lost runs closer than this tells nothing of motion


@dataclass(frozen=True, eq=False)
class Piece:
    """An unbroken stretch of a take at the model rate.

    Attributes
    ----------
    weights : (frames, 52) float64, clamped to 0..1
    whole_face : False where the take animates the mouth and jaw alone
    source : name of the take
    first : frame of the take, at the model rate, at which it begins
    """

    weights: Array
    whole_face: bool
    source: str
    first: int = 0


def data_folder() -> Path:
    """Return the folder of recorded takes: `RETAKE_DATA`, else `../shared/data` beside the project."""
    named = os.environ.get("RETAKE_DATA")
    return Path(named) if named else assets.RECORDINGS


def load_takes(folder: Path) -> list[tuple[Take, bool]]:
    """Return every take below a folder and whether it shows the whole face; raises `EngineError` if there is none."""
    takes = [(livelink.read(path), True) for path in sorted(folder.rglob("*.csv")) if path.stem != "arkit_mapping"]
    takes += [
        (facegood.read(path), False)
        for path in sorted(folder.rglob("*.npz"))
        if path.with_name("arkit_mapping.csv").exists()
    ]
    if not takes:
        raise EngineError(
            f"There are no takes in {folder.name or folder}.",
            "Name a folder of Live Link Face CSV files with --data, or set RETAKE_DATA.",
        )
    return takes


def pieces_of(take: Take, *, whole_face: bool) -> list[Piece]:
    """Cut lost runs out of a take and bring the rest to the model rate."""
    resampled, lost = to_model_rate(take)
    kept: Mask = ~lost
    return [
        Piece(np.clip(resampled[start:stop], 0.0, 1.0), whole_face, Path(take.name).stem, start)
        for start, stop in runs(kept)
        if stop - start >= SHORTEST
    ]


def split(folder: Path) -> tuple[list[Piece], list[Piece], list[Piece]]:
    """Return training, validation and test pieces of the recorded takes."""
    training: list[Piece] = []
    validation: list[Piece] = []
    test: list[Piece] = []
    for take, whole_face in load_takes(folder):
        if Path(take.name).stem in NEVER_TRAINED:
            continue
        pieces = pieces_of(take, whole_face=whole_face)
        if Path(take.name).stem in TEST:
            test += pieces
        else:
            early, late = _divide(pieces)
            training += early
            validation += late
    return training, validation, test


def pieces_to_measure(data: Path | None) -> list[Piece]:
    """Return the test split, or every take in a folder cut at its lost runs."""
    if data is None:
        return split(data_folder())[2]
    return [piece for take, whole in load_takes(data) for piece in pieces_of(take, whole_face=whole)]


def _divide(pieces: list[Piece]) -> tuple[list[Piece], list[Piece]]:
    border = int((1 - VALIDATION_SHARE) * sum(len(piece.weights) for piece in pieces))
    early: list[Piece] = []
    late: list[Piece] = []
    seen = 0
    for piece in pieces:
        cut = int(np.clip(border - seen, 0, len(piece.weights)))
        seen += len(piece.weights)
        for part, first, target in ((piece.weights[:cut], 0, early), (piece.weights[cut:], cut, late)):
            if len(part) >= SHORTEST:
                target.append(Piece(part, piece.whole_face, piece.source, piece.first + first))
    return early, late


def rest_of(pieces: Iterable[Piece], piece: Piece, start: int, stop: int) -> list[Array]:
    """Return all that pieces hold of the take that a piece was cut from, (frames, 52) each, but its frames [start, stop)."""
    rest = []
    for other in pieces:
        if other.source == piece.source:
            cut = np.clip(np.array([start, stop]) + piece.first - other.first, 0, len(other.weights))
            rest += [part for part in (other.weights[: cut[0]], other.weights[cut[1] :]) if len(part) >= SHORTEST]
    return rest


def person_of(source: str) -> str:
    """Return whose take it is: takes of a person are named after them, and numbered behind an underscore."""
    return source.split("_", maxsplit=1)[0]


def whole_faces(pieces: Iterable[Piece]) -> list[Piece]:
    """Return the pieces that animate more than mouth and jaw."""
    return [piece for piece in pieces if piece.whole_face]


def recorded_seconds(pieces: Iterable[Piece]) -> dict[str, float]:
    """Return how much pieces hold of each take, by its name, as a network's card says it."""
    frames: dict[str, int] = {}
    for piece in pieces:
        frames[piece.source] = frames.get(piece.source, 0) + len(piece.weights)
    return {source: round(count / MODEL_FPS, 1) for source, count in frames.items()}
