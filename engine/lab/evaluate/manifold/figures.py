"""The paper's figures 6, 7, 8 and 10, and a row of faces like its figure 9."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from engine.lab.evaluate.manifold import table as tables
from engine.lab.evaluate.plots import pyplot
from engine.lab.reporting import Report
from engine.take import Array

SHOWN = {"semi_supervised": "ours (ZLL17)", "rbf": "RBF", "laplacian": "Laplacian"}
COLOURS = {"semi_supervised": "#0072B2", "rbf": "#E69F00", "laplacian": "#009E73"}  # Okabe-Ito
TEN_LABELS = 10
FLOOR_MM = 0.005  # what is nearer is a labelled frame, met whatever the method


def figures(data: Path | None, folder: Path, report: Report) -> list[Path]:
    """Draw all figures; raises `EngineError` without matplotlib."""
    plots = pyplot()

    errors = {m: [tables.retarget_errors(data, n, m) for n in tables.LABELS] for m in tables.METHODS}
    report("measured the figures' errors")
    ten = tables.LABELS.index(TEN_LABELS)
    driven = tables.drive_errors(data)
    lines: dict[str, tuple[str, Array, dict[str, Array]]] = {
        "figure_6": (
            "labels in 100 frames",
            np.array(tables.LABELS, float),
            {m: np.array([e.mean() for e in errors[m]]) for m in SHOWN},
        ),
        "figure_7": (
            "expression",
            np.arange(float(tables.EXPRESSIONS)),
            {m: errors[m][ten].mean(axis=1) for m in SHOWN},
        ),
        "figure_8": ("frame", np.arange(float(tables.FRAMES)), {m: errors[m][ten].mean(axis=0) for m in SHOWN}),
        "figure_10": ("face", np.arange(float(tables.FACES)), {m: driven[m][:, 0] for m in SHOWN}),
    }
    paths = [_curves(plots, folder / f"{name}.png", *content) for name, content in lines.items()]
    return [*paths, _faces(plots, data, folder / "figure_9.png")]


def _curves(plots: Any, path: Path, across: str, x: Array, curves: dict[str, Array]) -> Path:
    figure, axes = plots.subplots(figsize=(6, 3.5), layout="constrained")
    for method, curve in curves.items():
        axes.plot(x, curve, color=COLOURS[method], label=f"{SHOWN[method]}: {curve.mean():.3f}", linewidth=1.2)
    axes.set(xlabel=across, ylabel="mean error, mm", yscale="log")
    axes.set_ylim(bottom=max(FLOOR_MM, min(float(curve.min()) for curve in curves.values()) / 1.2))
    figure.legend(loc="outside upper center", ncols=len(curves), frameon=False, title="mean over the figure, mm")
    figure.savefig(path, dpi=150)
    plots.close(figure)
    return path


def _faces(plots: Any, data: Path | None, path: Path) -> Path:
    """Draw the expression that moves most, from the front, lit from above: face at rest with its points, methods, truth."""
    pair = tables.heads()
    rest, target = max(tables.face_pairs(data), key=lambda faces: float(np.abs(faces[1] - faces[0]).sum()))
    result = {SHOWN[method]: move(target[pair.points]) for method, move in tables.drivers(rest).items()}
    triangles = pair.part[(pair.part < tables.FACE_VERTICES).all(axis=1)]
    shown = {f"at rest, {tables.POINTS} points": rest, **result, "truth": target}
    figure, axes = plots.subplots(1, len(shown), figsize=(15, 4.2), layout="constrained")
    for axis, (title, vertices) in zip(axes, shown.items(), strict=True):
        corner = vertices[triangles]
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        shade = normal @ np.array([0.2, 0.5, 0.85]) / np.maximum(np.linalg.norm(normal, axis=1), 1e-9)
        order = np.argsort(corner[:, :, 2].mean(axis=1))
        front = order[normal[order, 2] > 0]
        axis.tripcolor(
            vertices[:, 0], vertices[:, 1], triangles[front], facecolors=shade[front], cmap="bone", vmin=0, vmax=1
        )
        axis.set(title=title, aspect="equal", xlim=(-95, 95), ylim=(-125, 125))
        axis.axis("off")
    axes[0].plot(*rest[pair.points, :2].T, ".", color="#D55E00", markersize=3)
    figure.savefig(path, dpi=150)
    plots.close(figure)
    return path
