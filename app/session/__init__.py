"""What is open, what is done to it and how it is kept; it knows no panel."""

from app.session.session import MAX_OFFSET_S, MEDIA, RADII_S, Change, Session

__all__ = ["MAX_OFFSET_S", "MEDIA", "RADII_S", "Change", "Session"]
