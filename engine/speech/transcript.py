"""What is said when: words with their phones, how sure each is, and the lane of visemes that they make."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from engine.speech.lane import VisemeLane, attached
from engine.speech.visemes import Cue
from engine.take import Array
from engine.words import counted, plural

NAMED = 4  # doubtful words that a sentence names


@dataclass(frozen=True)
class Tuning:
    """Constants of how sure a word is: 1 / (1 + exp((middle − score) / width)), of its score per 10 ms.

    The score is how much less likely the word's phones are than the likeliest sounds at each moment (PocketSphinx, in its
    own logarithm): 0 is best.

    Attributes
    ----------
    middle : at which it is as likely right as wrong. Read off 8 sentences in 3 synthetic voices with one word in each
        replaced by another: of 198 right words 1 % lie below −50, of 22 wrong ones 90 %. In 8 sentences more of the same
        voices 3 of 66 right words were doubted, in one recording of several voices 7 of 66
    below_usual : what lies so far below the recording's own median is as likely right as wrong, where that is lower still:
        a second voice or noise lowers all scores. Right words of the same sentences had a median of −23
    lowest : `middle` where all scores are low
    width : per e-fold of the odds; not fitted
    doubt : confidence below which a word is named
    doubtful_share : of the words above which the text as a whole is doubted
    """

    middle: float = -50.0
    below_usual: float = -27.0
    lowest: float = -70.0
    width: float = 7.0
    doubt: float = 0.5
    doubtful_share: float = 0.4


TUNING = Tuning()


@dataclass(frozen=True)
class Said:
    """A word of a recording, in its seconds; `confidence` 0..1 says how well the sound fits its phones."""

    word: str
    start_s: float
    stop_s: float
    confidence: float
    phones: tuple[Cue, ...]


@dataclass(frozen=True)
class Transcript:
    """Words in order, and all phones with the silences between them, in seconds.

    `missed` lists the stretches in which something was heard that no words fit.
    """

    said: tuple[Said, ...]
    phones: tuple[Cue, ...]
    duration_s: float
    heard: bool = False  # the words were recognised, not given
    missed: tuple[tuple[float, float], ...] = ()

    @cached_property
    def words(self) -> tuple[Cue, ...]:
        """The words as cues."""
        return tuple(Cue(each.start_s, each.stop_s, each.word) for each in self.said)

    @cached_property
    def doubtful(self) -> tuple[int, ...]:
        """The words that the sound does not fit."""
        return tuple(at for at, each in enumerate(self.said) if each.confidence < TUNING.doubt)

    def lane(self, source: str = "") -> VisemeLane:
        """Return the phones as a lane that can be attached to a take; raises `EditError` where nothing is said."""
        return attached(self.phones, source)


def confidence(scores: npt.ArrayLike) -> Array:
    """Return how sure each word of a recording is, (words,) 0..1, of its score per frame of 10 ms, (words,)."""
    given = np.asarray(scores, np.float64)
    if not len(given):
        return given
    middle = np.clip(np.median(given) + TUNING.below_usual, TUNING.lowest, TUNING.middle)
    return np.asarray(1 / (1 + np.exp(np.clip((middle - given) / TUNING.width, -50, 50))))


def doubt(transcript: Transcript) -> str:
    """Return one sentence where the words are hardly what is said; empty where they are."""
    unsure = [transcript.said[at] for at in transcript.doubtful]
    if not unsure:
        return ""
    source = "transcript" if transcript.heard else "text"
    if len(unsure) > TUNING.doubtful_share * len(transcript.said):
        return (
            "The words that were heard fit the sound badly: it may be noisy, or in another language."
            if transcript.heard
            else f"The text is hardly what is said: {len(unsure):,} of {counted(len(transcript.said), 'word')} "
            f"{plural(len(unsure), 'does', 'do')} not fit the sound."
        )
    named = ", ".join(f"{each.word!r} at {each.start_s:.2f} s" for each in unsure[:NAMED])
    more = "…" if len(unsure) > NAMED else ""
    fit = plural(len(unsure), "does not fit", "do not fit")
    return f"{counted(len(unsure), 'word')} of the {source} {fit} the sound: {named}{more or '.'}"
