"""The `.retake` file: a performance, all that was done to it, and what people noted beside it, in one SQLite database."""

from engine.formats.base.lock import InUseError
from engine.project.claim import DisplacedError
from engine.project.media import Found, attach, find, name_of, placed
from engine.project.records import (
    ALIGN,
    MARK,
    READING,
    VISEMES,
    Contents,
    Edit,
    Marks,
    Media,
    Pin,
    Span,
    Summary,
    mark_edit,
    marks_of,
    read_as_of,
    reading_edit,
)
from engine.project.replaying import Before, Replayed, replay
from engine.project.reviewing import Drawing, Note, Reply, Verdict, stamp
from engine.project.store import ENDING, Project, create, delete, peek, recover
from engine.project.visemes import VisemeChange, change_between, viseme_edit

__all__ = [
    "ALIGN",
    "ENDING",
    "MARK",
    "READING",
    "VISEMES",
    "Before",
    "Contents",
    "DisplacedError",
    "Drawing",
    "Edit",
    "Found",
    "InUseError",
    "Marks",
    "Media",
    "Note",
    "Pin",
    "Project",
    "Replayed",
    "Reply",
    "Span",
    "Summary",
    "Verdict",
    "VisemeChange",
    "attach",
    "change_between",
    "create",
    "delete",
    "find",
    "mark_edit",
    "marks_of",
    "name_of",
    "peek",
    "placed",
    "read_as_of",
    "reading_edit",
    "recover",
    "replay",
    "stamp",
    "viseme_edit",
]
