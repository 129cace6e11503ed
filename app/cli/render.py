"""`retake render`: a take drawn as a picture or a movie, alone or beside another."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.progress import Shown, telling
from app.cli.reading import AUTOMATIC, Fps, ReadSides, sides_of
from app.cli.takes import Out, TakeFile
from app.printing import remark, say
from engine.errors import EditError, EngineError
from engine.words import counted

if TYPE_CHECKING:
    from app.preview.captions import Captions
    from app.preview.movie import Movie
    from app.preview.soundtrack import Soundtrack
    from engine.formats.base.reading import Reading
    from engine.review.opening import Opened
    from engine.take import Take


def render(
    take: TakeFile,
    out: Out,
    frame: Annotated[int | None, typer.Option(help="The frame of a picture; the first without it.")] = None,
    compare: Annotated[Path | None, typer.Option(help="Another take to draw at its right, on its clock.")] = None,
    offset: Annotated[float | None, typer.Option(help="Seconds by which that take begins later.")] = None,
    before_edits: Annotated[
        bool, typer.Option("--before-edits", help="Draw a project's take before its edits at its left.")
    ] = False,
    difference: Annotated[
        bool, typer.Option("--difference", help="Draw a third face: how far the second is from the first.")
    ] = False,
    burn_in: Annotated[
        bool, typer.Option("--burn-in", help="Write names, timecode, frame and notes beneath the faces.")
    ] = False,
    sound: Annotated[bool, typer.Option("--sound/--no-sound", help="A movie has the take's sound.")] = True,
    audio: Annotated[
        Path | None, typer.Option(help="The sound; a project's own, or the file beside a take, without.")
    ] = None,
    audio_offset: Annotated[float, typer.Option(help="Second of the take at which that sound begins.")] = 0.0,
    character: Annotated[
        Path | None,
        typer.Option(help="A head to draw it on, or second; the Retake head without."),
    ] = None,
    size: Annotated[int, typer.Option(help="Height of the faces in pixels.", min=64, max=4096)] = 720,
    codec: Annotated[
        str | None, typer.Option(help="Of a movie: av1, vp9, mpeg4, or h264 for players that know nothing else.")
    ] = None,
    progress: Shown = None,
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
) -> None:
    """Draw a take: a PNG of one frame, or an MP4 of all of it with its sound."""
    from app.preview import movie
    from engine.formats.base.reading import Reading

    shown, noted = _shown(take, compare, Reading(fps, sides_of(sides)), before_edits=before_edits, offset_s=offset)
    if difference and len(shown) == 1:
        raise EditError("A difference needs two takes.", "Name another one with --compare, or add --before-edits.")
    if frame is not None and not all(0 <= frame < len(each) for each in shown):
        raise EditError(f"Frame {frame} is not within the take, which has {counted(min(map(len, shown)), 'frame')}.")
    if character is not None:
        from engine.formats.characters.opening import character_of

        movie.use(character_of(character))
    captions = _captions(shown, noted, difference=difference) if burn_in else None
    drawn = movie.Movie(shown, size, None, difference, captions)
    if out.suffix.lower() == ".png":
        movie.write_still(drawn, frame or 0, out)
    elif out.suffix.lower() == ".mp4":
        heard = _sound(noted, audio, audio_offset) if sound else None
        _write(drawn, heard, out, codec, progress)
    else:
        raise EditError(f"{out.name} is neither a picture nor a movie.", "Use a name that ends in .png or .mp4.")
    say(f"wrote {out}")


def _shown(
    take: Path, compare: Path | None, reading: Reading, *, before_edits: bool, offset_s: float | None
) -> tuple[tuple[Take, ...], Opened]:
    """Return what is drawn from left to right, and the file whose clock, notes and sound the movie has."""
    from engine.review.align import beside
    from engine.review.opening import opened

    first = opened(take, reading)
    if before_edits and compare is not None:
        raise EditError("--compare and --before-edits exclude each other.", "Give the one that you mean.")
    if before_edits:
        return (first.require_original(), first.take), first
    if compare is None:
        return (first.take,), first
    second = opened(compare, reading)
    return (beside(first.take, second.take, offset_s=offset_s), second.take), second


def _captions(shown: tuple[Take, ...], noted: Opened, *, difference: bool) -> Captions:
    from app.preview.captions import Captions, Said
    from app.preview.renderer import HEAT_FULL_MM
    from engine.review.counting import counting_of

    names = [each.name for each in shown]
    if len(names) > 1:
        names = [f"{word}: {name}" for word, name in zip(("Before", "After"), names, strict=True)]
    if difference:
        names.append(f"Difference, white is {HEAT_FULL_MM:g} mm or more")
    counting = counting_of(noted.take.fps)
    notes = [
        Said(note.frame, note.stop, f"{note.author}: {note.text}") for note in noted.marks.notes if not note.resolved
    ]
    first = counting.count_at(noted.take.start_s)
    return Captions(tuple(names), counting, first, tuple(sorted(notes, key=lambda note: note.start)))


def _sound(noted: Opened, named: Path | None, offset_s: float) -> Soundtrack | None:
    """Return the sound; a recording that was found beside the take and cannot be read is reported and left out."""
    from app.preview.soundtrack import Soundtrack
    from engine.formats.audio import read

    if named is not None:
        return Soundtrack(read(named), offset_s)
    found = noted.sound_file()
    if found is None:
        return None
    try:
        return Soundtrack(read(found[0]), found[1])
    except EngineError as error:
        remark(f"{error} The movie has no sound.")
        return None


def _write(drawn: Movie, heard: Soundtrack | None, out: Path, codec: str | None, progress: bool | None) -> None:
    from dataclasses import replace

    from app.preview import movie

    movie.write(replace(drawn, sound=heard), out, codec=codec, progress=telling("drawing", progress))


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(render)
