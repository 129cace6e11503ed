"""What becomes of requests that no face fits: exaggerated, contradictory, noisy (BSBS19 section 5.3)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from engine.anatomy import impossible
from engine.controls import bundled_measurer
from engine.lab.corpus import Piece, data_folder, split, whole_faces
from engine.lab.evaluate.plausibility import Recorded, recorded
from engine.lab.evaluate.regress import (
    EYES_MM,
    LIDS,
    LIPS,
    MOUTH_MM,
    Method,
    Report,
    editor,
    known_of,
    methods,
    pieces_to_measure,
)
from engine.regress.areas import AREAS
from engine.take import SHAPES, Array

Row = dict[str, Any]
Request = Callable[[Array], Array]  # control curves, (frames, 8) in mm, to what is asked instead

PARTS = {
    "mouth": np.concatenate([area.shape_columns for area in AREAS if not area.needs_whole_face]),
    "eyes": np.concatenate([area.shape_columns for area in AREAS if area.needs_whole_face]),
}

MOUTH = AREAS[0].control_columns  # the controls that a take of the mouth alone animates


def _times(factor: float) -> Request:
    rest = bundled_measurer().measure(np.zeros((1, len(SHAPES))))
    return lambda controls: np.asarray(np.maximum(rest + factor * (controls - rest), 0.0))


def _contradictory(controls: Array) -> Array:
    """Each control from another moment of the take, about two seconds further for each."""
    return np.stack([np.roll(curve, 61 * index) for index, curve in enumerate(controls.T)], axis=1)


def _salt_and_pepper(controls: Array) -> Array:
    """A fifth of all values thrown to the lowest or highest of the take."""
    rng = np.random.default_rng(0)
    thrown = np.where(rng.random(controls.shape) < 0.5, controls.min(axis=0), controls.max(axis=0))
    return np.asarray(np.where(rng.random(controls.shape) < 0.2, thrown, controls))


REQUESTS: dict[str, Request] = {
    "none": lambda controls: controls,
    "x2": _times(2.0),
    "x3": _times(3.0),
    "contradictory": _contradictory,
    "salt_and_pepper": _salt_and_pepper,
}


def table(data: Path | None, report: Report) -> list[Row]:
    """Return a row for each request and method, and one for the takes as they were recorded.

    `unlike_mouth_mm` and `unlike_eyes_mm` are mean distances to the nearest stretch of the training takes (which must be
    at hand), `times_recorded` their mean ratio to those of the recorded row; `impossible` is the share of frames with a
    pair of shapes that exclude each other; `missed_mm` the root mean square by which controls miss what was asked.
    `closures_kept_*` is the share of closures which are in the take and in the request, and in what came of it too;
    `closures_invented_*` how many came that are in neither, to each of these; means over the thresholds of `regress` below
    which any is.
    Weights are held to 0..1, as the editor holds them.
    """
    pieces = pieces_to_measure(data)
    judge = Judge(pieces, split(data_folder())[0])
    rows: list[Row] = [{"method": "recorded", "request": "none"} | judge.base | {"times_recorded": 1.0}]
    for name, method in ({"editor": editor} | methods(report)).items():  # asked of nothing, the editor does nothing
        for request, ask in REQUESTS.items():
            rows.append({"method": name, "request": request} | judge.figures(method, ask))
        report(f"measured {name}")
    return rows


def requested(method: Method, ask: Request, piece: Piece) -> tuple[Array, Array]:
    """Return what was asked, (frames, 8) in mm, and the face a method makes of it, (frames, 52)."""
    known = known_of(piece)
    asked = ask(known.controls)
    made = np.clip(method(asked, known), 0.0, 1.0)
    whole = np.array(piece.weights)
    for columns in (PARTS["mouth"], PARTS["eyes"]) if piece.whole_face else (PARTS["mouth"],):
        whole[:, columns] = made[:, columns]
    return asked, whole


class Judge:
    """How far the faces that a method makes of requests are from recorded ones, beside pieces as they were recorded.

    Parameters
    ----------
    pieces : whose controls are changed into requests
    training : recordings among which the nearest are looked for
    """

    def __init__(self, pieces: Sequence[Piece], training: Sequence[Piece]) -> None:
        self._pieces = pieces
        self._banks = {
            part: recorded([p.weights for p in (whole_faces(training) if part == "eyes" else training)], columns)
            for part, columns in PARTS.items()
        }
        self.base = _figures([piece.weights for piece in pieces], pieces, self._banks)

    def figures(self, method: Method, ask: Request) -> Row:
        """Return what a row of `table` says of a method and a request."""
        results = [requested(method, ask, piece) for piece in self._pieces]
        figures = _figures([made for _, made in results], self._pieces, self._banks)
        missed = [
            (bundled_measurer().measure(made) - asked)[:, slice(None) if piece.whole_face else MOUTH].reshape(-1)
            for (asked, made), piece in zip(results, self._pieces, strict=True)
        ]
        ratios = [figures[key] / self.base[key] for key in ("unlike_mouth_mm", "unlike_eyes_mm") if self.base.get(key)]
        return (
            figures
            | _closures(results, self._pieces)
            | {
                "missed_mm": float(np.sqrt((np.concatenate(missed) ** 2).mean())),
                "times_recorded": float(np.mean(ratios)),
            }
        )


def _figures(made: Sequence[Array], pieces: Sequence[Piece], banks: dict[str, Recorded]) -> Row:
    figures: Row = {}
    for part, bank in banks.items():
        chosen = [one for one, piece in zip(made, pieces, strict=True) if piece.whole_face or part == "mouth"]
        if chosen:
            distances = np.concatenate([bank.distance_mm(one) for one in chosen])
            figures[f"unlike_{part}_mm"] = float(distances.mean())
    figures["impossible"] = float(np.concatenate([impossible(one) for one in made]).mean())
    return figures


def _closures(results: Sequence[tuple[Array, Array]], pieces: Sequence[Piece]) -> Row:
    """Return what became of closures, of (asked, made) of each piece."""
    figures: Row = {}
    for part, columns, thresholds in (("mouth", LIPS, MOUTH_MM), ("eyes", LIDS, EYES_MM)):
        counted = []
        for (asked, made), piece in zip(results, pieces, strict=True):
            if piece.whole_face or part == "mouth":
                faces = (asked, *(bundled_measurer().measure(one) for one in (piece.weights, made)))
                counted.append([_counted(*(face[:, columns] for face in faces), below=mm) for mm in thresholds])
        if counted:
            counts = np.sum(counted, axis=0).astype(float)
            both, kept, invented = counts[counts[:, 0] > 0].T  # a threshold below which nothing closes tells nothing
            if len(both):
                figures[f"closures_kept_{part}"] = float((kept / both).mean())
                figures[f"closures_invented_{part}"] = float((invented / both).mean())
    return figures


def _counted(asked: Array, recorded: Array, made: Array, *, below: float) -> tuple[int, int, int]:
    """Return how many distances are closed in take and request, of these in what came of it, and in that alone."""
    both = (asked < below) & (recorded < below)
    neither = (asked >= below) & (recorded >= below)
    return int(both.sum()), int((both & (made < below)).sum()), int((neither & (made < below)).sum())
