from __future__ import annotations

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats.livelink.columns import DEFAULT_HEADER, ROTATIONS, column_name, columns_of
from engine.take import SHAPES


@pytest.mark.parametrize("seed", range(3))
def test_columns_are_found_by_name_in_any_order_among_others(seed: int) -> None:
    rng = np.random.default_rng(seed)
    names = [*DEFAULT_HEADER[2:], "Unix", "Note", "Shutter"]
    rng.shuffle(names)
    header = (*DEFAULT_HEADER[:2], *names)
    for swapped in (False, True):
        found = columns_of(header, "a.csv", swapped=swapped)
        for shapes, cells, known in (
            (found.shapes, found.shape_cells, SHAPES),
            (found.rotations, found.rotation_cells, ROTATIONS),
        ):
            assert sorted(shapes.tolist()) == list(range(len(known)))
            for shape, cell in zip(shapes, cells, strict=True):
                name = known[shape]
                other = name.replace("Left", "#").replace("Right", "Left").replace("#", "Right")
                one_way = name in ("jawLeft", "jawRight", "mouthLeft", "mouthRight")
                assert header[cell].lower() == (other if swapped and one_way else name).lower()
        assert found.cells.tolist() == [at for at, name in enumerate(header) if name in DEFAULT_HEADER[2:]]


@pytest.mark.parametrize(
    ("cell", "name"),
    [
        ("EyeBlinkLeft", "eyeblinkleft"),
        (" eye_blink_l ", "eyeblinkleft"),
        ("Eye Blink R", "eyeblinkright"),
        ("mouth-roll-lower", "mouthrolllower"),
        ("cheekPuff", "cheekpuff"),
        ("mouthRollL", "mouthrolll"),
    ],
)
def test_a_column_s_name_is_known_however_it_is_spelt(cell: str, name: str) -> None:
    assert column_name(cell) == name


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda names: names[1:], "does not begin"),
        (lambda names: ["Time", *names[1:]], "does not begin"),
        (lambda names: [*names, "Jaw_Open"], "names a column twice"),
        (lambda names: [name for name in names if name != "JawOpen"], r"lacks the column jawOpen \(1 shape missing\)"),
        (lambda names: names[:3], r"lacks the column eyeLookDownLeft \(50 shapes missing\)"),
    ],
)
def test_a_header_that_is_none_is_a_sentence(change, says: str) -> None:
    with pytest.raises(FormatError, match=says):
        columns_of(tuple(change(list(DEFAULT_HEADER))), "a.csv", swapped=False)


def test_a_file_may_lack_the_tongue_and_the_rotations() -> None:
    header = tuple(name for name in DEFAULT_HEADER if name not in ("TongueOut", *ROTATIONS))
    found = columns_of(header, "a.csv", swapped=False)
    assert len(found.shapes) == 51 and SHAPES.index("tongueOut") not in found.shapes
    assert found.rotations.shape == found.rotation_cells.shape == (0,)
