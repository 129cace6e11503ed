"""Text as it is written, to the words that are said: numbers, years, money, units, times and signs are spelled out."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from re import Match

from engine.errors import EditError

MOST_WORDS = 5_000  # half an hour of speech
MOST_LETTERS = 60_000
LONGEST_NUMBER = 15  # digits that are said as one number; more are said one by one
YEARS = range(1100, 2100)  # numbers of four digits that are said as years where nothing is counted in them
_MONEY = {"$": ("dollar", "cent"), "€": ("euro", "cent"), "£": ("pound", "penny"), "¥": ("yen", "")}
_SCALES = ("hundred", "thousand", "million", "billion", "trillion")
_UNITS = {
    **{"mm": "millimeter", "cm": "centimeter", "m": "meter", "km": "kilometer", "ft": "foot"},
    **{"g": "gram", "kg": "kilogram", "mg": "milligram", "lb": "pound", "lbs": "pound", "oz": "ounce"},
    **{"s": "second", "sec": "second", "ms": "millisecond", "min": "minute", "h": "hour", "hr": "hour", "hrs": "hour"},
    **{"l": "liter", "ml": "milliliter", "hz": "hertz", "khz": "kilohertz", "mhz": "megahertz", "ghz": "gigahertz"},
    **{"kb": "kilobyte", "mb": "megabyte", "gb": "gigabyte", "tb": "terabyte", "fps": "frame per second"},
    **{"mph": "mile per hour", "km/h": "kilometer per hour", "kmh": "kilometer per hour", "%": "percent"},
    **{"°": "degree", "°c": "degree celsius", "°f": "degree fahrenheit", "v": "volt", "w": "watt", "kw": "kilowatt"},
}
_SAME = frozenset({"hertz", "kilohertz", "megahertz", "gigahertz", "percent"})  # in any number
_IRREGULAR = {"foot": "feet", "penny": "pence", "yen": "yen"}
_TITLES = {"mr": "mister", "mrs": "missus", "ms": "miz", "dr": "doctor", "prof": "professor", "vs": "versus"}
_SIGNS = {"&": "and", "@": "at", "+": "plus", "=": "equals", "%": "percent", "#": "number"}
_SMALL = r"\d{1,3}(?:,\d{3})+(?:\.\d+)?|\d+(?:\.\d+)?|\.\d+"
_UNIT = "|".join(sorted(map(re.escape, _UNITS), key=len, reverse=True))
_PAUSES = {",": "short", ";": "short", ":": "short", "–": "short", "—": "short", ".": "long", "!": "long", "?": "long"}
_TOKEN = re.compile(
    rf"(?P<money>[$€£¥]\s?(?P<sum>{_SMALL})(?:\s(?P<scale>{'|'.join(_SCALES)})\b)?)"
    r"|(?P<fraction>\b(?:(?P<whole>\d{1,3})\s)?(?P<above>\d{1,2})/(?P<below>\d{1,2})\b)"
    rf"|(?P<time>\b(?P<hours>[01]?\d|2[0-3]):(?P<minutes>[0-5]\d)\b)"
    r"|(?P<ordinal>\b\d{1,15}(?:st|nd|rd|th)\b)"
    r"|(?P<decade>\b(?P<tens>\d{4}|\d0)['’]?s\b)"
    rf"|(?P<measure>(?<![\w.])(?P<minus>[-−]?)(?P<amount>{_SMALL})\s?(?P<unit>{_UNIT})(?![\w/]))"
    rf"|(?P<number>(?:(?<![\w])[-−])?(?:{_SMALL}))"
    r"|(?P<title>\b(?:mr|mrs|ms|dr|prof|vs)\b\.?)"
    r"|(?P<initials>\b(?:[A-Za-z]\.){2,})"
    r"|(?P<word>[^\W\d_]+(?:['’][^\W\d_]+)*['’]?)"
    r"|(?P<pause>\.\.\.|[,;:.!?–—…])"
    r"|(?P<sign>[&@+=%#])",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class Word:
    """A word that is said.

    Attributes
    ----------
    spoken : in lower case, letters and apostrophes alone
    written : the part of the text that it comes of
    pause : what follows it: none, short (comma) or long (end of a sentence)
    """

    spoken: str
    written: str
    pause: str = ""


def words_of(text: str) -> tuple[Word, ...]:
    """Return the words that a text says; raises `EditError` where it says none, or more than can be laid out.

    What is no speech, such as emoji, markup and brackets, is left out.
    """
    if len(text) > MOST_LETTERS:
        raise EditError(f"The text has {len(text):,} letters; at most {MOST_LETTERS:,} are read.", "Give it in parts.")
    found: list[Word] = []
    for match in _TOKEN.finditer(_letters(text)):
        kind = match.lastgroup and next(name for name in _SPOKEN if match[name] is not None)
        if kind == "pause":
            if found:
                found[-1] = Word(found[-1].spoken, found[-1].written, _PAUSES.get(match[0], "long"))
            continue
        found.extend(Word(spoken, match[0].strip()) for spoken in _plain(_SPOKEN[str(kind)](match)))
    if not found:
        raise EditError("The text has no words that can be said.", "Write the line as it is spoken.")
    if len(found) > MOST_WORDS:
        raise EditError(f"The text has {len(found):,} words; at most {MOST_WORDS:,} are read.", "Give it in parts.")
    return tuple(found)


def _letters(text: str) -> str:
    parts = re.sub("([¼-¾⅐-⅞])", r" \1", text.replace("…", "..."))  # 1½ is no eleven halves
    return unicodedata.normalize("NFKC", parts).replace("⁄", "/").replace("’", "'").replace("´", "'")


def _plain(spoken: str) -> Iterator[str]:
    """Yield the single words of what the rules and num2words write, without hyphens and commas."""
    for word in re.split(r"[\s\-,]+", spoken.lower()):
        bare = word if word.endswith("s'") else word.rstrip("'")  # the boys', and the end of a quotation
        if bare.strip("'"):
            yield bare


def _number(text: str) -> str:
    """Say a number, digit by digit where it is longer than one says, or begins with a nought."""
    from num2words import num2words

    minus = "minus " if text[:1] in "-−" and text[:1] else ""
    digits = text.lstrip("-−").replace(",", "")
    whole, _, part = digits.partition(".")
    alone = len(whole) > LONGEST_NUMBER or (len(whole) > 1 and whole.startswith("0"))
    said_whole = " ".join(num2words(int(digit)) for digit in whole) if alone else num2words(int(whole or 0))
    behind = " point " + " ".join(num2words(int(digit)) for digit in part) if part else ""
    return f"{minus}{said_whole}{behind}"


def _numeral(match: Match[str]) -> str:
    from num2words import num2words

    text = match["number"]
    if text.isascii() and text.isdigit() and len(text) == 4 and int(text) in YEARS:
        return str(num2words(int(text), to="year"))
    return _number(text)


def _money(match: Match[str]) -> str:
    unit, cent = _MONEY[match[0][0]]
    total = match["sum"].replace(",", "")
    if match["scale"]:
        return f"{_number(total)} {match['scale']} {_many(unit)}"
    whole, _, part = total.partition(".")
    if len(part) != 2 or not cent:
        return f"{_number(total)} {unit if total == '1' else _many(unit)}"
    pieces = [(int(whole or 0), unit), (int(part), cent)]
    return " and ".join(f"{_number(str(n))} {noun if n == 1 else _many(noun)}" for n, noun in pieces if n) or (
        f"zero {_many(unit)}"
    )


def _measure(match: Match[str]) -> str:
    unit = _UNITS[match["unit"].lower()]
    first, *rest = unit.split(" ", 1)
    noun = first if match["amount"] == "1" or unit in _SAME else _many(first)
    return " ".join([("minus" if match["minus"] else ""), _number(match["amount"]), noun, *rest])


def _many(noun: str) -> str:
    return _IRREGULAR.get(noun, f"{noun}s")


def _time(match: Match[str]) -> str:
    hours, minutes = int(match["hours"]), int(match["minutes"])
    behind = "o'clock" if minutes == 0 else f"{'oh ' if minutes < 10 else ''}{_number(str(minutes))}"
    return f"{_number(str(hours))} {behind}"


def _ordinal(match: Match[str]) -> str:
    from num2words import num2words

    return str(num2words(int(match["ordinal"][:-2]), to="ordinal"))


def _decade(match: Match[str]) -> str:
    from num2words import num2words

    year = str(num2words(int(match["tens"]), to="year" if len(match["tens"]) == 4 else "cardinal"))
    return f"{year[:-1]}ies" if year.endswith("y") else f"{year}s"


def _fraction(match: Match[str]) -> str:
    from num2words import num2words

    above, below = int(match["above"]), int(match["below"])
    whole = f"{_number(match['whole'])} and " if match["whole"] else ""
    named = {2: "half", 4: "quarter"}.get(below) or (str(num2words(below, to="ordinal")) if below > 2 else "")
    if not named or above >= below:
        return f"{whole}{_number(str(above))} over {_number(str(below))}"
    plural = {"half": "halves"}.get(named, f"{named}s")
    return f"{whole}{_number(str(above))} {named if above == 1 else plural}"


_SPOKEN: dict[str, Callable[[Match[str]], str]] = {
    "money": _money,
    "time": _time,
    "ordinal": _ordinal,
    "decade": _decade,
    "measure": _measure,
    "fraction": _fraction,
    "number": _numeral,
    "title": lambda match: _TITLES[match[0].lower().rstrip(".")],
    "initials": lambda match: " ".join(match[0].replace(".", " ").split()),
    "word": lambda match: match[0],
    "pause": lambda match: "",
    "sign": lambda match: _SIGNS[match[0]],
}
