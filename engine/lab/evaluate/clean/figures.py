"""Curves of lids and lips before and after cleaning, of takes that the tracker itself has spoilt."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from engine.clean.takes import clean
from engine.controls import CONTROL_INDEX, CONTROLS, measure
from engine.lab.corpus import data_folder, load_takes
from engine.lab.evaluate.plots import pyplot
from engine.lab.reporting import Report
from engine.take import Take, runs

DIRTY = ("apfel", "S88-001")  # recorded takes that the tracker itself has spoilt
DRAWN = [CONTROL_INDEX[name] for name in ("eyelid_right", "eyelid_left", "lips_vertical")]
CLOSE_LOOK_S = 4.0


def figures(data: Path | None, folder: Path, report: Report) -> list[Path]:
    """Draw lids and lips of the dirty recorded takes, or of a folder's, before and after cleaning; lost runs shaded."""
    result = []
    for take, whole_face in load_takes(data or data_folder()):
        if whole_face and (data is not None or Path(take.name).stem in DIRTY):
            report(f"drawing {take.name}")
            result.append(_draw(take, folder / f"clean_{Path(take.name).stem}.png"))
    return result


def _draw(take: Take, path: Path) -> Path:
    """Draw the whole take, and a closer look at its roughest stretch and at the end of its longest lost run."""
    plots = pyplot()
    cleaned = clean(take).take
    before, after = (measure(weights)[:, DRAWN] for weights in (take.weights, cleaned.weights))
    close = round(CLOSE_LOOK_S * take.fps)
    rough = np.convolve(np.abs(np.diff(before, n=2, axis=0)).sum(axis=1), np.ones(close), "same")
    centres = [int(np.argmax(rough))]
    centres += [stop for start, stop in sorted(runs(take.lost), key=lambda run: run[0] - run[1])[:1]]
    looks = [slice(0, len(take))] + [slice(max(0, at - close // 2), at + close // 2) for at in centres]
    figure, axes = plots.subplots(len(DRAWN), len(looks), figsize=(6 * len(looks), 6), squeeze=False)
    for column, look in enumerate(looks):
        time_s = np.arange(len(take))[look] / take.fps
        for row, control in enumerate(DRAWN):
            axis = axes[row, column]
            axis.plot(time_s, before[look, row], color="#999999", linewidth=1, label="recorded")
            axis.plot(time_s, after[look, row], color="#0072B2", linewidth=1, label="clean")
            axis.fill_between(
                time_s, 0, 1, take.lost[look], transform=axis.get_xaxis_transform(), alpha=0.15, color="k"
            )
            axis.set(title=CONTROLS[control].title, xlabel="s", ylabel="mm")
    axes[0, 0].legend()
    figure.tight_layout()
    figure.savefig(path, dpi=80)
    plots.close(figure)
    return path
