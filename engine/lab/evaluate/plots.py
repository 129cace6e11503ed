"""Matplotlib without a window, for the figures of tables."""

from __future__ import annotations

from typing import Any

from engine.errors import EngineError


def pyplot() -> Any:
    """Return matplotlib's pyplot; raises `EngineError` where it is not installed."""
    try:
        import matplotlib as mpl

        mpl.use("Agg")
        from matplotlib import pyplot as plots
    except ImportError as missing:
        raise EngineError("Figures need matplotlib.", "Install it: pip install 'retake[figures]'.") from missing
    return plots
