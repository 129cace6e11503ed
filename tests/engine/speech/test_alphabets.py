from __future__ import annotations

import pytest

from engine.speech.alphabets import (
    ARPABET,
    CLASSES,
    IPA,
    MAX_LABEL,
    alphabet_of,
    class_anywhere,
    class_in,
    from_xsampa,
    ipa_base,
    known_as,
)


@pytest.mark.parametrize(
    ("label", "base"),
    [
        ("pʰ", "p"),
        ("t̪", "t"),
        ("n̩", "n"),
        ("t͡ʃ", "tʃ"),
        ("ç", "ç"),
        ("c\u0327", "ç"),
        ("ɑ̃", "ɑ"),
        ("ˈaː", "a"),
        ("õ", "o"),
        ("a˥˩", "a"),
    ],
)
def test_a_symbol_is_known_without_its_marks(label: str, base: str) -> None:
    assert ipa_base(label) == base


@pytest.mark.parametrize(
    ("label", "ipa"),
    [
        ("@", "ə"),
        ("@`", "ɚ"),
        ("r\\", "ɹ"),
        ("r\\`", "ɻ"),
        ("tS", "tʃ"),
        ("a~", "a"),
        ("O:", "ɔ"),
        ("t_h", "t"),
        ('"E', "ɛ"),
        ("E+", "ɛ"),
        ("?", "ʔ"),
    ],
)
def test_x_sampa_is_read_as_ipa_without_marks(label: str, ipa: str) -> None:
    assert from_xsampa(label) == ipa


@pytest.mark.parametrize(
    ("label", "alphabet", "name"),
    [
        ("AA1", "arpabet", "aa"), ("aa0", "arpabet", "aa"), ("M_B", "arpabet", "mbp"), ("AA3", "arpabet", None),
        ("S", "arpabet", "sz"), ("S", "x-sampa", "sh"), ("S", "ipa", None), ("y", "arpabet", "iy"), ("y", "ipa", "uw"),
        ("<p:>", "x-sampa", "sil"), ("<SIL>", "ipa", "sil"), ("", "ipa", "sil"), ("iə", "ipa", "iy"), ("iəu", "ipa", "iy"),
        ("iəua", "ipa", None), ("ii", "ipa", None), ("a51", "ipa", "aa"), ("ʰ", "ipa", None), ("quux", "arpabet", None),
        ("x" * MAX_LABEL, "ipa", None), ("p" + "ʰ" * (MAX_LABEL - 1), "ipa", "mbp"), ("p" + "ʰ" * MAX_LABEL, "ipa", None),
    ],
)  # fmt: skip
def test_a_label_has_the_class_of_its_alphabet(label: str, alphabet, name: str | None) -> None:
    assert class_in(label, alphabet) == name


def test_every_phone_of_the_tables_is_known_in_its_alphabet_and_its_class_anywhere() -> None:
    for phone, name in ARPABET.items():
        assert class_in(phone, "arpabet") == name and name in CLASSES
    for symbol, name in IPA.items():
        assert class_in(symbol, "ipa") == name and name in CLASSES
    for name in CLASSES:
        assert class_anywhere(name) in (name, IPA.get(name))


@pytest.mark.parametrize(
    ("labels", "tier", "alphabet"),
    [
        ("S T AA1 SH", "phones", "arpabet"), ("s t ə", "phones", "ipa"), ("S T", "MAU", "x-sampa"), ("S T", "phones", "arpabet"),
        ("tS @ n", "phones", "x-sampa"), ("<p:> <p:> tS", "phones", "x-sampa"), ("", "x", "arpabet"),
        ("ɹ AA1 AA1", "phones", "ipa"),
    ],
)  # fmt: skip
def test_a_tier_s_alphabet_is_the_one_of_most_of_its_labels(labels: str, tier: str, alphabet: str) -> None:
    assert alphabet_of(labels.split(), tier) == alphabet


@pytest.mark.parametrize(
    ("label", "alphabet", "known"),
    [
        ("AA1", "arpabet", "AA1"),
        ("aa1", "arpabet", "aa1"),
        ("S", "x-sampa", "ʃ"),
        ("ə", "arpabet", "ə"),
        ("AA1", "ipa", "AA1"),
        ("mbp", "ipa", "mbp"),
        ("??", "ipa", None),
    ],
)
def test_a_label_is_known_anywhere_by_what_it_is_known_as(label: str, alphabet, known: str | None) -> None:
    found = known_as(label, alphabet)
    assert found == known
    if found is not None and label not in CLASSES:
        assert class_anywhere(found) == (
            class_in(label, alphabet) or class_in(label, "arpabet") or class_in(label, "ipa")
        )
