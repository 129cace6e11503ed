"""How English words are pronounced: the CMU dictionary in the wheel of PocketSphinx, which is not loaded for it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

Phones = tuple[str, ...]


def installed() -> bool:
    """Return whether PocketSphinx, and the dictionary with it, is there."""
    return find_spec("pocketsphinx") is not None


@lru_cache(maxsize=1)
def dictionary() -> Mapping[str, tuple[Phones, ...]]:
    """Return how each word, in lower case, is pronounced, the usual way first; empty where there is no dictionary."""
    spec = find_spec("pocketsphinx")
    if spec is None or spec.origin is None:
        return {}
    path = Path(spec.origin).parent / "model" / "en-us" / "cmudict-en-us.dict"
    found: dict[str, tuple[Phones, ...]] = {}
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return {}
    for line in text.splitlines():
        word, *phones = line.split()
        word = word.partition("(")[0]
        found[word] = (*found.get(word, ()), tuple(phones))
    return found
