"""The figures of BSBS19 on our takes: curves against the truth (6), closure rates (8), bad requests (9)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from engine.controls import CONTROL_INDEX, CONTROLS, bundled_measurer
from engine.errors import EngineError
from engine.lab.corpus import Piece
from engine.lab.evaluate.regress import Method, Report, measured_closures, methods, pieces_to_measure, played
from engine.lab.evaluate.regress_edits import REQUESTS, requested
from engine.take import MODEL_FPS, Array

SHOWN = 240  # frames, 8 s
COLOURS = {  # Okabe and Ito, the same method in the same colour everywhere
    "full": "#0072B2",
    "full_of_curves": "#000000",  # without knowing the take, as the methods of others are
    "regressor": "#E69F00",
    "hsk16": "#D55E00",
    "ridge": "#009E73",
    "bsbs19": "#CC79A7",
    "nearest": "#56B4E9",
}


def draw(data: Path | None, folder: Path, report: Report) -> list[Path]:
    """Write the figures into a folder and return their paths; raises `EngineError` without matplotlib."""
    try:
        import matplotlib as mpl
    except ImportError as error:
        raise EngineError("Figures need matplotlib.", "Install it: pip install 'retake[figures]'.") from error
    mpl.use("Agg")
    pieces, known = pieces_to_measure(data), methods(report)
    paths = [_closure_rates(pieces, known, folder), _bad_requests(pieces, known, folder)]
    faces = [piece for piece in pieces if piece.whole_face]
    return [_curves(faces, known, folder), *paths] if faces else paths


def _axes(rows: int, columns: int, size: tuple[float, float]) -> tuple[Any, Any]:
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(rows, columns, figsize=size, layout="constrained", squeeze=False)
    for one in axes.flat:
        one.spines[["top", "right"]].set_visible(False)
        one.grid(alpha=0.2)
    return figure, axes


def _save(figure: Any, path: Path) -> Path:
    from matplotlib import pyplot

    figure.savefig(path, dpi=130)
    pyplot.close(figure)
    return path


def _liveliest(curve: Array) -> int:
    """Return where the stretch of `SHOWN` frames with most motion begins."""
    motion = np.cumsum(np.r_[0.0, np.abs(np.diff(curve))])
    return int(np.argmax(motion[SHOWN:] - motion[:-SHOWN])) if len(motion) > SHOWN else 0


def _curves(pieces: list[Piece], known: dict[str, Method], folder: Path) -> Path:
    names = ("lips_vertical", "eyelid_right")
    figure, axes = _axes(len(names), 1, (10, 5))
    piece = max(pieces, key=lambda piece: len(piece.weights))
    measure = bundled_measurer().measure
    truth = measure(piece.weights)
    made = {name: measure(played(known[name], piece)) for name in ("full", "hsk16")}
    for name, axis in zip(names, axes[:, 0], strict=True):
        column = CONTROL_INDEX[name]
        start = _liveliest(truth[:, column])
        time = np.arange(len(truth[start : start + SHOWN])) / MODEL_FPS
        axis.plot(time, truth[start : start + SHOWN, column], color="black", lw=2.5, alpha=0.35, label="recorded")
        for method, curves in made.items():
            axis.plot(time, curves[start : start + SHOWN, column], color=COLOURS[method], lw=1.3, label=method)
        axis.set(ylabel=f"{CONTROLS[column].title}, mm", xlabel="s")
    axes[0, 0].legend(frameon=False, ncols=3)
    return _save(figure, folder / "regress_curves.png")


def _closure_rates(pieces: list[Piece], known: dict[str, Method], folder: Path) -> Path:
    figure, axes = _axes(2, 2, (9, 6))
    for name in (name for name in COLOURS if name in known):  # the other is ours without contacts
        found = measured_closures([played(known[name], piece) for piece in pieces], pieces)
        for column, (part, closures) in enumerate(found.items()):
            for row, (rates, title) in enumerate(((closures.tpr, "kept"), (closures.fpr, "invented"))):
                axis = axes[row, column]
                axis.plot(closures.thresholds, rates, "o-", ms=3, color=COLOURS[name], label=name)
                axis.set(title=f"closures {title}: {part}", xlabel="threshold, mm", ylabel="per true closure")
    axes[0, 0].legend(frameon=False)
    return _save(figure, folder / "regress_closures.png")


def _bad_requests(pieces: list[Piece], known: dict[str, Method], folder: Path) -> Path:
    figure, axes = _axes(len(REQUESTS), 1, (10, 2.2 * len(REQUESTS)))
    column = CONTROL_INDEX["lips_vertical"]
    piece = max(pieces, key=lambda piece: len(piece.weights))
    start = _liveliest(bundled_measurer().measure(piece.weights)[:, column])
    shown = slice(start, start + SHOWN)
    for (request, ask), axis in zip(REQUESTS.items(), axes[:, 0], strict=True):
        for name in ("regressor", "full"):
            asked, made = requested(known[name], ask, piece)
            reached = bundled_measurer().measure(made)[shown, column]
            axis.plot(np.arange(len(reached)) / MODEL_FPS, reached, color=COLOURS[name], lw=1.3, label=name)
        time = np.arange(len(asked[shown])) / MODEL_FPS
        axis.plot(time, asked[shown, column], color="black", lw=2, alpha=0.3, label="asked")
        axis.set(title=f"request: {request}", ylabel="lips apart, mm")
    axes[0, 0].legend(frameon=False, ncols=3)
    return _save(figure, folder / "regress_requests.png")
