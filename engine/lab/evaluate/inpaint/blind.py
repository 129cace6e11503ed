"""A blind sheet after BSS20 section 5.3: stretches of motion, half recorded and half with a filled span, and their scoring."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from engine.errors import FormatError
from engine.formats.base.textfile import read_text
from engine.inpaint.infer import bundled
from engine.lab.corpus import Piece
from engine.lab.evaluate.inpaint.table import GUIDANCE, Hole, guided, holes
from engine.take import MODEL_FPS, Take

COUNT = 40
SPANS_S = (1.0, 1.5, 2.0, 3.0)
BESIDE = 30  # frames of recorded motion shown before and after a span
ANSWERS = ("recorded", "filled")


@dataclass(frozen=True, eq=False)
class Exhibit:
    """One movie of the sheet: what is shown, and the truth that the key keeps."""

    name: str
    take: Take
    answer: str
    span_s: float
    guidance: str


def exhibits(pieces: Sequence[Piece], *, seed: int = 0, count: int = COUNT) -> list[Exhibit]:
    """Return stretches in random order, half recorded and half filled, alike in length and place.

    Every guidance kind has an equal share of the filled ones. The same seed gives the same sheet.
    """
    rng = np.random.default_rng(seed)
    faces = [piece for piece in pieces if piece.whole_face]
    shown: list[tuple[Take, str, float, str]] = []
    seen: list[Hole] = []
    for index in range(count):
        span, kind = SPANS_S[index // 2 % len(SPANS_S)], GUIDANCE[index // 2 % len(GUIDANCE)]
        hole = _fresh(holes(faces, round(span * MODEL_FPS), 4 * count), seen, rng)
        seen.append(hole)
        answer = ANSWERS[index % 2]
        filled = answer == "filled"
        weights = bundled().fill(guided(hole, kind, rng), seeds=(index,))[0] if filled else hole.truth
        first, last = max(0, hole.rows[0] - BESIDE), hole.rows[-1] + 1 + BESIDE
        shown.append((Take(weights[first:last], MODEL_FPS), answer, span, kind if filled else "none"))
    order = rng.permutation(len(shown))
    return [Exhibit(f"{place + 1:02d}", *shown[which]) for place, which in enumerate(order)]


def _fresh(found: Sequence[Hole], seen: Sequence[Hole], rng: np.random.Generator) -> Hole:
    """Return one of many holes that shares least with those seen: a stretch shown twice gives its filled copy away."""
    shared = [sum(_shared(hole, other) for other in seen) for hole in found]
    least = np.flatnonzero(np.array(shared) == min(shared))
    return found[int(rng.choice(least))]


def _shared(hole: Hole, other: Hole) -> int:
    """Return how many frames two holes have in common."""
    first, stop = max(hole.start, other.start), min(hole.start + len(hole.rows), other.start + len(other.rows))
    return max(0, stop - first) if hole.piece == other.piece else 0


def key_of(sheet: Sequence[Exhibit]) -> str:
    """Return the key as JSON."""
    return json.dumps(
        {one.name: {"answer": one.answer, "span_s": one.span_s, "guidance": one.guidance} for one in sheet}, indent=1
    )


def score(answers: Path, key: Path) -> dict[str, float]:
    """Return how often recorded and filled stretches were taken for recorded, from one person's answers.

    `answers` is a table of `movie,answer`; the paper reports 0.54 and 0.51. Raises `FormatError` for other tables.
    """
    try:
        truth = {name: one["answer"] for name, one in json.loads(read_text(key)).items()}
        given = [
            (row["movie"], row["answer"].strip().lower()) for row in csv.DictReader(read_text(answers).splitlines())
        ]
    except (ValueError, KeyError, TypeError, AttributeError):
        raise FormatError("The answers or the key are not those of a blind sheet.") from None
    wrong = [f"{name}: {answer!r}" for name, answer in given if answer not in ANSWERS or name not in truth]
    if wrong or not given:
        raise FormatError(
            f"{answers.name} has no answer that counts: {(wrong or ['empty'])[0]}.",
            "Write recorded or filled behind each.",
        )
    figures = {"answers": float(len(given))}
    for kind in ANSWERS:
        judged = [answer == "recorded" for name, answer in given if truth[name] == kind]
        figures[f"{kind}_taken_for_recorded"] = float(np.mean(judged)) if judged else float("nan")
    figures["right"] = float(np.mean([answer == truth[name] for name, answer in given]))
    return figures
