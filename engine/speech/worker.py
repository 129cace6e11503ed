"""The program that hears, in a process of its own: PocketSphinx holds the interpreter while it works.

It takes one job on its standard input, a line of JSON and then the samples of each part (16 kHz, 16 bit), and answers
with a line of JSON for each step and one with what it found. It is run as a file and knows nothing of the rest.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

RATE = 16_000
# Bestpath drops alignments that the search has found; the usual beams lose one sentence in ten.
EXACT = {"bestpath": False, "dither": False, "beam": 1e-80, "pbeam": 1e-80, "wbeam": 1e-60}


def main() -> int:
    """Do one job; returns the exit code."""
    job = json.loads(sys.stdin.buffer.readline())
    parts = [sys.stdin.buffer.read(length) for length in job["lengths"]]
    words, steps = job["words"], _Steps(len(parts) * (2 if job["words"] is None else 1))
    if words is None:
        words = recognise(parts, steps)
    _tell({"words": words, "aligned": align(parts, words, job["added"], steps)})
    return 0


class _Steps:
    """Tells how much of the way is done."""

    def __init__(self, count: int) -> None:
        self._done, self._count = 0, max(1, count)

    def done(self) -> None:
        self._done += 1
        _tell({"part": self._done / self._count})


def align(
    parts: Sequence[bytes], words: Sequence[Sequence[str]], added: dict[str, Sequence[str]], steps: _Steps
) -> list[list[Any] | None]:
    """Return for each part its words and silences, [word, phones], a phone being [name, first frame, frames, score].

    A part is None where its words cannot be what is said, or where it has none.
    """
    decoder = _decoder(lm=None, **EXACT)
    for word, spoken in added.items():
        for at, phones in enumerate(spoken):
            decoder.add_word(word if not at else f"{word}({at + 1})", phones, True)
    found = []
    for part, said in zip(parts, words, strict=True):
        found.append(_aligned(decoder, part, said) if said else None)
        steps.done()
    return found


def _aligned(decoder: Any, samples: bytes, words: Sequence[str]) -> list[Any] | None:
    decoder.set_align_text(" ".join(words))
    _hear(decoder, samples)
    if decoder.hyp() is None:
        return None
    decoder.set_alignment()
    _hear(decoder, samples)
    return [
        [word.name, [[phone.name, phone.start, phone.duration, phone.score] for phone in word]]
        for word in decoder.get_alignment() or ()
    ]


def recognise(parts: Sequence[bytes], steps: _Steps) -> list[list[str]]:
    """Return the words in each part, as they stand in the dictionary."""
    decoder = _decoder()
    found = []
    for part in parts:
        _hear(decoder, part)
        heard = decoder.hyp()
        found.append([word.partition("(")[0] for word in heard.hypstr.split()] if heard is not None else [])
        steps.done()
    return found


def _hear(decoder: Any, samples: bytes) -> None:
    """Run the decoder over one utterance; it is ended whatever happens, or every later one would fail.

    The whole of it goes in at once, for its mean is taken from it.
    """
    decoder.start_utt()
    try:
        if samples:
            decoder.process_raw(samples, full_utt=True)
    finally:
        decoder.end_utt()


def _decoder(**settings: Any) -> Any:
    from pocketsphinx import Decoder, get_model_path

    folder = Path(get_model_path()) / "en-us"
    given = {"lm": str(folder / "en-us.lm.bin"), **settings}
    return Decoder(
        hmm=str(folder / "en-us"), dict=str(folder / "cmudict-en-us.dict"), samprate=RATE, loglevel="FATAL", **given
    )


def _tell(answer: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
