"""BSS20 table 4: a whole take from its control curves alone, with eight of them and with three."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from engine.controls import CONTROL_INDEX, FEW, bundled_measurer
from engine.inpaint.gap import gap_of
from engine.inpaint.infer import bundled
from engine.lab.corpus import Piece, pieces_to_measure
from engine.lab.evaluate.baselines import bsbs19, hsk16
from engine.lab.evaluate.controls import baselines as regressors
from engine.lab.evaluate.inpaint.motion import npss
from engine.lab.reporting import Report, Row
from engine.take import SHAPES, Array

Method = Callable[[Array], Array]
SETS = {"8": tuple(CONTROL_INDEX), "3": FEW}
_STRETCH = 200  # frames whose spectra are compared, as long as the network's training windows
_SEEN = np.array(["Look" not in name for name in SHAPES])  # no control tells where the eyes look


def methods(controls: str) -> dict[str, Method]:
    """Return each method as a function of all control curves, (frames, 8) in mm, that uses only some."""
    columns = [CONTROL_INDEX[name] for name in SETS[controls]]

    def generated(curves: Array) -> Array:
        asked = np.full_like(curves, np.nan)
        asked[:, columns] = curves[:, columns]
        nothing = np.full((len(curves), len(SHAPES)), np.nan)
        return np.asarray(bundled().fill(gap_of(nothing, controls=asked))[0])

    if controls == "8":
        others: dict[str, Method] = {"bsbs19": bsbs19.load().infer, "hsk16": hsk16.load().infer}
    else:
        others = {name: regressors.load(name).infer for name in regressors.KINDS}
    return {"gan": generated} | others


def table(data: Path | None, report: Report) -> list[Row]:
    """Return a row per method and number of controls."""
    pieces = [piece for piece in pieces_to_measure(data) if piece.whole_face]
    rows = []
    for controls in SETS:
        for name, make in methods(controls).items():
            result = [make(bundled_measurer().measure(piece.weights)) for piece in pieces]
            rows.append({"method": name, "controls": int(controls)} | _figures(pieces, result))
        report(f"{controls} controls: {len(pieces)} pieces")
    return rows


def _figures(pieces: Sequence[Piece], result: Sequence[Array]) -> Row:
    pairs = [(piece.weights, other) for piece, other in zip(pieces, result, strict=True)]
    off = np.concatenate([(truth - other) ** 2 for truth, other in pairs])
    moved = np.concatenate([(np.diff(truth, axis=0) - np.diff(other, axis=0)) ** 2 for truth, other in pairs])
    stretches = [
        (truth[start : start + _STRETCH], other[start : start + _STRETCH])
        for truth, other in pairs
        for start in range(0, len(truth) - _STRETCH + 1, _STRETCH)
    ]
    spectra = [velocity_spectrum(each) for each in (list(result), [piece.weights for piece in pieces])]
    return {
        "mse": float(off.mean()),
        "mse_without_gaze": float(off[:, _SEEN].mean()),
        "velocity_mse": float(moved.mean()),
        "npss": npss([truth for truth, _ in stretches], [other for _, other in stretches]) if stretches else np.nan,
        "spectrum_gap_db": float(np.abs(10 * np.log10(spectra[0][1:] / spectra[1][1:])).mean()),
        "liveliness": float(spectra[0].sum() / spectra[1].sum()),
    }


def velocity_spectrum(stretches: Sequence[Array]) -> Array:
    """Return the mean power of weight velocities at each of 33 frequencies up to half the rate, over all shapes."""
    cut = [
        np.diff(weights, axis=0)[start : start + 64]
        for weights in stretches
        for start in range(0, len(weights) - 64, 32)
    ]
    window = np.hanning(64)[:, None]
    return np.asarray(np.mean([(np.abs(np.fft.rfft(each * window, axis=0)) ** 2).mean(axis=1) for each in cut], axis=0))
