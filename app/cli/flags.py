"""`retake flags`: what a reviewer should look at."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.reading import AUTOMATIC, Fps, ReadSides, open_take, sides_of
from app.printing import remark, say
from engine.take import timecode
from engine.words import counted

if TYPE_CHECKING:
    from engine.formats.base.reading import Reading
    from engine.quality import Seen, Sound
    from engine.speech.lane import VisemeLane
    from engine.take import Take

COLUMNS = ("frame", "stop", "time", "kind", "weight", "sentence")


def flags(
    take: Annotated[Path, typer.Argument(help="A take, or a project with its edits.", show_default=False)],
    out: Annotated[Path | None, typer.Option("-o", "--out", help="A CSV to write; the screen without it.")] = None,
    original: Annotated[
        Path | None, typer.Option(help="The take before its edits: where did lips meet that now do not?")
    ] = None,
    visemes: Annotated[
        Path | None, typer.Option(help="What is said when, so that lips which should meet are looked for.")
    ] = None,
    visemes_offset: Annotated[float, typer.Option(help="Second of the take at which that file begins.")] = 0.0,
    audio: Annotated[
        Path | None, typer.Option(help="The take's sound, so that lips out of step with it are looked for.")
    ] = None,
    audio_offset: Annotated[float, typer.Option(help="Second of the take at which the sound begins.")] = 0.0,
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
) -> None:
    """List frames to look at: what the tracker spoilt, faces that no face makes, edits that show, lips off the sound."""
    from engine.formats.base.atomic import write_bytes
    from engine.formats.base.reading import Reading
    from engine.quality import flags_of

    reading = Reading(fps, sides_of(sides))
    seen = _seen(take, reading, open_take(original, fps, sides) if original else None, _lane(visemes, visemes_offset))
    found = flags_of(replace(seen, sound=_sound(audio, seen.fps, audio_offset)))
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for flag in found:
        time = timecode(flag.start / seen.fps, seen.fps)
        table.writerow((flag.start, flag.stop, time, flag.kind, f"{flag.weight:.2f}", flag.sentence))
    if out is None:
        say(text.getvalue(), end="")
    else:
        write_bytes(out, [text.getvalue().encode()])
        say(f"{counted(len(found), 'flag')}; wrote {out}")


def _sound(path: Path | None, fps: float, offset_s: float) -> Sound | None:
    from engine.formats.audio import read
    from engine.quality import sound_of

    return sound_of(read(path), fps=fps, offset_s=offset_s) if path is not None else None


def _lane(path: Path | None, offset_s: float) -> VisemeLane | None:
    from engine.formats.cues import read_cues
    from engine.speech.lane import attached, shifted

    if path is None:
        return None
    cues = read_cues(path, remark)
    return shifted(attached(cues, path.name), offset_s) if cues else None


def _seen(path: Path, reading: Reading, original: Take | None, lane: VisemeLane | None) -> Seen:
    """Return what there is to look at; a project brings its own original, asked curves and visemes."""
    from engine.formats import livelink, read_take
    from engine.project import ENDING, Project, replay
    from engine.quality import seen_of

    if path.suffix.lower() != ENDING:
        return seen_of(read_take(path, reading=reading), original, visemes=lane)
    project = Project.open(path, read_only=True)
    try:
        state = replay(project.contents)
        shown = livelink.reread(state.take, reading, keep=True)
        before = original or livelink.reread(project.contents.original, reading, keep=True)
        return seen_of(shown, before, state.asked, lane or state.visemes)
    finally:
        project.close()


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(flags)
