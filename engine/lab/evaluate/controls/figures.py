"""Spectra of the motion that three controls give, beside a stretch of its curves."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from engine.controls import bundled_measurer
from engine.lab.corpus import pieces_to_measure
from engine.lab.evaluate.controls.table import methods, velocity_spectrum
from engine.lab.evaluate.plots import pyplot
from engine.lab.reporting import Report
from engine.take import MODEL_FPS, SHAPES


def figures(data: Path | None, folder: Path, report: Report) -> list[Path]:
    """Draw the velocity spectra of real and generated motion with three controls, beside a stretch of curves."""
    plots = pyplot()
    pieces = [piece for piece in pieces_to_measure(data) if piece.whole_face]
    result = {name: [m(bundled_measurer().measure(p.weights)) for p in pieces] for name, m in methods("3").items()}
    result = {"recorded": [np.asarray(piece.weights) for piece in pieces]} | result
    canvas = plots.Figure(figsize=(11, 4.5), layout="constrained")
    left, right = canvas.subplots(1, 2)
    for name, stretches in result.items():
        wide = 2.5 if name == "recorded" else 1.2
        left.semilogy(np.fft.rfftfreq(64, 1 / MODEL_FPS), velocity_spectrum(stretches), label=name, linewidth=wide)
        brow = stretches[0][300:500, list(SHAPES).index("browInnerUp")]
        right.plot(np.arange(len(brow)) / MODEL_FPS, brow, label=name, linewidth=wide)
    left.set(xlabel="Hz", ylabel="power of velocities", title="three controls: how lively the whole face is")
    right.set(xlabel="s", ylabel="weight", title="browInnerUp, which no control measures")
    left.legend()
    path = folder / "controls_spectra.png"
    canvas.savefig(path, dpi=150)
    report(f"drew {path.name}")
    return [path]
