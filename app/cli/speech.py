"""`retake speech`: what is said when in a recording."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.progress import Shown, telling
from app.cli.reading import AUTOMATIC, Fps, ReadSides, open_take
from app.printing import remark, say
from engine.errors import EditError
from engine.words import counted

if TYPE_CHECKING:
    from engine.speech.transcript import Transcript
    from engine.take import Take

Recording = Annotated[
    Path, typer.Argument(help="A recording: WAV, FLAC or OGG, or a film with sound.", show_default=False)
]
Out = Annotated[Path, typer.Option("-o", "--out", help="A .TextGrid or .csv file to write.", show_default=False)]
Text = Annotated[Path | None, typer.Option("--text", help="What is said, as a text file; recognised without it.")]
Language = Annotated[str, typer.Option(help="Of the text, as eSpeak NG names it, such as en-us, de or fr.")]
TakeBeside = Annotated[
    Path | None, typer.Option("--take", help="The take that the recording belongs to: its lips are compared.")
]
Offset = Annotated[float, typer.Option(help="Second of the take at which the recording begins.")]


def speech(
    audio: Recording,
    out: Out,
    text: Text = None,
    take: TakeBeside = None,
    audio_offset: Offset = 0.0,
    language: Language = "en-us",
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
    progress: Shown = None,
) -> None:
    """Find the words and phones of a recording, for fill --visemes; with --text its words are aligned."""
    from engine.formats import audio as recordings
    from engine.formats import transcripts
    from engine.formats.base.textfile import read_text
    from engine.speech.hearing import transcribed

    opened = open_take(take, fps, sides) if take is not None else None
    words = read_text(text) if text is not None else None
    recording = recordings.read(audio)
    follow = _following(progress)
    found = transcribed(recording.samples, recording.rate, text=words, language=language, follow=follow)
    transcripts.write(found, out)
    _tell(found)
    if opened is not None:
        _compare(found, opened, audio_offset)
    say(f"wrote {out}")


def _following(shown: bool | None) -> Callable[[float], bool]:
    tell = telling("listening", shown)

    def follow(part: float) -> bool:
        tell(round(1000 * part), 1000)
        return True

    return follow


def _tell(found: Transcript) -> None:
    from engine.speech.transcript import doubt

    phones = sum(cue.label != "SIL" for cue in found.phones)
    heard = "heard" if found.heard else "aligned"
    say(f"{heard} {counted(len(found.said), 'word')}, {counted(phones, 'phone')} in {found.duration_s:.2f} s")
    if found.missed:
        remark(f"Nothing fits {counted(len(found.missed), 'stretch', 'stretches')} in which something was heard.")
    if sentence := doubt(found):
        remark(sentence)


def _compare(found: Transcript, take: Take, offset_s: float) -> None:
    from engine.speech.bilabials import closures
    from engine.speech.visemes import require_time

    require_time(offset_s)
    if offset_s >= take.duration_s or offset_s + found.duration_s <= 0:
        raise EditError("The recording does not lie in the take.", "Give another --audio-offset.")
    met = closures(found, take, offset_s=offset_s)
    if met.said:
        say(f"the lips meet at {met.closed} of {met.said} M, B and P; by chance they would at {met.by_chance:.1f}")


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(speech)
