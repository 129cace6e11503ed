from __future__ import annotations

import numpy as np
import pytest

from engine.errors import EditError
from engine.lab.performer.performer import Script, perform, phones
from engine.lab.performer.visemes import VISEME_OF
from engine.lab.speech.lipread import read_lips
from engine.speech.visemes import CLASSES, NAMES, Cue, class_of, classes_over, one_hot


def test_eighteen_classes_cover_every_phone_that_can_be_performed() -> None:
    assert len(NAMES) == 18
    listed = [phone for phones_ in CLASSES.values() for phone in phones_]
    assert len(listed) == len(set(listed)) and set(VISEME_OF) <= set(listed)


@pytest.mark.parametrize(
    ("label", "name"),
    [
        ("AA1", "aa"),
        ("m", "mbp"),
        ("", "sil"),
        (" SIL ", "sil"),
        ("ʃ", "sh"),
        ("ER0", "ah"),
        ("kg", "kg"),
        ("uː", "uw"),
    ],
)
def test_labels_find_their_class(label: str, name: str) -> None:
    assert NAMES[class_of(label)] == name


@pytest.mark.parametrize("label", ["Q7", "hello", "1"])
def test_an_unknown_label_is_named(label: str) -> None:
    with pytest.raises(EditError, match=label):
        class_of(label)


def test_cues_lie_on_the_frames_whose_middle_they_cover() -> None:
    classes = classes_over([Cue(0.0, 0.1, "M"), Cue(0.1, 0.2, "AA")], frames=8, fps=30)
    np.testing.assert_array_equal(classes, [*[NAMES.index("mbp")] * 3, *[NAMES.index("aa")] * 3, -1, -1])
    assert one_hot(classes).sum() == 6


def test_bilabials_and_open_vowels_are_read_off_a_performance() -> None:
    script = Script(phones=("SIL", "AA1", "B", "AA1", "M", "AA1", "P", "AA1", "SIL"), seed=1)
    read = read_lips(perform(script).weights, fps=30)
    for start, stop, symbol in phones(script):
        middle = int((start + stop) / 2 * 30)
        if symbol != "SIL":
            assert (read[middle] == NAMES.index("mbp")) == (symbol in ("P", "B", "M"))
