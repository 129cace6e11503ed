from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from engine.errors import EditError
from engine.lab.performer.performer import Script, perform, phones
from engine.lab.performer.visemes import VISEME_OF
from engine.lab.speech.lipread import read_lips
from engine.speech.visemes import CLASSES, NAMES, Cue, class_of, classes_over, one_hot, shapes


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
        ("ER0", "r"),
        ("AW1", "aa"),
        ("HH", "ah"),
        ("ˈAA", "aa"),
        ("'aɪ", "aa"),
        ("y", "uw"),
        ("Y", "iy"),
        ("+NSN+", "sil"),
        ("<sil>", "sil"),
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


@pytest.mark.parametrize(
    ("labels", "names"),
    [
        ("AW1", "aa uw"),
        ("aʊ", "aa uw"),
        ("ay", "aa iy"),
        ("OY0_E", "ao iy"),
        ("ˈeɪ", "eh iy"),
        ("HH IY1", "iy iy"),
        ("HH W AA1", "w w aa"),
        ("HH SIL", "ah sil"),
        ("h uː", "uw uw"),
        ("HH AW", "aa aa uw"),
        ("M AA", "mbp aa"),
    ],
)
def test_phones_have_the_shapes_that_the_mouth_goes_through(labels: str, names: str) -> None:
    cues = [Cue(at / 10, (at + 1) / 10, label) for at, label in enumerate(labels.split())]
    found = shapes(cues)
    assert [cue.label for cue in found] == names.split()
    assert found[0].start_s == 0.0 and found[-1].stop_s == cues[-1].stop_s
    assert all(before.stop_s == after.start_s for before, after in pairwise(found))


def test_where_nothing_is_said_there_are_no_shapes() -> None:
    assert shapes([]) == () and (classes_over([], frames=3, fps=30) == -1).all()


def test_an_h_before_a_pause_does_not_take_the_vowel_after_it() -> None:
    assert shapes([Cue(0, 0.1, "HH"), Cue(0.4, 0.5, "IY")])[0].label == "ah"


@pytest.mark.parametrize("label", ["B", "F"])
def test_a_contact_of_20_ms_is_seen_wherever_it_falls_between_frames(label: str) -> None:
    for start_s in np.arange(0.2, 0.2 + 1 / 30, 0.001):
        cues = [Cue(0, start_s, "AA"), Cue(start_s, start_s + 0.02, label), Cue(start_s + 0.02, 1, "AA")]
        classes = classes_over(cues, frames=30, fps=30)
        assert (classes == class_of(label)).sum() == 1 and (classes == class_of("AA")).sum() == 29
