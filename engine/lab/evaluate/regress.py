"""Control curves to weights: our regressor and full system against their baselines (BSBS19 table 1 and figure 8)."""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from engine.controls import CONTROL_INDEX, CONTROLS, bundled_measurer
from engine.editing import Dragger
from engine.errors import EngineError
from engine.extended import bundled_face
from engine.lab.corpus import Piece, data_folder, load_takes, pieces_of, split
from engine.lab.evaluate import metrics
from engine.lab.evaluate.baselines import NAMES
from engine.lab.evaluate.baselines.nearest import Nearest
from engine.lab.evaluate.intervals import intervals_of
from engine.regress import infer
from engine.regress.areas import AREAS
from engine.take import MODEL_FPS, Array, Take

MOUTH_MM = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0)
EYES_MM = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0)
LIPS = [CONTROL_INDEX["lips_vertical"]]
LIDS = [CONTROL_INDEX["eyelid_right"], CONTROL_INDEX["eyelid_left"]]

Row = dict[str, Any]
Report = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Known:
    """What an editor knows of the take whose controls it changes.

    Attributes
    ----------
    kept : (frames, 52) weights of the shapes that no method makes, the others zero
    controls : (frames, 8) mm, as recorded, whatever is asked instead
    every : (frames, 16), these and the extended ones, as recorded
    weights : (frames, 52) as recorded, for a method that edits them
    whole_face : whether they animate more than the mouth
    """

    kept: Array
    controls: Array
    every: Array
    weights: Array
    whole_face: bool


Method = Callable[[Array, Known], Array]  # asked controls, (frames, 8) in mm, to weights, (frames, 52)


def pieces_to_measure(data: Path | None) -> list[Piece]:
    """Return the test split, or every take in a folder cut at its lost runs."""
    if data is None:
        return split(data_folder())[2]
    return [piece for take, whole in load_takes(data) for piece in pieces_of(take, whole_face=whole)]


def methods(report: Report) -> dict[str, Method]:
    """Return every method by row name; those that need the recorded takes only where these are.

    Ours know where the eyes look, which no edit of these curves moves; those named `_16` are given the extended controls
    of the take too. `full` knows what the curves of the take did before the edit, and does not hold that to be too much;
    `alone` is the same without what is done for contacts once the networks have spoken.
    """
    ours = infer.bundled()
    found: dict[str, Method] = {
        "regressor": lambda controls, take: ours.infer(controls, full=False, kept=take.kept),
        "full": full(ours),
        "full_of_curves": lambda controls, take: ours.infer(controls, kept=take.kept),
        "alone": lambda controls, take: ours.infer(controls, kept=take.kept, original=take.controls, land=False),
        "regressor_16": lambda controls, take: ours.infer(_with_extended(controls, take), full=False, kept=take.kept),
        "full_16": lambda controls, take: ours.infer(
            _with_extended(controls, take), kept=take.kept, original=take.every
        ),
    }
    for name in NAMES:
        baseline = importlib.import_module(f"engine.lab.evaluate.baselines.{name.removesuffix('_16')}")
        if name.endswith("_16"):
            found[name] = _of_sixteen(baseline.load(every=True).infer)
        else:
            found[name] = of_controls(baseline.load().infer)
    try:
        found["nearest"] = of_controls(Nearest(split(data_folder())[0]).infer)
    except EngineError:
        report("nearest is left out: it is the recorded training takes themselves, which are not here (RETAKE_DATA)")
    return found


def full(ours: infer.Regressor) -> Method:
    """Return the full system of networks, which knows the take."""
    return lambda controls, take: ours.infer(controls, kept=take.kept, original=take.controls)


def _with_extended(controls: Array, take: Known) -> Array:
    """Return asked curves, (frames, 8), and beside them the extended ones of the take."""
    return np.concatenate([controls, take.every[:, controls.shape[1] :]], axis=1)


def _of_sixteen(infer: Callable[[Array], Array]) -> Method:
    return lambda controls, take: infer(_with_extended(controls, take))


