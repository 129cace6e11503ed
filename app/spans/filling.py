"""Fills under way: variants are made on a thread of their own, shown as drafts, and one is kept."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.session import Change, Session
from app.session.commands import EditCommand
from engine.controls import CONTROLS
from engine.project import Span
from engine.speech.visemes import Cue
from engine.take import Array, Take
from engine.words import counted

if TYPE_CHECKING:
    from engine.editing import Patch

VARIANTS = 6


@dataclass(frozen=True, eq=False)
class FillRequest:
    """What is filled, with what; as `engine.inpaint.fill.fill` takes it."""

    take: Take
    span: Span
    pins: dict[int, dict[str, float]]
    controls: dict[str, Array]
    guide: Take | None
    guide_offset: int
    style: str
    seed: int
    visemes: tuple[Cue, ...] = ()

    @property
    def inputs(self) -> dict[str, Any]:
        """What a project file remembers, so that the fill can be made again."""
        return {
            "frames": [self.span.start, self.span.stop],
            "region": self.span.region,
            "pins": {str(frame): pose for frame, pose in self.pins.items()},
            "controls": sorted(self.controls),
            "guide": self.guide.name if self.guide else "",
            "guide_offset": self.guide_offset,
            "visemes": [[cue.start_s, cue.stop_s, cue.label] for cue in self.visemes],
            "style": self.style,
        }


class Filling(QObject):
    """Makes variants of a fill, shows the chosen one as the session's draft, and keeps it on request.

    Parameters
    ----------
    session : whose spans are filled
    """

    changed = Signal()  # variants, the chosen one, or whether they are being made
    failed = Signal(str, str)

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.variants: list[Patch] = []
        self.chosen = 0
        self.seed = 0
        self.busy = False
        self._request: FillRequest | None = None
        self._work = LatestWins(_make, name="fill")
        self._work.done.connect(self._arrived)
        self._work.failed.connect(self._refused)
        session.changed.connect(self._on_change)

    @property
    def idle(self) -> bool:
        """Whether nothing is being made."""
        return self._work.idle

    @property
    def chosen_seed(self) -> int:
        """What the variant that is shown was drawn from; with the same steering it gives the same motion."""
        return (self._request.seed if self._request else self.seed) + self.chosen

    def start(
        self,
        span: Span,
        *,
        style: str = "auto",
        guide: Take | None = None,
        guide_offset: int = 0,
        keep_curves: bool = False,
        keep_visemes: bool = False,
    ) -> None:
        """Make variants for a span; pins that lie in it are met.

        With `keep_curves` its asked curves are followed, with `keep_visemes` the mouth says what the visemes lane does.
        """
        session = self._session
        inside = [pin for pin in session.marks.pins if span.start <= pin.frame < span.stop]
        pins = {pin.frame: dict(pin.weights) for pin in inside}
        controls = self._asked(span) if keep_curves else {}
        self.busy = True
        visemes = self.said(span) if keep_visemes else ()
        self._request = FillRequest(session.take, span, pins, controls, guide, guide_offset, style, self.seed, visemes)
        self._work.submit(self._request)
        self.changed.emit()

    def said(self, span: Span) -> tuple[Cue, ...]:
        """Return the cues of the visemes lane that reach into a span, in seconds of the take."""
        lane, fps = self._session.visemes, self._session.take.fps
        return lane.over(span.start / fps, span.stop / fps) if lane is not None else ()

    def again(self) -> None:
        """Make other variants of the same span, steered by the same."""
        if self._request is not None:
            self.seed += VARIANTS
            self.busy = True
            self._request = replace(self._request, seed=self.seed)
            self._work.submit(self._request)
            self.changed.emit()

    def choose(self, index: int) -> None:
        """Show a variant, counted around."""
        if self.variants:
            self.chosen = index % len(self.variants)
            self._session.set_draft(self.variants[self.chosen])
            self.changed.emit()

    def accept(self) -> None:
        """Keep the variant that is shown, as one undo step."""
        if not self.variants or self._request is None:
            return
        request, patch = self._request, self.variants[self.chosen]
        frames = request.span.stop - request.span.start
        inputs = {**request.inputs, "seed": self.chosen_seed}
        self._forget()
        title = f"fill {counted(frames, 'frame')}"
        self._session.undo.push(EditCommand(self._session, patch, title, kind="fill", inputs=inputs))

    def drop(self) -> None:
        """Keep none."""
        if self.variants or self.busy:
            self._forget()
            self._session.set_draft(None)

    def close(self) -> None:
        """End the thread."""
        self._work.stop()

    def _forget(self) -> None:
        self.variants, self.busy, self._request = [], False, None
        self.changed.emit()

    def _asked(self, span: Span) -> dict[str, Array]:
        asked = self._session.asked[span.start : span.stop]
        return {
            control.name: asked[:, column]
            for column, control in enumerate(CONTROLS)
            if np.isfinite(asked[:, column]).any()
        }

    def _arrived(self, request: FillRequest, patches: list[Patch]) -> None:
        if request is not self._request or request.take is not self._session.take:
            return
        self.variants, self.busy = patches, False
        self._session.move_playhead((request.span.start + request.span.stop) // 2)
        self.choose(0)

    def _refused(self, request: FillRequest, sentence: str, advice: str) -> None:
        self._forget()
        self.failed.emit(sentence, advice)

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE or (change & Change.CURVES and self.variants):
            self._forget()


def _make(request: FillRequest) -> list[Patch]:
    from engine.editing import Patch
    from engine.inpaint.fill import fill

    span = request.span
    fills = fill(
        request.take,
        (span.start, span.stop),
        region=span.region,
        pins=request.pins,
        guide=request.guide,
        guide_offset=request.guide_offset,
        visemes=request.visemes,
        controls=request.controls,
        style=request.style,  # type: ignore[arg-type]  # the section offers only what there is
        seed=request.seed,
        variants=1 if request.style == "bridge" else VARIANTS,
    )
    return [Patch.between(request.take, made.take, made.span) for made in fills]
