"""`retake fill`: mark a span, get a performance."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from app.cli.reading import AUTOMATIC, SAME, Fps, ReadSides, WrittenSides, open_take, save_take
from app.printing import remark, say
from engine.errors import EditError, FormatError
from engine.formats import format_of, read_take
from engine.formats.base.textfile import read_text
from engine.words import counted

if TYPE_CHECKING:
    from engine.pose import Pose
    from engine.take import Array, Take

TakeFile = Annotated[
    Path, typer.Argument(help="A take: a Live Link Face CSV, folder or zip, or a project.", show_default=False)
]
Spans = Annotated[
    list[str] | None, typer.Option(help="First frame and the one after the last, such as 40:60; may be repeated.")
]
Pins = Annotated[
    list[str] | None,
    typer.Option(help="A pose to go through: 50:jawOpen=.6,mouthFunnel=.2, or 50:OTHER.csv@FRAME; may be repeated."),
]
Visemes = Annotated[Path | None, typer.Option(help="What is said when: a TextGrid, or Rhubarb's TSV, XML or JSON.")]
Curves = Annotated[
    list[str] | None,
    typer.Option(help="An asked curve in mm: lips_vertical=3, =40:3,60:12 by frame, or a file of numbers."),
]


def fill(
    take: TakeFile,
    out: Annotated[Path, typer.Option("-o", "--out", help="The file to write.", show_default=False)],
    frames: Spans = None,
    lost: Annotated[bool, typer.Option("--lost", help="Fill every lost run instead.")] = False,
    region: Annotated[str, typer.Option(help="face, lower, upper, eyes, left or right.")] = "face",
    pin: Pins = None,
    guide: Annotated[Path | None, typer.Option(help="A take of the same rate to follow roughly.")] = None,
    guide_offset: Annotated[int, typer.Option(help="Guide frame minus take frame.")] = 0,
    visemes: Visemes = None,
    visemes_offset: Annotated[float, typer.Option(help="Second of the take at which that file begins.")] = 0.0,
    control: Curves = None,
    style: Annotated[str, typer.Option(help="auto, bridge (a smooth curve) or perform.")] = "auto",
    seed: Annotated[int, typer.Option(min=0, max=2**31 - 1, help="Which of the many possible motions.")] = 0,
    variants: Annotated[int, typer.Option(min=1, max=100, help="How many; each is written to a file of its own.")] = 1,
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
    write_sides: WrittenSides = SAME,
) -> None:
    """Fill a span with believable motion, steered by as much or as little as is given."""
    from engine import editing
    from engine.formats.cues import read_cues
    from engine.speech.visemes import begun_at

    format_of(out)  # better refused now than after the work
    if bool(frames) == lost:
        raise EditError("Say what to fill.", "Give --frames A:B, or --lost for every lost run.")
    opened = open_take(take, fps, sides)
    spans = _spans(opened, frames or [], lost=lost)
    steering = editing.FillRequest(
        frames=spans[0],
        region=region,
        pins=editing.merged_pins([_pin(text) for text in pin or []]),
        guide=read_take(guide) if guide else None,
        guide_offset=guide_offset,
        visemes=begun_at(read_cues(visemes, remark), visemes_offset) if visemes else (),
        controls=_controls(control or [], spans),
        style=cast(editing.Style, style),  # checked with the rest
        lost=lost,
    )
    filled = [
        editing.fill_spans(opened, editing.SpansRequest(tuple(spans), replace(steering, seed=seed + index)))
        for index in range(variants)
    ]
    for index, patch in enumerate(filled):
        path = out if variants == 1 else out.with_stem(f"{out.stem}_{index + 1}")
        save_take(patch.apply(opened), path, write_sides)
        say(f"filled {_said(spans)} with seed {seed + index}; all other frames are as they were; wrote {path}")


def _spans(take: Take, frames: list[str], *, lost: bool) -> list[tuple[int, int]]:
    """Return what is to be filled: the named frames, or every lost run; raises `EditError` where that is nothing."""
    from engine.editing import lost_spans, parse_frames

    spans = list(lost_spans(take)) if lost else [parse_frames(text, take) for text in frames]
    if not spans:
        raise EditError(f"{take.name} has no lost frames.", "Give --frames A:B to fill something else.")
    return spans


def _said(spans: list[tuple[int, int]]) -> str:
    if len(spans) > 4:
        return f"{counted(len(spans), 'span')}, {counted(sum(stop - start for start, stop in spans), 'frame')}"
    return "frames " + ", ".join(f"{start}:{stop}" for start, stop in spans)


def _pin(text: str) -> tuple[int, Pose]:
    frame, _, what = text.partition(":")
    if not _is_frame(frame.strip()) or not what:
        raise EditError(
            f"{text!r} is not a pin.", "Write the frame, a colon and weights: 50:jawOpen=.6 - or a take file."
        )
    if "=" in what:
        return int(frame), dict(_weight(part) for part in what.split(","))
    name, at, which = what.rpartition("@") if "@" in what else (what, "", "0")
    if at and not _is_frame(which):
        raise EditError(f"{which[:40]!r} is not a frame of {Path(name).name}.", "Write OTHER.csv@FRAME.")
    other = read_take(Path(name))
    index = int(which)
    if index >= len(other):
        raise EditError(f"{other.name} has no frame {index}: it has {counted(len(other), 'frame')}.")
    return int(frame), other.weights[index]


def _is_frame(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) < 10


def _weight(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    return name.strip(), _number(value)


def _number(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        raise EditError(f"{text[:40]!r} is not a number.") from None
    if not math.isfinite(number):
        raise EditError(f"{text[:40]!r} is not a finite number.")
    return number


def _controls(texts: list[str], spans: list[tuple[int, int]]) -> dict[str, Array | float]:
    curves: dict[str, Array | float] = {}
    for text in texts:
        name, _, curve = text.partition("=")
        if not curve:
            raise EditError(f"{text!r} is not a control curve.", "Write its name, = and millimetres: lips_vertical=3.")
        if name in curves:
            raise EditError(f"The control {name} is asked for twice.", "Keep one of the two curves.")
        curves[name] = _curve(curve, spans)
    return curves


def _curve(text: str, spans: list[tuple[int, int]]) -> Array | float:
    """Return a constant, a line through frame:mm points, or the numbers in a file, one per frame of the span."""
    import numpy as np

    if os.path.exists(text):
        try:
            numbers: Array = np.array([float(word) for word in read_text(Path(text)).split()])
        except ValueError:
            raise FormatError(f"{Path(text).name} is not a list of numbers.") from None
        if np.isinf(numbers).any() or np.isnan(numbers).all():  # nan asks for nothing at its frame
            raise FormatError(f"{Path(text).name} holds numbers that are not finite, or none.")
        return numbers
    if ":" not in text:
        return _number(text)
    if len(spans) > 1:
        raise EditError("A curve by frame is for one span.", "Fill the spans one after the other.")
    points = sorted((_number(part.partition(":")[0]), _number(part.partition(":")[2])) for part in text.split(","))
    at, values = np.array(points).T
    line: Array = np.interp(np.arange(*spans[0]), at, values)
    return line


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(fill)