def editor(controls: Array, take: Known) -> Array:
    """Return what the editor makes of a take when these controls are asked of it at its default believability."""
    asked = np.array(controls)
    if not take.whole_face:
        asked[:, LIDS] = np.nan
    return Dragger(Take(weights=take.weights, fps=MODEL_FPS)).drag(0, asked).weights


def of_controls(infer: Callable[[Array], Array]) -> Method:
    """Return a method that looks at controls alone."""
    return lambda controls, _: infer(controls)


def known_of(piece: Piece) -> Known:
    """Return what an edit leaves as it was in a piece, the shapes of all areas zero, and its recorded controls."""
    kept = np.array(piece.weights)
    for area in AREAS:
        kept[:, area.shape_columns] = 0.0
    every = bundled_face().measure(piece.weights)
    return Known(kept, every[:, : len(CONTROLS)], every, piece.weights, piece.whole_face)


def played(method: Method, piece: Piece) -> Array:
    """Return a piece's weights, (frames, 52), as a method remakes them from its controls.

    Weights are held to 0..1, as the editor holds them; shapes of no area, gaze among them, stay as recorded.
    """
    known = known_of(piece)
    made = method(known.controls, known)
    whole = np.array(piece.weights)
    for area in AREAS:
        if piece.whole_face or not area.needs_whole_face:
            whole[:, area.shape_columns] = np.clip(made[:, area.shape_columns], 0.0, 1.0)
    return whole


def table(data: Path | None, report: Report) -> list[Row]:
    """Return one row a method: mean squared error of each area, closures kept and invented.

    `closure_tpr_*` and `closure_fpr_*` are means over the thresholds `MOUTH_MM` and `EYES_MM`; a rate is null where the
    takes have no closure at all, an error where they do not animate the area. `*_low` and `*_high` are the bounds of 95 of
    100 draws of as many stretches of ten seconds as the takes have.
    """
    pieces = pieces_to_measure(data)
    return [{"method": name} | figures_of(method, pieces, intervals=True) for name, method in methods(report).items()]


def figures_of(method: Method, pieces: Sequence[Piece], *, intervals: bool = False) -> Row:
    """Return the metrics of one row of `table`, with their intervals or without."""
    made = [played(method, piece) for piece in pieces]
    figures = _measured(made, pieces)
    if intervals:
        figures |= intervals_of(_measured, made, pieces)
    return figures


def _measured(made: Sequence[Array], pieces: Sequence[Piece]) -> Row:
    faces = [index for index, piece in enumerate(pieces) if piece.whole_face]
    figures: Row = {}
    for area in AREAS:
        chosen = faces if area.needs_whole_face else list(range(len(pieces)))
        errors = [((made[index] - pieces[index].weights)[:, area.shape_columns] ** 2).reshape(-1) for index in chosen]
        figures[f"mse_{area.name}"] = float(np.concatenate(errors).mean()) if errors else None
    for part, closures in measured_closures(made, pieces).items():
        figures[f"closure_tpr_{part}"] = _mean(closures.tpr)
        figures[f"closure_fpr_{part}"] = _mean(closures.fpr)
    return figures


def measured_closures(made: Sequence[Array], pieces: Sequence[Piece]) -> dict[str, metrics.Closures]:
    """Return the closures of the mouth, and of the eyes where the takes animate them."""
    measure = bundled_measurer().measure
    pairs = [(measure(one), measure(piece.weights)) for one, piece in zip(made, pieces, strict=True)]
    eyes = [pair for pair, piece in zip(pairs, pieces, strict=True) if piece.whole_face]
    found = {}
    for part, chosen, columns, thresholds in (("mouth", pairs, LIPS, MOUTH_MM), ("eyes", eyes, LIDS, EYES_MM)):
        one, other = (
            np.concatenate([np.zeros((0, len(columns))), *(pair[side][:, columns] for pair in chosen)])
            for side in (0, 1)
        )
        found[part] = metrics.closures(one, other, thresholds)
    return found


def _mean(rates: Array) -> float | None:
    known = [float(rate) for rate in rates if not math.isnan(rate)]
    return sum(known) / len(known) if known else None
