"""Phones in the alphabets that aligners write, ARPAbet, IPA and X-SAMPA, and the viseme class of each symbol.

ARPAbet with its TIMIT additions (Garofolo et al. 1993), the IPA chart (2020), X-SAMPA (Wells 1995) as MAUS writes it.
"""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Iterable
from typing import Literal

Alphabet = Literal["arpabet", "ipa", "x-sampa"]

# Class (BSS20 table 1) -> ARPAbet phones. The paper's Y stands with S and Z; here with the vowel that it is a glide of.
# AW opens as wide as AA before it rounds, and ER is as round as R. H has the shape of what follows it (`visemes.shapes`);
# where nothing does, the mouth is open and at rest.
CLASSES: dict[str, tuple[str, ...]] = {
    "sil": ("SIL", "SP", "SPN", "PAU"),
    "ao": ("AO", "OY"),
    "aa": ("AA", "AE", "AY", "AW"),
    "eh": ("EH", "EY"),
    "iy": ("IH", "IY", "EE", "IX", "Y"),
    "ow": ("OH", "OW"),
    "ah": ("AH", "AX", "HH", "H"),
    "uw": ("UW", "UH"),
    "jh": ("JH",),
    "kg": ("G", "K", "NG"),
    "tn": ("L", "N", "T", "D", "DX", "EL", "EN"),
    "sz": ("S", "Z"),
    "sh": ("SH", "CH", "ZH"),
    "th": ("TH", "DH"),
    "fv": ("F", "V"),
    "mbp": ("M", "B", "P", "EM"),
    "w": ("W", "WH"),
    "r": ("R", "ER", "AXR"),
}
_TIMIT = {
    "sil": "H# EPI BR NS SIL_B SIL_E",
    "ah": "AX-H HV",
    "uw": "UX",
    "kg": "ENG GCL KCL Q",
    "tn": "NX DCL TCL",
    "mbp": "BCL PCL",
}
_SILENCE = "<p:> <usb> <nib> <eps> <sil> <s> </s> # _ - noise [noise] [sil] silence pause ∅ (...) ..."
_IPA = {
    "ao": "ɔ ɔj ɔɪ ɔʏ ɒ œ ɶ ɞ",
    "aa": "a ɑ æ aj aɪ ai ɐ ɑɪ aw aʊ au",
    "eh": "ɛ e ej eɪ ei ɛɪ",
    "iy": "i ɪ j ɨ ɯ ᵻ ʝ",
    "ow": "o ow oʊ ou əʊ əw ɵ ø ɤʊ",
    "ah": "ə ʌ ɜ ɘ ɤ h ɦ",
    "uw": "u ʊ ʉ y ʏ ᵿ",
    "jh": "dʒ dʑ dʐ ɖʐ ɟ ɟʝ ʥ ʤ",
    "kg": "k ɡ g ŋ c ç x ɣ q ɢ χ ħ ʕ ʔ ɲ ɴ ɰ ɠ ʛ ʜ ʢ ʡ ʟ ɧ kx",
    "tn": "t d n l ɾ ɫ ʎ ɬ ɮ ɭ ʈ ɖ ɳ ɗ ɺ ᶑ tɬ dɮ",
    "sz": "s z ts dz ʦ ʣ",
    "sh": "ʃ ʒ tʃ ʂ ʐ ɕ ʑ tɕ tʂ ʈʂ cç ʧ ʨ",
    "th": "θ ð tθ dð",
    "fv": "f v ɱ ʋ ⱱ",
    "mbp": "m b p ɓ ɸ β ʙ pf bv ʘ",
    "w": "w ʍ ɥ",
    "r": "ɹ r ʁ ʀ ɻ ɽ ɝ ɚ",
}
_VOWELS = frozenset("aɑæɐɒɔœɶɞɛeiɪɨɯoɵøəʌɜɝɚɘɤuʊʉyʏjw")  # with the glides that end a diphthong
ARPABET = {
    **{phone: name for name, phones in CLASSES.items() for phone in phones},
    **{phone: name for name, phones in _TIMIT.items() for phone in phones.split()},
}
IPA = {"": "sil", **{label: name for name, labels in _IPA.items() for label in labels.split()}}
_SILENT = frozenset(_SILENCE.split())
_XSAMPA_PAIRS = r"""
Aɑ {æ 6ɐ Qɒ Eɛ @`ɚ @\ɘ @ə 3\ɞ 3`ɝ 3ɜ Iɪ Oɔ 2ø 9œ &ɶ Uʊ }ʉ Vʌ Yʏ 1ɨ M\ɰ Mɯ 7ɤ 8ɵ B\ʙ Bβ Cç Dð d`ɖ Fɱ G\ɢ Gɣ H\ʜ
Hɥ h\ɦ X\ħ Xχ ?\ʕ ?ʔ J\ɟ Jɲ j\ʝ K\ɮ Kɬ l`ɭ l\ɺ L\ʟ Lʎ N\ɴ Nŋ n`ɳ O\ʘ p\ɸ Pʋ v\ʋ r\`ɻ r\ɹ r`ɽ R\ʀ Rʁ Sʃ s`ʂ s\ɕ
Tθ t`ʈ Wʍ x\ɧ z`ʐ z\ʑ Zʒ 4ɾ 5ɫ <\ʢ >\ʡ I\ᵻ U\ᵿ
"""
_XSAMPA = {pair[:-1]: pair[-1] for pair in _XSAMPA_PAIRS.split()}
_XSAMPA_TOKEN = re.compile("|".join(map(re.escape, sorted(_XSAMPA, key=len, reverse=True))) + "|[a-z]|(.)", re.DOTALL)
_XSAMPA_MARK = re.compile(r"_(?:[?BHL]\\|.)|[:\"%~='^`.*|+]|-\\")  # diacritics, length, stress, nasality, syllables
_STRESS = re.compile(r"(?<=[A-Z])[012]$")  # behind a vowel
_STRESS_BEFORE = re.compile(r"^(?:[ˈˌ'’ʹ\"%,]+|[012](?=[A-Za-z]))")  # as IPA and X-SAMPA mark a syllable, typed or not
_NOISE = re.compile(r"\++[a-z]+\++")  # as Sphinx writes what is no speech: +NSN+, ++BREATH++
_TONE = re.compile(r"(?<=[^\W\d])[0-9]+$")
_XSAMPA_TIERS = ("mau", "sampa", "phonalign")
_PLACE = re.compile(r"(?<=[^\W_])_[BIES]$")  # in the word, as Kaldi and Gentle mark it: beginning, inside, end, alone
MAX_LABEL = 40  # characters; no phone is longer
MAX_LABELS = 2_000  # that are looked at; no language has as many phones, with all their marks


