"""Sound to words and phones with their times: forced alignment where the text is known, recognition before it else.

PocketSphinx with its model of US English, in a process of its own. Its times are half a window early.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from engine.errors import EditError, EngineError
from engine.speech import dictionary
from engine.speech.normalise import words_of
from engine.speech.process import Follow, go_on, run
from engine.speech.pronounce import ENGLISH, Spoken, is_english, pronounce
from engine.speech.sound import RATE, dithered, is_silent, speech_samples
from engine.speech.transcript import Said, Transcript, confidence
from engine.speech.visemes import Cue
from engine.take import Array
from engine.words import counted

FRAME_S = 0.01  # of the decoder
EARLY_S = 0.0125  # its times come before the sound by half its window
PAD_S = 0.2  # of silence before and after, without which the first and the last phone have no room
LEAST_S = 0.1
MOST_ALIGNED_S = 300.0  # the search keeps a lattice of the whole
MOST_HEARD_S = 1_800.0
PART_S = (6.0, 15.0)  # a recording is heard in parts of such a length, cut where it is quietest
_QUIET_S = 0.1  # over which quietness is measured
_WIDEST_RATE = 30.0  # phones in a second; nobody says more


def installed() -> bool:
    """Return whether PocketSphinx is there."""
    return dictionary.installed()


def transcribed(
    samples: npt.NDArray[np.floating],
    rate: int,
    *,
    text: str | None = None,
    language: str = ENGLISH,
    follow: Follow = go_on,
) -> Transcript:
    """Return what is said when in samples, (n,) or (n, channels), -1..1.

    With `text` its words are aligned; without, words are recognised first, which English alone can be. `follow` hears how
    far the work is and may end it. Raises `EngineError`: without PocketSphinx, where nothing is heard, and where the text
    cannot be what is said.
    """
    _require(samples, rate, text=text, language=language)
    spoken = pronounce(words_of(text), language) if text is not None else None
    sound = speech_samples(samples, rate)
    if is_silent(sound):
        raise EditError("The recording is silent.", "Choose one in which somebody speaks.")
    if spoken is not None:
        return _with_text(sound, spoken, follow)
    return _without_text(sound, follow)


def _require(samples: npt.NDArray[np.floating], rate: int, *, text: str | None, language: str) -> None:
    if not installed():
        raise EngineError(
            "Hearing speech needs PocketSphinx, which is not installed.",
            "Install it: pip install 'retake[speech]'. A TextGrid or mouth cues from another program work without it.",
        )
    length_s = len(samples) / rate
    if length_s < LEAST_S:
        raise EditError("The recording is too short to hear a word in.", f"It lasts {1000 * length_s:.0f} ms.")
    most_s = MOST_HEARD_S if text is None else MOST_ALIGNED_S
    if length_s > most_s:
        raise EditError(
            f"The recording lasts {length_s / 60:.0f} minutes; at most {most_s / 60:.0f} are listened to at once.",
            "Cut out the part that belongs to the take.",
        )
    if text is None and not is_english(language):
        raise EngineError(
            f"Words in the language {language[:20]!r} cannot be recognised, English alone can.",
            "Give the text as well, which is then aligned, or a TextGrid.",
        )


def _with_text(sound: Array, spoken: Sequence[Spoken], follow: Follow) -> Transcript:
    length_s = len(sound) / RATE
    phones = sum(len(each.ways[0]) for each in spoken)
    if phones > _WIDEST_RATE * length_s:
        raise EditError(
            f"The text has {counted(len(spoken), 'word')}, more than anybody says in {length_s:.1f} seconds.",
            "Give the text of this recording alone.",
        )
    words, added = _keyed(spoken)
    job = {"words": [words], "added": added}
    aligned = run(job, [_padded(sound)], follow)["aligned"][0]
    if aligned is None:
        raise EditError("The text is not what is said in the recording.", "Check it word by word, or leave it out.")
    cues, said = _read(aligned, 0.0, length_s, [each.word.written for each in spoken])
    return Transcript(_sure(said), tuple(cues), length_s)


def _without_text(sound: Array, follow: Follow) -> Transcript:
    length_s = len(sound) / RATE
    edges = cuts(sound)
    parts = [sound[first:last] for first, last in pairwise(edges)]
    answer = run({"words": None, "added": {}}, [_padded(part) for part in parts], follow)
    cues: list[Cue] = []
    said: list[Said] = []
    missed: list[tuple[float, float]] = []
    for first, last, words, aligned in zip(edges[:-1], edges[1:], answer["words"], answer["aligned"], strict=True):
        start_s, stop_s = first / RATE, last / RATE
        if aligned is None:
            cues.append(Cue(start_s, stop_s, "SIL"))
            missed += [(start_s, stop_s)] if words else []
            continue
        more, found = _read(aligned, start_s, stop_s, words)
        cues += more
        said += found
    if not said:
        raise EditError("No words were heard in the recording.", "Give the text of it, or choose a cleaner recording.")
    return Transcript(_sure(said), tuple(cues), length_s, heard=True, missed=tuple(missed))


def _keyed(spoken: Sequence[Spoken]) -> tuple[list[str], dict[str, list[str]]]:
    """Return what the decoder calls each word, and the pronunciations of those that its own dictionary lacks.

    Those have names of their own: a word of another language may be spelled as an English one.
    """
    known = dictionary.dictionary()
    own = {
        each.word.spoken: [" ".join(way) for way in each.ways]
        for each in spoken
        if each.found_in != "dictionary" or each.word.spoken not in known
    }
    keys = {word: f"w{at}.own" for at, word in enumerate(own)}
    return [keys.get(each.word.spoken, each.word.spoken) for each in spoken], {keys[word]: own[word] for word in own}


def _padded(sound: Array) -> bytes:
    return dithered(np.pad(sound, int(PAD_S * RATE)))


def _read(
    aligned: Sequence[Any], start_s: float, stop_s: float, written: Sequence[str]
) -> tuple[list[Cue], list[Said]]:
    """Return phones and words of a part of the recording, in its seconds, silence for what is no word.

    The words bear their scores per frame in place of a confidence, which takes those of the whole recording.
    """
    cues: list[Cue] = []
    said: list[Said] = []
    names = iter(written)
    shift_s = start_s - PAD_S + EARLY_S
    for word, phones in aligned:
        is_word = word[:1] not in "<[+"
        mine = [_cue(phone, is_word, shift_s, (start_s, stop_s)) for phone in phones]
        mine = [cue for cue in mine if cue.stop_s > cue.start_s]
        cues += mine
        if is_word:
            name = next(names, word)
            score, frames = sum(phone[3] for phone in phones), sum(phone[2] for phone in phones)
            if mine:
                said.append(Said(name, mine[0].start_s, mine[-1].stop_s, score / frames, tuple(mine)))
    return _reaching(cues, start_s, stop_s), said


def _sure(said: Sequence[Said]) -> tuple[Said, ...]:
    found = confidence([each.confidence for each in said])
    return tuple(replace(each, confidence=float(sure)) for each, sure in zip(said, found, strict=True))


def _cue(phone: Sequence[Any], is_word: bool, shift_s: float, within_s: tuple[float, float]) -> Cue:
    name, first, frames, _ = phone
    start_s, stop_s = np.clip(np.array([first, first + frames]) * FRAME_S + shift_s, *within_s).tolist()
    return Cue(start_s, stop_s, name if is_word else "SIL")


def _reaching(cues: list[Cue], start_s: float, stop_s: float) -> list[Cue]:
    """Return cues that reach from one time to another, with silence where there is none."""
    if not cues:
        return [Cue(start_s, stop_s, "SIL")]
    before = [Cue(start_s, cues[0].start_s, "SIL")] if cues[0].start_s > start_s else []
    after = [Cue(cues[-1].stop_s, stop_s, "SIL")] if cues[-1].stop_s < stop_s else []
    return [*before, *cues, *after]


def cuts(sound: Array) -> list[int]:
    """Return the samples at which to cut a sound at 16 kHz into parts of `PART_S`, with its first and its end."""
    block = int(_QUIET_S * RATE)
    energy = np.square(sound[: len(sound) // block * block].reshape(-1, block)).sum(axis=1)
    least, most = (int(seconds / _QUIET_S) for seconds in PART_S)
    edges = [0]
    while len(energy) * block - edges[-1] > most * block:
        first = edges[-1] // block + least
        edges.append((first + int(np.argmin(energy[first : first + most - least]))) * block + block // 2)
    return [*edges, len(sound)]
