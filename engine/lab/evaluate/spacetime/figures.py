"""Velocity errors along a take, as the figure 11 of SLS12, and lips and a lid on the second head."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from engine.jaw import drawable
from engine.lab.corpus import pieces_to_measure
from engine.lab.evaluate.plots import pyplot
from engine.lab.evaluate.spacetime.table import CLOSED_MM, METHODS, carry, heads
from engine.lab.reporting import Report
from engine.spacetime.source import from_take
from engine.take import MODEL_FPS, Take

FIGURE_FRAMES = 400


def figures(data: Path | None, folder: Path, report: Report) -> list[Path]:
    """Draw velocity errors along a take, as the paper's figure 11, and the lips and a lid on the second head.

    Raises `EngineError` where matplotlib is not installed.
    """
    plots = pyplot()
    piece = max(pieces_to_measure(data), key=lambda each: float(each.weights.std(axis=0).sum()))
    truth = drawable(piece.weights[:FIGURE_FRAMES])
    ours, other = heads()
    source = from_take(Take(truth, MODEL_FPS), ours.character, ours.layout)
    figure = plots.Figure(figsize=(11, 8), layout="constrained")
    speed, lips, lid = figure.subplots(3, 1, sharex=True)
    for name, method in METHODS.items():
        report(f"figure: {name}")
        there, used = carry(source, other, method)
        moved = there[:, used.shapes] @ used.basis.T - used.motion
        error = np.sqrt((np.diff(moved, axis=0) ** 2).sum(axis=1) / len(ours.layout.names))
        speed.plot(error, label=name, linewidth=0.9)
        apart = other.gaps.sizes(drawable(there))
        lips.plot(apart[:, 0], linewidth=0.9)
        lid.plot(apart[:, 3], linewidth=0.9)
    for axes, column in ((lips, 0), (lid, 3)):
        axes.plot(source.gaps[:, column], color="black", linewidth=1.4, label="source")
        axes.axhline(CLOSED_MM, color="grey", linewidth=0.6, linestyle="--")
    speed.set_ylabel("velocity error\nmm per frame")
    lips.set_ylabel("lips apart, mm")
    lid.set_ylabel("left lids apart, mm")
    lid.set_xlabel(f"frame of {piece.source}")
    speed.legend(fontsize=8, ncols=3)
    lips.legend(fontsize=8)
    path = folder / "spacetime_velocity.png"
    figure.savefig(path, dpi=130)
    return [path]