def ipa_base(label: str) -> str:
    """Return an IPA symbol without diacritics, ties, length, stress and tone: pʰ → p, t̪ → t, n̩ → n, t͡ʃ → tʃ."""
    composed = unicodedata.normalize("NFC", label)
    if composed in IPA:  # ç is a letter, and no c with a mark
        return composed
    kept = "".join(
        letter if letter in IPA else unicodedata.normalize("NFD", letter)[0] for letter in composed
    )  # nasal vowels are composed of a letter and a mark
    return "".join(letter for letter in kept if unicodedata.category(letter) not in ("Mn", "Lm", "Sk", "No", "Me"))


def class_in(label: str, alphabet: Alphabet) -> str | None:
    """Return the name of the viseme class that a label has in an alphabet; None where it is no phone of it."""
    text = label.strip()
    if len(text) > MAX_LABEL:
        return None
    if text.lower() in _SILENT or _NOISE.fullmatch(text.lower()):
        return "sil"
    text = _STRESS_BEFORE.sub("", text) or text
    if alphabet != "x-sampa":
        text = _PLACE.sub("", text)
    if alphabet == "arpabet":
        return ARPABET.get(text.upper()) or ARPABET.get(_STRESS.sub("", text.upper()))
    return _ipa_class(from_xsampa(text) if alphabet == "x-sampa" else text)


def from_xsampa(label: str) -> str:
    """Return an X-SAMPA label in IPA, without diacritics; what is no symbol of it stays as it is."""
    bare = _XSAMPA_MARK.sub("", _rhotic(label))
    return _XSAMPA_TOKEN.sub(lambda match: _XSAMPA.get(match[0], match[0]), bare.replace("\0", "`"))


def _rhotic(label: str) -> str:
    r"""Shield the ` and \ that belong to a symbol, such as @` and r\`, from being taken for a mark."""
    return re.sub(r"(?<=[@3dlnrstz\\])`", "\0", label)


def _ipa_class(label: str) -> str | None:
    base = ipa_base(_TONE.sub("", label).replace(":", "").replace("'", ""))
    if label and not base:
        return None
    if base not in IPA and 1 < len(set(base)) == len(base) <= 3 and set(base) <= _VOWELS:
        return IPA[base[0]]  # a diphthong begins as its first vowel does
    return IPA.get(base)


def alphabet_of(labels: Iterable[str], tier: str = "") -> Alphabet:
    """Return the alphabet that most labels of a tier are phones of; its name tells where they leave it open.

    A letter may stand for different phones: S is the s of ARPAbet and the sh of X-SAMPA, y a glide or a rounded vowel.
    """
    counts = Counter(dict(Counter(label.strip() for label in labels).most_common(MAX_LABELS)))
    phones = {label: count for label, count in counts.items() if label.lower() not in _SILENT and label}
    if any(not label.isascii() and class_in(label, "ipa") for label in phones):
        return "ipa"
    order: list[Alphabet] = ["arpabet", "ipa", "x-sampa"]
    if any(part in tier.lower() for part in _XSAMPA_TIERS):
        order.reverse()
    return max(order, key=lambda alphabet: sum(n for label, n in phones.items() if class_in(label, alphabet)))


def known_as(label: str, alphabet: Alphabet) -> str | None:
    """Return a label of a tier as it is understood anywhere, in ARPAbet or IPA; None where it is no phone.

    Labels of the one kind that stand in a tier of the other are understood too: aligners mix them.
    """
    text = label.strip()
    own = class_in(text, alphabet)
    if own is None and alphabet != "x-sampa":
        own = class_in(text, "ipa" if alphabet == "arpabet" else "arpabet")
    if own is None:
        return text if text in CLASSES else None
    for candidate in (text, text.upper(), ipa_base(from_xsampa(text) if alphabet == "x-sampa" else text)):
        if class_anywhere(candidate) == own:
            return candidate
    return own


def class_anywhere(label: str) -> str | None:
    """Return the class of a label that no tier goes with: a class itself, ARPAbet, or IPA where that is written small."""
    text = label.strip()
    if text.lower() in CLASSES and text not in IPA:
        return text.lower()
    if text in IPA and not text.isupper():
        return IPA[text]
    return class_in(text, "arpabet") or class_in(text, "ipa")
