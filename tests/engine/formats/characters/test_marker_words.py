from __future__ import annotations

import pytest

from engine.formats.characters.marker_words import words_of


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("LMouthCorner", "left mouth"),
        ("lip_corner_l", "mouth left"),
        ("Leye_Outside", "left eye outer"),
        ("reyebrow_in", "right brow inner"),
        ("Mouth_Up", "lip upper"),
        ("mouth_low_R", "lip lower right"),
        ("Bone:face|Chin_M", "chin m"),
        ("a/b/NoseTip2", "nose tip 2"),
        ("upper lips mid", "upper lip middle"),
        ("THE Face marker", ""),
        ("EyelidTopLT", "lid upper left"),
        ("Rearview", "rearview"),
        ("cheek03", "cheek 03"),
    ],
)
def test_a_name_is_taken_apart_into_the_words_of_landmarks(name: str, words: str) -> None:
    assert words_of(name) == frozenset(words.split())
