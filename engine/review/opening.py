"""A file as a reviewer sees it: the take, what it was made from, what was noted, and the sound that goes with it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from engine.formats import audio, livelink, read_take
from engine.formats.reading import Reading
from engine.project import ENDING, Marks, Project, replay
from engine.project.media import find
from engine.quality import Seen, seen_of, sound_of
from engine.review.changes import Edited
from engine.review.report import Remark
from engine.take import Take

AS_IT_IS = Reading()


@dataclass(frozen=True, eq=False)
class Opened:
    """What a file holds for a reviewer.

    Attributes
    ----------
    path : of the file
    take : with the edits in effect
    original : what it was made from, where the file tells
    seen : what is looked at for flags
    marks : what people put beside it
    edits : those that changed frames, in order
    """

    path: Path
    take: Take
    original: Take | None
    seen: Seen
    marks: Marks = Marks()
    edits: tuple[Edited, ...] = ()

    @property
    def remarks(self) -> tuple[Remark, ...]:
        """The notes."""
        return tuple(Remark(note.frame, note.author, note.time, note.text) for note in self.marks.notes)

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
        heard = sound_of(audio.read(path), fps=self.take.fps, offset_s=offset_s)
        return replace(self, seen=replace(self.seen, sound=heard))


def opened(path: Path, reading: Reading = AS_IT_IS) -> Opened:
    """Read a take or a project; what a `reading` does not ask for stays as a project has it.

    Raises `EngineError` where it cannot be read.
    """
    if path.suffix.lower() != ENDING:
        take = read_take(path, reading=reading)
        return Opened(path, take, None, seen_of(take))
    project = Project.open(path, read_only=True)
    try:
        contents = project.contents
    finally:
        project.close()
    state = replay(contents)
    take = livelink.reread(state.take, reading, keep=True)
    original = livelink.reread(state.original or contents.original, reading, keep=True)
    in_effect = contents.edits[: contents.position]
    edits = tuple(Edited(edit.title, edit.start, edit.stop) for edit in in_effect if len(edit.weights))
    seen = seen_of(take, original, state.asked, state.visemes)
    return Opened(path, take, original, seen, contents.marks, edits)
