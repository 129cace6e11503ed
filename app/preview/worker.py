"""The render thread: creates, uses and closes the only renderer."""

from __future__ import annotations

from dataclasses import dataclass

from app.background import LatestWins
from app.preview.renderer import Picture, Renderer, Shot
from app.session.sides import Side
from engine import character
from engine.character import Character


@dataclass(frozen=True, eq=False)
class Wanted:
    """What to draw.

    Attributes
    ----------
    character : whose face; None is the bundled one
    since : when what it shows was done, or arrived; 0 where nobody waits
    live : whether it shows a live face
    strip : whether it is a strip of variants
    sides : what it shows side by side, for what is drawn over it
    view : which of the preview's views it is, likewise
    """

    shot: Shot
    character: Character | None = None
    since: float = 0.0
    live: bool = False
    strip: bool = False
    sides: tuple[Side, ...] = ()
    view: str = ""


class RenderJob:
    """Draws what is wanted; makes its renderer on first use, on the thread that calls it."""

    def __init__(self) -> None:
        self._renderer: Renderer | None = None

    def __call__(self, wanted: Wanted) -> Picture:
        """Return the picture of a shot."""
        shown = wanted.character or character.bundled()
        if self._renderer is None:
            self._renderer = Renderer(shown)
        self._renderer.character = shown
        return self._renderer.draw(wanted.shot)

    def close(self) -> None:
        """Close the renderer."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None


def render_thread() -> LatestWins:
    """Return the running thread."""
    job = RenderJob()
    return LatestWins(job, name="render", close=job.close)
