"""`retake pin` and `retake retarget`: poses that spread over a range, and performances that move to another head."""

from __future__ import annotations

import math
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli import labelled
from app.cli.performance import MARKER_HELP, MarkedPerformance, performance_of
from app.cli.reading import AUTOMATIC, SAME, Fps, ReadSides, WrittenSides, open_take, save_take
from app.printing import say
from engine.errors import EditError
from engine.words import counted

if TYPE_CHECKING:
    from engine.character import Character
    from engine.editing import Matching
    from engine.take import Take

STRONGEST = 1e12  # beyond this the system cannot be solved


class Method(StrEnum):
    """How a performance finds its way to another head."""

    SPACETIME = "spacetime"
    MANIFOLD = "manifold"


def pin(
    take: Annotated[Path, typer.Argument(help="The take to edit.")],
    frame: Annotated[int, typer.Option(help="The frame the pose is pinned at.")],
    frames: Annotated[
        str, typer.Option("--range", help="Frames that may change: the first, and the one after the last.")
    ],
    out: Annotated[Path, typer.Option("-o", "--out", help="Where the edited take is written.")],
    weights: Annotated[str, typer.Option(help="Weights of the pose: mouthSmileLeft=.8,jawOpen=.2")] = "",
    controls: Annotated[str, typer.Option("--control", help="Controls of the pose in mm: lips_vertical=0")] = "",
    free: Annotated[bool, typer.Option("--free", help="Pin only the named weights; the others may follow.")] = False,
    closure: Annotated[
        float | None, typer.Option(help="How firmly lips and lids that meet keep meeting; 0 lets go.")
    ] = None,
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
    write_sides: WrittenSides = SAME,
) -> None:
    """Pin a pose at a frame and let it spread over a range."""
    from engine import editing
    from engine.take import SHAPES

    source = open_take(take, fps, sides)
    named = assignments(weights)
    if controls:
        if free:
            raise EditError("A control pins the whole pose.", "Leave out --free, or pin weights instead.")
        pose = editing.pose_reaching(source, frame, assignments(controls))
        named = {**dict(zip(SHAPES, pose.tolist(), strict=True)), **named}
    if not named:
        raise EditError("The pin has no pose.", "Name weights with --weights or controls with --control.")
    strength = None if closure is None else _strength("closure", closure)
    chosen = editing.parse_frames(frames, source)
    asked = editing.PinRequest({frame: named}, chosen, whole=not free, closure=strength)
    save_take(editing.pin(source, asked).apply(source), out, write_sides)
    say(f"Pinned frame {frame} of {source.name}; frames {frames} changed. Written to {out}.")


def retarget(
    source: Annotated[Path, typer.Argument(help="A take, or markers in a CSV, TRC or C3D file.")],
    out: Annotated[Path | None, typer.Option("-o", "--out", help="Where the new take is written.")] = None,
    method: Annotated[
        Method, typer.Option(help="spacetime matches the movement of markers, manifold goes by labelled frames.")
    ] = Method.SPACETIME,
    labels: Annotated[Path | None, typer.Option(help=labelled.LABEL_HELP)] = None,
    suggest: Annotated[int | None, typer.Option(help=labelled.SUGGEST_HELP)] = None,
    character: Annotated[
        Path | None,
        typer.Option(help="The head to move, or second; the Retake head without."),
    ] = None,
    landmarks: Annotated[
        Path | None, typer.Option(help="Which vertex carries which marker: a CSV of marker,vertex.")
    ] = None,
    neutral: Annotated[int, typer.Option(help="For markers: a frame in which the face is at rest.")] = 0,
    unit: Annotated[str | None, typer.Option(help="For markers: mm, cm or m, where the file does not say.")] = None,
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
    alpha: Annotated[float | None, typer.Option(help="How much likely poses count.")] = None,
    beta: Annotated[float | None, typer.Option(help="How much places count beside movements.")] = None,
    closure: Annotated[float | None, typer.Option(help="How firmly lips and lids meet where the source's do.")] = None,
    unbounded: Annotated[bool, typer.Option("--unbounded", help="Let weights leave 0..1.")] = False,
    write_sides: WrittenSides = SAME,
    marker: Annotated[list[str] | None, typer.Option("--marker", help=MARKER_HELP)] = None,
) -> None:
    """Retarget markers or a take to another head."""
    _require_sense(method, labelled=labels is not None or suggest is not None, out=out, suggests=suggest is not None)
    performance = performance_of(
        source, neutral=neutral, unit=unit, fps=fps, sides=sides, marker=marker, placed=landmarks is not None
    )
    if suggest is not None:
        say("\n".join(map(str, labelled.suggest(performance.performance, suggest, labels))))
        return
    assert out is not None
    performance.show()
    if method is Method.MANIFOLD:
        retargeted, target = labelled.retarget(performance, character, labels)
    else:
        matching = _matching(alpha=alpha, beta=beta, closure=closure, unbounded=unbounded)
        retargeted, target = _retargeted(performance, character, landmarks, matching)
    save_take(retargeted, out, write_sides)
    for notice in retargeted.notices:
        say(notice)
    say(f"Moved {target.name} by {counted(len(retargeted), 'frame')} of {source.name}. Written to {out}.")


def _require_sense(method: Method, *, labelled: bool, out: Path | None, suggests: bool) -> None:
    """Raise `EditError` where the options do not go together: before the work starts rather than after it."""
    from engine.formats import format_of

    if method is not Method.MANIFOLD and labelled:
        raise EditError("Labelled frames belong to the other method.", "Add --method manifold.")
    if out is None and not suggests:
        raise EditError("Say where the new take is written.", "Name it with -o.")
    if out is not None:
        format_of(out)


def _matching(*, alpha: float | None, beta: float | None, closure: float | None, unbounded: bool) -> Matching:
    from engine.editing import Matching

    usual = Matching()
    return Matching(
        alpha=_strength("alpha", usual.alpha if alpha is None else alpha),
        beta=_strength("beta", usual.beta if beta is None else beta),
        closure=_strength("closure", usual.closure if closure is None else closure),
        bounds=None if unbounded else usual.bounds,
    )


def _retargeted(
    performance: MarkedPerformance, character: Path | None, landmarks: Path | None, matching: Matching
) -> tuple[Take, Character]:
    from engine import editing
    from engine.character import bundled
    from engine.formats.characters.opening import character_of
    from engine.formats.markers import layout as markers_layout

    target = bundled() if character is None else character_of(character)
    given = markers_layout.read(landmarks, head=target) if landmarks is not None else None
    places = performance.places(target) if given is None else given
    return editing.retarget(performance.performance, editing.RetargetRequest(target, places, matching)).take, target


def assignments(text: str) -> dict[str, float]:
    """Return the values that `a=.8,b=.2` names; raises `EditError` for what is not that."""
    values: dict[str, float] = {}
    for part in filter(None, (piece.strip() for piece in text.split(","))):
        name, _, value = part.partition("=")
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if math.isfinite(number):
            values[name.strip()] = number
        else:
            raise EditError(f"{part!r} is not a name and a number.", "Write them as jawOpen=.2.")
    return values


def _strength(name: str, value: float) -> float:
    if not 0 <= value <= STRONGEST:
        raise EditError(f"{name} must be a number from 0 to {STRONGEST:g}.")
    return value


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(pin)
    app.command()(retarget)
