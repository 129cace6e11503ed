"""Edits that a person would make: what was asked and reached, what else moved, and how like a face it is."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from engine.anatomy import impossible
from engine.character import bundled
from engine.editing import Dragger, warm_up
from engine.errors import EngineError
from engine.extended import bundled_face
from engine.lab.corpus import Piece, data_folder, split, whole_faces
from engine.lab.evaluate.edits.catalogue import EASE_FRAMES, KINDS, SPEAKS_OF, Scripted, scripted
from engine.lab.evaluate.plausibility import STRETCH, Recorded, recorded
from engine.lab.evaluate.regress import pieces_to_measure
from engine.lab.evaluate.regress_edits import PARTS
from engine.lab.reporting import Report, Row
from engine.regress.plausibility import DEFAULT_BELIEVABILITY
from engine.take import MODEL_FPS, Array, Take

MODES: dict[str, dict[str, float]] = {
    "default": {"believability": DEFAULT_BELIEVABILITY},
    "exact": {"believability": 0.0},
    "as recorded": {"believability": 1.0},
}
UNMOVED_MM = 0.1  # vertices that the shapes an edit speaks of move by less are beside it
NEAR = 150  # frames on either side whose own motion an edit's ends are held against
AROUND_S = 0.5  # beyond what is asked, that is looked at
EVERY = 4  # vertices between those on which motion is measured
_SURFACE = bundled().deltas[:, np.flatnonzero(np.abs(bundled().deltas).max(axis=(0, 2)) > UNMOVED_MM)[::EVERY]]


@dataclass(frozen=True, eq=False)
class Made:
    """What became of an edit.

    Attributes
    ----------
    edit : what was asked
    weights : (frames of the piece, 52)
    ms : how long each of its drags took
    """

    edit: Scripted
    weights: Array
    ms: tuple[float, ...]

    @property
    def reach(self) -> slice:
        """The frames that may have moved, with one more at either side."""
        beyond = EASE_FRAMES + round(AROUND_S * MODEL_FPS) + 1
        return slice(max(0, self.edit.frames[0] - beyond), min(len(self.weights), self.edit.frames[1] + beyond))


def make(edit: Scripted, mode: Mapping[str, float]) -> Made:
    """Carry out an edit as a person would: one control after another, all of them asked of the take as it was."""
    take, spent = Take(weights=edit.piece.weights, fps=MODEL_FPS), []
    dragger, wish = Dragger(take), np.full_like(edit.asked, np.nan)
    patch = None
    for column in np.flatnonzero(~np.isnan(edit.asked).all(axis=0)):
        wish[:, column] = edit.asked[:, column]
        rows = np.flatnonzero(~np.isnan(wish).all(axis=1))
        began = time.perf_counter()
        patch = dragger.drag(int(rows[0]), wish[rows[0] : rows[-1] + 1], **mode)
        spent.append((time.perf_counter() - began) * 1e3)
    assert patch is not None
    return Made(edit, np.asarray(patch.apply(take).weights), tuple(spent))


def table(data: Path | None, report: Report) -> list[Row]:
    """Return a row for each way of editing, then one for each kind of edit and way.

    `asked_mm` is the largest change asked of a control, `missed_mm` the root mean square by which controls miss it over
    the edit's frames, `missed_peak_mm` the same where most was asked, `reached` which share of it was reached there.
    `beside_*` is what moved that the edit does not speak of: mean change of a weight, mean and largest move of a vertex.
    `step_mm` is the largest move of the surface from frame to frame where the edit comes and goes, `step_before_mm`
    there before, `step_take_mm` anywhere within some seconds of it. `notch_mm` is the furthest that the surface leaves the
    middle of the frames beside at the asked frames, `notch_added_mm` what the edit alone does so (the take moves there too),
    `notch_take_mm` what the take does so in one frame of a hundred. `possible` is the share of what is asked that any
    weights in 0..1 reach, `reached_of_possible` what was reached of that.
    `impossible` is the share of frames that hold a pair of shapes
    that exclude each other, less that before; `unlike_mm` how far the motion is from the nearest stretch of the training
    takes, `unlike_before_mm` how far it was (null where these are not at hand). `ms` is the mean time of a drag.
    """
    return measured(pieces_to_measure(data), report)


def measured(pieces: Sequence[Piece], report: Report) -> list[Row]:
    """Return the rows of `table` for some pieces."""
    warm_up()
    edits, banks = scripted(pieces), _banks(report)
    rows, totals = [], []
    possible = [min(1.0, _reached(make(edit, MODES["exact"]))["reached"]) for edit in edits]
    for name, mode in MODES.items():
        made = [make(edit, mode) for edit in edits]
        figures = [_figures(one, banks) | {"possible": most} for one, most in zip(made, possible, strict=True)]
        for row in figures:
            row["reached_of_possible"] = row["reached"] / max(row["possible"], 1e-3)
        totals.append({"edits": "all", "method": name} | _mean(figures))
        for kind in KINDS:
            of_kind = [row for row, edit in zip(figures, edits, strict=True) if edit.kind is kind]
            rows += [{"edits": kind.name, "method": name} | _mean(of_kind)] if of_kind else []
        report(f"made {len(made)} edits: {name}")
    return totals + rows


def _banks(report: Report) -> dict[str, Recorded]:
    """Return the training takes' stretches of mouth and eyes; nothing where they are not at hand."""
    try:
        training = split(data_folder())[0]
    except EngineError:
        report("unlike_mm is left out: the recorded training takes are not here (RETAKE_DATA)")
        return {}
    return {
        part: recorded([piece.weights for piece in (whole_faces(training) if part == "eyes" else training)], columns)
        for part, columns in PARTS.items()
    }


