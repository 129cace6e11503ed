from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from engine.lab.evaluate.clean import figures
from engine.lab.evaluate.clean import table as clean
from engine.lab.evaluate.clean.baselines import Filter, Kalman, OneEuro, savgol
from engine.lab.performer.demo import BUNDLED
from engine.lab.train.clean.rivals import FullyConnected, Rival

METHODS = {
    *("lstm", "raw", "exponential_0.3", "exponential_0.5", "exponential_0.8", "gaussian_1", "gaussian_5", "one_euro"),
    *("savgol", "kalman", "fully_connected", "boosted_trees"),
}


def untuned() -> dict[str, Filter]:
    dense = Rival(FullyConnected(1).estimate, 1, leak=0.5)
    return {
        "one_euro": OneEuro(2.0, 4.0),
        "savgol": savgol(5, 2),
        "kalman": Kalman(10.0),
        "fully_connected": dense,
        "boosted_trees": dense,
    }


def test_the_table_has_every_method_at_every_rate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clean, "SEEDS", (7,))
    monkeypatch.setattr(clean, "load_rivals", untuned)
    shutil.copy(BUNDLED, tmp_path)
    rows = clean.table(tmp_path, lambda line: None)
    assert {(row["method"], row["fps"]) for row in rows} == {
        (name, fps) for name in METHODS for fps in (30, 60, 120, 0)
    }
    raws = [row for row in rows if row["method"] == "raw"]
    for row in rows:
        for name in ("mse", "velocity_error", "jitter", "blink_recall", "closure_recall", "lag_ms"):
            assert np.isfinite(row[name])
        assert row["looks_ahead"] == (row["method"].startswith("gaussian") or row["method"] == "savgol")
    assert all(row["mse"] > 0 and row["lag_ms"] >= 0 for row in raws)


def test_the_truth_itself_has_no_error(tmp_path: Path) -> None:
    shutil.copy(BUNDLED, tmp_path)
    spoilt = clean.spoil(clean.performances(tmp_path), 60.0, seed=1)
    figures = clean.figures_of(spoilt, [item.truth for item in spoilt])
    assert figures["mse"] == figures["velocity_error"] == figures["false_blinks_per_min"] == 0
    assert figures["blink_recall"] == figures["closure_recall"] == 1
    assert figures["lag_ms"] == pytest.approx(0, abs=1e-6)


def test_figures_are_drawn(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    shutil.copy(BUNDLED, tmp_path)
    (drawn,) = figures.figures(tmp_path, tmp_path, lambda line: None)
    assert drawn.stat().st_size > 10_000
