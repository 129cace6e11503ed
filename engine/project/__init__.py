"""The `.retake` file: a performance, all that was done to it, and what people noted beside it, in one SQLite database."""

from engine.project.media import Found, attach, find
from engine.project.records import Contents, Edit, Marks, Media, Note, Pin, Replayed, Span, replay
from engine.project.store import ENDING, InUseError, Project, Summary, create, delete, peek

__all__ = [
    "ENDING",
    "Contents",
    "Edit",
    "Found",
    "InUseError",
    "Marks",
    "Media",
    "Note",
    "Pin",
    "Project",
    "Replayed",
    "Span",
    "Summary",
    "attach",
    "create",
    "delete",
    "find",
    "peek",
    "replay",
]
