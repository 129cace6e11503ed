from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.formats.markers import read
from engine.formats.markers.exports import Heading, heading_of


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


def cells(text: str) -> list[list[str]]:
    return [line.split(",") for line in text.splitlines()]


def test_a_plain_table_has_no_heading_of_several_lines() -> None:
    assert heading_of(cells("time,a_x,a_y,a_z\n0,1,2,3")) is None
    assert heading_of(cells("x,y,z\n1,2,3")) is None  # axes in the first line name no marker
    assert heading_of([]) is None and heading_of(cells("a,b\nx,z,y\nX,Y")) is None


def test_a_vicon_heading_tells_rate_unit_and_markers() -> None:
    found = heading_of(
        cells("Trajectories\n120\n,,Chin,,,Nose\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n1,0,1,2,3,4,5,6")
    )
    assert found == Heading(("", "", "Chin_x", "Chin_y", "Chin_z", "Nose_x", "Nose_y", "Nose_z"), 5, "mm", 120.0)
    bare = heading_of(cells("Trajectories\n120\n,,Chin\nFrame,Sub Frame,X,Y,Z\n1,0,1,2,3"))
    assert bare == Heading(("", "", "Chin_x", "Chin_y", "Chin_z"), 4, None, 120.0)


def test_of_a_motive_heading_only_positions_of_markers_count() -> None:
    head = (
        "Format Version,1.23,Capture Frame Rate,240,Length Units,Meters\n\n,Type,Bone,Bone,Bone,Marker,Marker,Marker\n"
    )
    head += ",Name,B,B,B,Chin,Chin,Chin\n,ID,1,1,1,2,2,2\n,,Position,Position,Position,Position,Position,Position\n"
    head += "Frame,Time (Seconds),X,Y,Z,X,Y,Z\n0,0,1,2,3,4,5,6"
    found = heading_of(cells(head))
    assert found == Heading(("", "Time (Seconds)", "", "", "", "Chin_x", "Chin_y", "Chin_z"), 7, "m", 240.0)
    turned = heading_of(cells(head.replace("Position,Position,Position\nFrame", "Rotation,Rotation,Rotation\nFrame")))
    assert turned is not None and set(turned.cells) == {"", "Time (Seconds)"}
    exported = heading_of(cells(head.replace("Length Units", "Export Frame Rate,60,Length Units")))
    assert exported is not None and exported.fps == 60.0


def test_a_qualisys_heading_ends_with_its_last_line_of_words() -> None:
    head = "NO_OF_MARKERS,2\nFREQUENCY,100.5\nMARKER_NAMES,Chin,Nose,\n"
    names = ("Chin_x", "Chin_y", "Chin_z", "Nose_x", "Nose_y", "Nose_z")
    assert heading_of(cells(head + "1,2,3,4,5,6")) == Heading(names, 3, "mm", 100.5)
    timed = heading_of(cells(head + "Frame,Time,Chin X,Y,Z\n1,0,1,2,3"))
    assert timed == Heading(("", "Time", *names), 4, "mm", 100.5)
    assert heading_of(cells("NO_OF_MARKERS,1\nMARKER_NAMES,A\n1,2,3")).fps is None
