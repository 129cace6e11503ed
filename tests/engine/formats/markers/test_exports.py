from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.formats.markers import read


def exported(kind: str) -> str:
    """Return two markers over ninety frames at 50 fps, in metres or mm, with the headings of a capture system."""
    names, frames = ["Chin", "Nose"], np.arange(90)
    unit = 0.001 if kind == "motive" else 1.0
    numbers = [[f"{(row + 60 * place) * unit:.4f}" for place in range(6)] for row in frames]
    times = [[str(row), f"{row / 50:.5f}"] for row in frames]
    heads: dict[str, list[list[str]]] = {
        "vicon": [["Trajectories"], ["50"], ["", "", "Chin", "", "", "Nose"], ["Frame", "Sub Frame", *"XYZXYZ"]],
        "motive": [
            [
                *[
                    "Format Version",
                    "1.23",
                    "Capture Frame Rate",
                    "100",
                    "Export Frame Rate",
                    "50",
                    "Length Units",
                    "Meters",
                ]
            ],
            [],
            ["", "Type", *["Rigid Body"] * 3, *["Marker"] * 6],
            ["", "Name", *["Cap"] * 3, *np.repeat(names, 3)],
            ["", "ID", *["7"] * 3, *["A3:1"] * 3, *["A3:2"] * 3],
            ["", "", *["Rotation"] * 3, *["Position"] * 6],
            ["Frame", "Time (Seconds)", *"XYZ" * 3],
        ],
        "qualisys": [["NO_OF_FRAMES", "90"], ["NO_OF_MARKERS", "2"], ["FREQUENCY", "50"], ["MARKER_NAMES", *names]],
    }
    body = numbers if kind == "qualisys" else [time + row for time, row in zip(times, numbers, strict=True)]
    if kind == "motive":
        body = [[*row[:2], "0", "0", "0", *row[2:]] for row in body]
    if kind == "vicon":
        body = [["", "", *["mm"] * 6], *([row[0], "0", *row[2:]] for row in body)]
    mark = "\t" if kind == "qualisys" else ","
    return "\r\n".join(mark.join(row) for row in [*heads[kind], *body]) + "\r\n"


@pytest.mark.parametrize(("kind", "ending"), [("vicon", ".csv"), ("motive", ".csv"), ("qualisys", ".tsv")])
def test_exports_of_capture_systems_are_read_as_they_come(tmp_path: Path, kind: str, ending: str) -> None:
    path = tmp_path / f"m{ending}"
    path.write_text(exported(kind), newline="")
    found = read(path)
    assert (found.names, found.fps, len(found)) == (("Chin", "Nose"), 50.0, 90)
    np.testing.assert_allclose(found.positions[2], [[2, 62, 122], [182, 242, 302]], atol=1e-9)
    assert found.notices == ()
