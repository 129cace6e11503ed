"""How the attached sound lies against the take, in words."""

from __future__ import annotations

from app.session.session import Session

SLACK_S = 0.05  # a difference that nobody hears


def beyond_the_take(session: Session) -> str:
    """Return what of the sound lies before the take's first frame or after its last; empty where nothing does."""
    if session.document.audio is None:
        return ""
    begins_s = session.document.offset_s("audio")
    before_s, after_s = -begins_s, begins_s + session.document.audio.duration_s - session.document.take.duration_s
    parts = []
    if before_s > SLACK_S:
        parts.append(f"begins {_seconds(min(before_s, session.document.audio.duration_s))} before the take")
    if after_s > SLACK_S:
        parts.append(f"goes on {_seconds(min(after_s, session.document.audio.duration_s))} after the take's end")
    return f"The sound {' and '.join(parts)}; that is not heard." if parts else ""


def _seconds(time_s: float) -> str:
    return f"{time_s:.1f} s" if time_s < 60 else f"{int(time_s // 60)} min {time_s % 60:02.0f} s"
