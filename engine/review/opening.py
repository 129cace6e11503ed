"""The content of a file for a reviewer: the take, its original, notes, and sound."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from engine.errors import EditError
from engine.formats import audio, livelink, read_take
from engine.formats.base.reading import Reading
from engine.project import ENDING, Marks, Project, replay
from engine.project.media import find
from engine.quality import Flag, Seen, Sound, flags_of, seen_of, sound_of
from engine.review.changes import Edited
from engine.speech.lane import VisemeLane
from engine.take import Array, Take

AS_IT_IS = Reading()


@dataclass(frozen=True, eq=False)
class Opened:
    """What a file holds for a reviewer.

    Attributes
    ----------
    path : of the file
    take : with the edits in effect
    original : the take before the edits, where the file has it
    asked : (frames, controls) control targets, NaN for none; None where there is none anywhere
    visemes : the viseme lane, where the file has it
    marks : what people put beside it
    edits : those that changed frames, in order
    sound : what is heard; None where nobody listened
    """

    path: Path
    take: Take
    original: Take | None = None
    asked: Array | None = None
    visemes: VisemeLane | None = None
    marks: Marks = field(default_factory=Marks)
    edits: tuple[Edited, ...] = ()
    sound: Sound | None = None

    @cached_property
    def seen(self) -> Seen:
        """The input of the flags."""
        return seen_of(self.take, self.original, self.asked, self.visemes, sound=self.sound)

    def flags(self, also: Iterable[str] = ()) -> tuple[Flag, ...]:
        """Return every finding that the file's settings count, and those of the kinds `also`; dismissed ones too."""
        settings = self.marks.flags
        for kind in also:
            settings = settings.with_count(kind, on=True)
        return flags_of(self.seen, settings)

    def require_original(self) -> Take:
        """Return the take before the edits; raises `EditError` where the file does not have it."""
        if self.original is None:
            raise EditError(
                f"{self.path.name} does not hold what it was made from.",
                "Name the take before its edits, then the one after.",
            )
        return self.original

    def sound_file(self) -> tuple[Path, float] | None:
        """Return the recording that goes with it and the time of the take at which that begins; None without one.

        A project's is the one that was attached, where it is still to be found; a take's lies beside it.
        """
        medium = self.marks.medium("audio")
        if medium is None:
            beside = audio.beside(self.path)
            return None if beside is None else (beside, 0.0)
        found = find(medium, self.path.parent).path
        return None if found is None else (found, 0.0 - medium.offset_s)

    def with_sound(self) -> Opened:
        """Return the same with its sound looked at too; raises `FormatError` where that cannot be read."""
        found = self.sound_file()
        if found is None:
            return self
        path, offset_s = found
        return replace(self, sound=sound_of(audio.read(path), fps=self.take.fps, offset_s=offset_s))


def opened(path: Path, reading: Reading = AS_IT_IS) -> Opened:
    """Read a take or a project; what a `reading` does not ask for stays as a project has it.

    Raises `EngineError` where it cannot be read.
    """
    if path.suffix.lower() != ENDING:
        return Opened(path, read_take(path, reading=reading))
    project = Project.open(path, read_only=True)
    try:
        contents = project.contents
    finally:
        project.close()
    state = replay(contents)
    in_effect = contents.edits[: contents.position]
    return Opened(
        path,
        livelink.reread(state.take, reading, keep=True),
        livelink.reread(state.original or contents.original, reading, keep=True),
        state.asked,
        state.visemes,
        contents.marks,
        tuple(Edited(edit.title, edit.start, edit.stop) for edit in in_effect if len(edit.weights)),
    )
