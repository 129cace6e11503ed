from __future__ import annotations

import pytest

from engine.errors import EditError
from engine.formats.characters.names import corrected, match_names
from engine.take import SHAPES

SPELLINGS = [
    lambda name: name,
    lambda name: name.upper() if "Left" not in name and "Right" not in name else name[0].upper() + name[1:],
    lambda name: name.replace("Left", "_L").replace("Right", "_R") if name[-5:] in ("tLeft", "Right") else name,
    lambda name: "blendShape1." + name,
    lambda name: "BS_" + name,
    lambda name: f"Head_Mesh__{name}",
    lambda name: (
        f"CC_Base_Body {name.replace('Left', '_L').replace('Right', '_R') if name[-5:] in ('tLeft', 'Right') else name}"
    ),
]


@pytest.mark.parametrize("spell", [SPELLINGS[0], *SPELLINGS[3:]], ids=["plain", "maya", "prefix", "mesh", "body"])
def test_each_shape_is_found_under_other_spellings(spell) -> None:
    rows = match_names([spell(name) for name in SHAPES])
    assert [row.shape for row in rows] == list(SHAPES)
    assert all(row.sure for row in rows)


def test_halves_are_known_behind_a_mesh_s_own_name_and_what_shapes_share_stays_theirs() -> None:
    rows = match_names([f"Head_Mesh_{name}" for name in ("browInnerUp_L", "browInnerUp_R", "jawOpen", "eyeBlink_L")])
    assert [row.shape for row in rows] == ["browInnerUp", "browInnerUp", "jawOpen", "eyeBlinkLeft"]
    names = ["mouthLeft", "mouthRight", "mouthClose", "mouthFunnel"]
    assert [row.shape for row in match_names(names)] == names


def test_sides_are_never_exchanged() -> None:
    for row in match_names(["mouth_smile_L", "mouthSmil_R", "EyeBlink_L", "eyeblnk.R", "browDn_L"]):
        assert row.shape.endswith("Left" if "L" in row.source[-2:] else "Right"), row


def test_both_halves_of_a_shape_share_it_and_any_other_double_is_left_out() -> None:
    rows = match_names(["browInnerUp_L", "browInnerUp_R", "jawOpen", "JAW_OPEN2"])
    assert [row.shape for row in rows] == ["browInnerUp", "browInnerUp", "jawOpen", ""]


def test_what_is_no_shape_is_left_out_or_shown_as_doubtful() -> None:
    rows = {row.source: row for row in match_names(["PupilDilate_L", "hairWind", "viseme_aa", "mouthSmleLeft"])}
    assert not rows["PupilDilate_L"].sure and not rows["hairWind"].sure and not rows["viseme_aa"].sure
    assert rows["mouthSmleLeft"].shape == "mouthSmileLeft" and 0.8 <= rows["mouthSmleLeft"].likeness < 1


def test_a_review_has_the_last_word() -> None:
    rows = corrected(match_names(["jawOpen", "shape_07"]), {"shape_07": "tongueOut", "jawOpen": ""})
    assert [(row.shape, row.sure) for row in rows] == [("", False), ("tongueOut", True)]
    with pytest.raises(EditError, match="no shape called 'nose'"):
        corrected(rows, {"nose": "jawOpen"})
    with pytest.raises(EditError, match="no shape called 'grin'"):
        corrected(rows, {"jawOpen": "grin"})
