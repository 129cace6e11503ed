"""Picture sheets of the scripted edits: each face before and after where most is asked."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from engine.character import bundled
from engine.controls import ALL_CONTROLS
from engine.editing import warm_up
from engine.extended import bundled_face
from engine.lab.corpus import pieces_to_measure
from engine.lab.evaluate.edits.catalogue import KINDS, PLACES, scripted
from engine.lab.evaluate.edits.table import Made, make
from engine.lab.evaluate.plots import pyplot
from engine.lab.reporting import Report
from engine.take import Array

KINDS_PER_SHEET = 5
LEFT, RIGHT, BELOW, ABOVE = -68.0, 68.0, -130.0, 45.0  # mm of the face that is shown
LIGHT = np.array([0.15, 0.3, 0.94])


def figures(data: Path | None, folder: Path, report: Report) -> list[Path]:
    """Draw each edit's face before and after at the frame where most is asked, five kinds a sheet."""
    plots = pyplot()
    warm_up()
    made = [make(edit, {}) for edit in scripted(pieces_to_measure(data))]
    paths = []
    for first in range(0, len(KINDS), KINDS_PER_SHEET):
        rows = [[one for one in made if one.edit.kind is kind] for kind in KINDS[first : first + KINDS_PER_SHEET]]
        paths.append(_sheet(plots, rows, folder / f"edits_{first // KINDS_PER_SHEET + 1}.png"))
        report(f"drew {sum(map(len, rows))} edits")
    return paths


def _sheet(plots: Any, rows: Sequence[Sequence[Made]], path: Path) -> Path:
    figure, axes = plots.subplots(
        len(rows), PLACES, figsize=(3.3 * PLACES, 2.55 * len(rows)), layout="constrained", squeeze=False
    )
    for axis in axes.flat:
        axis.axis("off")
    for row, edits in zip(axes, rows, strict=True):
        for axis, one in zip(row, edits, strict=False):
            _pair(axis, one)
    figure.savefig(path, dpi=100)
    plots.close(figure)
    return path


def _pair(axis: Any, made: Made) -> None:
    """Draw a face before and, at its right, after, under what was asked and reached."""
    from matplotlib.collections import PolyCollection

    frame, told = _peak(made)
    for place, weights in enumerate((made.edit.piece.weights[frame], made.weights[frame])):
        corners, colours = _shaded(weights)
        shown = PolyCollection(
            list(corners[:, :, :2] + (place * (RIGHT - LEFT), 0.0)), facecolors=colours, antialiased=False
        )
        axis.add_collection(shown)
    axis.set(xlim=(LEFT, 2 * RIGHT - LEFT), ylim=(BELOW, ABOVE), aspect="equal")
    axis.set_title(f"{made.edit.kind.name}\n{made.edit.piece.source} {frame}: {told}", fontsize=7)


def _peak(made: Made) -> tuple[int, str]:
    """Return the frame where most is asked, and the control, what it was, what was asked and reached there."""
    frames = slice(*made.edit.frames)
    before, after = (bundled_face().measure(one[frames]) for one in (made.edit.piece.weights, made.weights))
    change = np.nan_to_num(np.abs(made.edit.asked[frames] - before))
    row, column = (int(index) for index in np.unravel_index(np.argmax(change), change.shape))
    asked = made.edit.asked[frames][row, column]
    told = f"{ALL_CONTROLS[column].title} {before[row, column]:.1f} → {asked:.1f}, got {after[row, column]:.1f} mm"
    return made.edit.frames[0] + row, told


def _shaded(weights: Array) -> tuple[Array, Array]:
    """Return the triangles that face the viewer, (n, 3, 3) in mm, the furthest first, and their colours, (n, 3)."""
    character = bundled()
    corners = character.vertices(weights)[character.triangles].astype(np.float64)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
    front = np.flatnonzero((normal[:, 2] > 0) & (np.abs(corners[:, :, 0]).max(axis=1) < RIGHT))
    front = front[np.argsort(corners[front, :, 2].mean(axis=1))]
    base = character.colours[character.triangles[front]].mean(axis=1) / 255
    return corners[front], np.clip(base * (0.55 + 0.5 * np.clip(normal[front] @ LIGHT, 0, 1))[:, None], 0, 1)
