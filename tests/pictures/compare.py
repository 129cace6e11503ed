"""Pictures of the window beside ones that a person has looked at."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from PySide6.QtGui import QImage

from app.window.main_window import MainWindow

HERE = Path(__file__).parent
SIZE = (1280, 800)
ALLOWED_MEAN = 5.0  # of 255: fonts and software GL differ a little from machine to machine, a lost panel by far more


def pixels(image: QImage) -> np.ndarray:
    image = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].astype(float)


def looks_as_it_did(window: MainWindow, name: str, folder: Path) -> bool:
    """Compare the window with a picture; what it looks like now is left in a folder, for whoever has to find out why."""
    window.status["speed"].clear()
    image = window.grab().toImage()
    image.save(str(folder / f"{name}.png"))
    path = HERE / f"{name}.png"
    if os.environ.get("RETAKE_RENEW_PICTURES"):
        image.save(str(path))
    known = QImage(str(path))
    assert (image.width(), image.height()) == (known.width(), known.height())
    assert np.abs(pixels(image) - pixels(known)).mean() < ALLOWED_MEAN
    return True
