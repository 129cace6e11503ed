"""How fast a mesh is made ready to follow its points, and follows them, at the sizes of a full head and of a face."""

from __future__ import annotations

import time

import numpy as np
import numpy.typing as npt

from engine.lab.speed.timing import Speed, percentile_ms
from engine.manifold.drive import MeshDriver
from engine.take import Array

HEAD, FACE, POINTS = 26_719, 6_174, 80
ROUNDS = 40


def measure() -> list[Speed]:
    """Measure on bumpy sheets of one part, the worst case: nothing of them is carried, all of it is solved."""
    head, head_build_ms = _built(HEAD)
    face, _ = _built(FACE)
    return [
        Speed("manifold_26719_build_ms", head_build_ms, "ms", 1000.0),
        Speed("manifold_26719_frame_ms", _frame_ms(head, HEAD), "ms", 12.0),
        Speed("manifold_6174_frame_ms", _frame_ms(face, FACE), "ms", 2.5),
        Speed("manifold_26719_memory_mb", head.memory_bytes / 1e6, "MB", 64.0),
    ]


def _built(count: int) -> tuple[MeshDriver, float]:
    """Return a driver and the milliseconds its building took, the better of two."""
    vertices, triangles = sheet(count)
    points = np.linspace(0, count - 1, POINTS).astype(np.int64)
    spent = []
    for _ in range(2):
        began = time.perf_counter()
        driver = MeshDriver(vertices, triangles, points)
        spent.append(time.perf_counter() - began)
    return driver, min(spent) * 1e3


def _frame_ms(driver: MeshDriver, count: int) -> float:
    vertices, _ = sheet(count)
    asked = vertices[driver.points] + np.random.default_rng(0).normal(size=(ROUNDS, POINTS, 3))
    return percentile_ms(lambda index: driver.drive(asked[index : index + 1]), ROUNDS, percentile=50)


def sheet(count: int) -> tuple[Array, npt.NDArray[np.int32]]:
    """Return a bumpy sheet of exactly `count` vertices, in mm, and its triangles."""
    width = int(np.sqrt(count))
    index = np.arange(count)
    row, column = index // width, index % width
    vertices = np.stack([column, row, 20 * np.sin(column / 15) * np.cos(row / 15)], axis=1).astype(np.float64)
    corner = index[(column < width - 1) & (index + width + 1 < count)]
    lower = np.stack([corner, corner + 1, corner + width], axis=1)
    upper = np.stack([corner + 1, corner + width + 1, corner + width], axis=1)
    return vertices, np.concatenate([lower, upper]).astype(np.int32)
