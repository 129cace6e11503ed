from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.formats.markers import read


@pytest.mark.parametrize(
    ("unit", "mm"), [("Meters", 1000), ("millimeters", 1), ("inches", 25.4), ("CM", 10), ("metres", 1000)]
)
def test_units_of_a_trc_are_known_in_full_and_names_in_other_letters(tmp_path: Path, unit: str, mm: float) -> None:
    path = tmp_path / "m.trc"
    head = f"PathFileType\t4\t(X/Y/Z)\tm.trc\nDataRate\tNumFrames\tNumMarkers\tUnits\n60\t1\t1\t{unit}\n"
    path.write_text(f"{head}Frame#\tTime\tLèvre\n\t\tX1\tY1\tZ1\n1\t0\t1\t2\t3\n", "latin-1")
    found = read(path)
    assert found.names == ("Lèvre",)
    np.testing.assert_allclose(found.positions[0, 0], np.array([1, 2, 3]) * mm)


TRC = "PathFileType\t4\t(X/Y/Z)\tm.trc\nDataRate\tNumFrames\tNumMarkers\tUnits\n{}\nFrame#\tTime\ta\n\t\tX1\tY1\tZ1\n"
