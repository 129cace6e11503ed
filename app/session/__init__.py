"""What is open, what is done to it and how it is kept; it knows no panel."""

from app.session.changes import Change
from app.session.document import MAX_OFFSET_S, MEDIA, Document
from app.session.session import Session
from app.session.view import RADII_S, View
from engine.editing import DEFAULT_BELIEVABILITY

__all__ = ["DEFAULT_BELIEVABILITY", "MAX_OFFSET_S", "MEDIA", "RADII_S", "Change", "Document", "Session", "View"]