def _mean(figures: Sequence[Row]) -> Row:
    row: Row = {"count": len(figures)}
    for key in figures[0]:
        values = np.array([one[key] for one in figures if one[key] is not None])
        squared = key.startswith("missed")
        row[key] = float(np.sqrt((values**2).mean()) if squared else values.mean()) if len(values) else None
    return row


def _figures(made: Made, banks: Mapping[str, Recorded]) -> Row:
    return _reached(made) | _beside(made) | _steps(made) | _likeness(made, banks) | {"ms": float(np.mean(made.ms))}


def _reached(made: Made) -> Row:
    frames = slice(*made.edit.frames)
    before, after = (bundled_face().measure(one[frames]) for one in (made.edit.piece.weights, made.weights))
    asked = made.edit.asked[frames]
    columns = ~np.isnan(asked).all(axis=0)
    change, missing = (asked - before)[:, columns], (after - asked)[:, columns]
    peak = np.argmax(np.abs(change), axis=0), np.arange(change.shape[1])
    return {
        "asked_mm": float(np.abs(change).max()),
        "missed_mm": float(np.sqrt((missing**2).mean())),
        "missed_peak_mm": float(np.sqrt((missing[peak] ** 2).mean())),
        "reached": float(1 + (missing[peak] * np.sign(change[peak])).sum() / np.abs(change[peak]).sum()),
    }


def _beside(made: Made) -> Row:
    spoken_of = SPEAKS_OF[made.edit.kind.part]
    moved = (made.weights - made.edit.piece.weights)[made.reach]
    still = np.abs(_SURFACE[spoken_of]).max(axis=(0, 2)) < UNMOVED_MM
    path = np.linalg.norm(np.einsum("fs,svx->fvx", moved, _SURFACE[:, still]), axis=-1)
    return {
        "beside_weight": float(np.abs(moved[:, ~spoken_of]).mean()),
        "beside_mm": float(path.mean()),
        "beside_most_mm": float(path.max()),
    }


def _steps(made: Made) -> Row:
    start = max(0, made.edit.frames[0] - NEAR)
    first, last = made.edit.frames[0] - start, made.edit.frames[1] - start
    reach = made.reach.start - start, made.reach.stop - start
    at_ends = np.r_[reach[0] : first, last - 1 : reach[1] - 1]
    near = slice(start, made.edit.frames[1] + NEAR)
    before, after = (_step_mm(one[near]) for one in (made.edit.piece.weights, made.weights))
    return {
        "step_mm": float(after[at_ends].max()),
        "step_before_mm": float(before[at_ends].max()),
        "step_take_mm": float(before.max()),
        "notch_mm": float(_notch_mm(made.weights[near])[first - 1 : last - 1].max()),
        "notch_added_mm": float(_notch_mm((made.weights - made.edit.piece.weights)[near])[first - 1 : last - 1].max()),
        "notch_take_mm": float(np.quantile(_notch_mm(made.edit.piece.weights), 0.99)),
    }


def _notch_mm(weights: Array) -> Array:
    """Return how far the surface leaves the middle of the frames beside, at most, (frames - 2,) in mm."""
    bent = np.diff(weights, n=2, axis=0) @ _SURFACE.reshape(len(_SURFACE), -1) / 2
    return np.asarray(np.linalg.norm(bent.reshape(len(bent), -1, 3), axis=-1).max(axis=1))


def _step_mm(weights: Array) -> Array:
    """Return the largest move of the surface from each frame to the next, (frames - 1,) in mm."""
    moved = np.diff(weights, axis=0) @ _SURFACE.reshape(len(_SURFACE), -1)
    return np.asarray(np.linalg.norm(moved.reshape(len(moved), -1, 3), axis=-1).max(axis=1))


def _likeness(made: Made, banks: Mapping[str, Recorded]) -> Row:
    before, after = made.edit.piece.weights[made.reach], made.weights[made.reach]
    bank = banks.get("eyes" if made.edit.kind.needs_whole_face else "mouth")
    far = [float(bank.distance_mm(one).mean()) if bank and len(one) >= STRETCH else None for one in (before, after)]
    return {
        "impossible": float(impossible(after).mean() - impossible(before).mean()),
        "unlike_before_mm": far[0],
        "unlike_mm": far[1],
    }
