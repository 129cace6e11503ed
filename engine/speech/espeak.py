"""Words that no dictionary has, and other languages: eSpeak NG, an optional program that runs in a process of its own."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Sequence

from engine.errors import EditError, EngineError
from engine.speech.alphabets import ipa_base

PROGRAM = "espeak-ng"
PATIENCE_S = 20.0
_LANGUAGE = re.compile(r"[a-zA-Z]{2,3}(?:[-+][a-zA-Z0-9]{1,12}){0,3}")
# What English comes nearest to, for the acoustic model knows no other sounds; vowels with r in two phones.
_ARPABET = {
    **{"p": "P", "b": "B", "t": "T", "d": "D", "k": "K", "g": "G", "ɡ": "G", "ʔ": "", "m": "M", "n": "N", "ŋ": "NG"},
    **{"f": "F", "v": "V", "θ": "TH", "ð": "DH", "s": "S", "z": "Z", "ʃ": "SH", "ʒ": "ZH", "h": "HH", "tʃ": "CH"},
    **{
        "dʒ": "JH",
        "l": "L",
        "ɫ": "L",
        "ɹ": "R",
        "r": "R",
        "j": "Y",
        "w": "W",
        "ɾ": "D",
        "ɬ": "L",
        "x": "HH",
        "ç": "HH",
    },
    **{
        "ɣ": "G",
        "β": "V",
        "ʋ": "V",
        "ɸ": "F",
        "ʁ": "R",
        "ʀ": "R",
        "ɲ": "N Y",
        "ʎ": "L Y",
        "c": "K",
        "ɟ": "G",
        "ɕ": "SH",
    },
    **{"ʑ": "ZH", "ʂ": "SH", "ʐ": "ZH", "ts": "T S", "dz": "D Z", "pf": "P F", "q": "K", "ħ": "HH", "ʍ": "W"},
    **{"i": "IY", "ɪ": "IH", "e": "EY", "ɛ": "EH", "æ": "AE", "a": "AA", "ɑ": "AA", "ɒ": "AA", "ɔ": "AO", "o": "OW"},
    **{"ʊ": "UH", "u": "UW", "ʌ": "AH", "ə": "AH", "ɐ": "AH", "ɜ": "ER", "ɝ": "ER", "ɚ": "ER", "ᵻ": "IH", "ɨ": "IH"},
    **{"y": "UW", "ʏ": "UH", "ø": "ER", "œ": "ER", "ɯ": "UW", "ɤ": "AH", "ʉ": "UW", "aɪ": "AY", "aʊ": "AW", "eɪ": "EY"},
    **{"oʊ": "OW", "əʊ": "OW", "ɔɪ": "OY", "ɔʏ": "OY", "ɔø": "OY", "aɪə": "AY AH", "aʊə": "AW AH", "əl": "AH L"},
    **{
        "iə": "IH AH",
        "eə": "EH AH",
        "ʊə": "UH AH",
        "aɪɚ": "AY ER",
        "aʊɚ": "AW ER",
        "ən": "AH N",
        "ai": "AY",
        "au": "AW",
    },
}
_LONGEST = max(map(len, _ARPABET))


def installed() -> bool:
    """Return whether eSpeak NG is there."""
    return shutil.which(PROGRAM) is not None


def pronounced(words: Sequence[str], language: str = "en-us") -> list[tuple[str, ...]]:
    """Return the ARPAbet phones nearest to how each word is said; none for what is no word.

    Raises `EngineError` where eSpeak is not installed, does not know the language, or does not answer.
    """
    if not words:
        return []
    if not _LANGUAGE.fullmatch(language):
        raise EditError(f"{language[:20]!r} is not the name of a language.", "Use one such as en-us, de or fr.")
    lines = _run(["-q", "--ipa", "--sep=_", "-v", language], "".join(f"{_line(word)}\n" for word in words), language)
    said = lines.splitlines()
    if len(said) != len(words):  # a line that it says nothing of, or in two
        said = [_run(["-q", "--ipa", "--sep=_", "-v", language], _line(word), language) for word in words]
    if not language.lower().startswith("en"):  # a tap is an R everywhere but in American English
        said = [line.replace("ɾ", "r") for line in said]
    return [arpabet(line) for line in said]


def arpabet(ipa: str) -> tuple[str, ...]:
    """Return the ARPAbet phones nearest to IPA whose symbols stand apart by underscores and spaces."""
    parts = re.sub(r"\([a-z-]+\)", "", ipa)  # where it changes its language
    return tuple(phone for symbol in re.split(r"[\s_]+", parts) for phone in _nearest(ipa_base(symbol)))


def _nearest(symbol: str) -> list[str]:
    """Return the phones of a symbol, the longest known pieces first; unknown letters are left out."""
    found: list[str] = []
    while symbol:
        size = next((size for size in range(min(_LONGEST, len(symbol)), 0, -1) if symbol[:size] in _ARPABET), 1)
        found += _ARPABET.get(symbol[:size], "").split()
        symbol = symbol[size:]
    return found


def _line(word: str) -> str:
    return "".join(letter for letter in word if letter.isalpha() or letter == "'")


def _run(arguments: list[str], text: str, language: str) -> str:
    program = shutil.which(PROGRAM)
    if program is None:
        raise EngineError("eSpeak NG is not installed.", "Install it (on Debian: apt install espeak-ng).")
    try:
        done = subprocess.run(
            [program, *arguments], check=False, input=text.encode(), capture_output=True, timeout=PATIENCE_S
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise EngineError("eSpeak NG did not answer.", "Try it in a terminal: espeak-ng --version.") from error
    if done.returncode:
        raise EngineError(
            f"eSpeak NG does not speak the language {language!r}.", "Those that it has: espeak-ng --voices."
        )
    return done.stdout.decode("utf-8", "replace")
