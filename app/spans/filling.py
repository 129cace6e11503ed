"""Fills under way: variants are made on a thread of their own, shown as drafts, and one is kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.session import Change, Session
from app.session.commands import EditCommand
from engine.controls import CONTROLS
from engine.inpaint.request import Request, Style
from engine.inpaint.stored import restored, stored
from engine.project import Span
from engine.project.records import FILL
from engine.speech.visemes import Cue
from engine.take import Array, Mask, Take
from engine.words import counted

if TYPE_CHECKING:
    from engine.editing import Patch

VARIANTS = 6


@dataclass(frozen=True, eq=False)
class FillRequest:
    """A take, what steers the fill of one of its spans, and the seed of the first variant."""

    take: Take
    steering: Request
    seed: int

    @property
    def inputs(self) -> dict[str, Any]:
        """What a project file remembers, so that the fill can be made again bit for bit."""
        return stored(self.steering)


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
        self._seen: tuple[int, int] | None = None  # the span whose variants were shown last
        self._work = LatestWins(_variants, name="fill")
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
        return self._first_seed + self.chosen

    @property
    def title(self) -> str:
        """What to call the variant that is shown; others that are asked for count on."""
        if len(self.variants) == 1:
            return "A smooth bridge: there is only one"
        return f"Variant {self.chosen_seed + 1} · seed {self.chosen_seed}"

    @property
    def first(self) -> int:
        """The number of the first of the variants: a seed and one more."""
        return self._first_seed + 1

    @property
    def _first_seed(self) -> int:
        return self._request.seed if self._request else self.seed

    def start(
        self,
        span: Span,
        *,
        style: Style = "auto",
        guide: Take | None = None,
        guide_offset: int = 0,
        keep_curves: bool = False,
        keep_visemes: bool = False,
    ) -> None:
        """Make variants for a span, others than were shown of it before; pins that lie in it are met.

        With `keep_curves` its asked curves are followed, with `keep_visemes` the mouth says what the visemes lane does.
        """
        session = self._session
        inside = [pin for pin in session.document.marks.pins if span.start <= pin.frame < span.stop]
        others = [(other.start, other.stop) for other in session.document.marks.spans if other != span]
        filled = _filled(session)
        steering = Request(
            frames=(span.start, span.stop),
            region=span.region,
            pins={pin.frame: dict(pin.weights) for pin in inside},
            guide=guide,
            guide_offset=guide_offset,
            visemes=self.said(span) if keep_visemes else (),
            controls=self._asked(span) if keep_curves else {},
            style=style,
            besides=tuple(others),
            unmade=tuple((start, stop) for start, stop in others if not filled[start:stop].all()),
        )
        self._make(steering, self.seed + VARIANTS * (self._seen == steering.frames))

    def make_again(self, inputs: Mapping[str, Any]) -> None:
        """Make variants of a fill that was kept, the kept one first; raises `EditError` where it cannot be told how."""
        seed = inputs.get("seed", 0)
        self._make(restored(inputs), seed if isinstance(seed, int) and seed >= 0 else 0)

    def _make(self, steering: Request, seed: int) -> None:
        self.busy, self.seed = True, seed
        self._request = FillRequest(self._session.document.take, steering, seed)
        self._work.submit(self._request)
        self.changed.emit()

    def said(self, span: Span) -> tuple[Cue, ...]:
        """Return the cues of the visemes lane that reach into a span, in seconds of the take."""
        lane, fps = self._session.document.visemes, self._session.document.take.fps
        return lane.over(span.start / fps, span.stop / fps) if lane is not None else ()

    def again(self) -> None:
        """Make other variants of the same span, steered by the same."""
        if self._request is not None:
            self._make(self._request.steering, self.seed + VARIANTS)

    def choose(self, index: int) -> None:
        """Show a variant, counted around."""
        if self.variants:
            self.chosen = index % len(self.variants)
            self._session.document.set_draft(self.variants[self.chosen])
            self.changed.emit()

    def accept(self) -> None:
        """Keep the variant that is shown, as one undo step."""
        if not self.variants or self._request is None:
            return
        request, patch = self._request, self.variants[self.chosen]
        start, stop = request.steering.frames
        inputs = {**request.inputs, "seed": self.chosen_seed}
        self._forget()
        title = f"fill {counted(stop - start, 'frame')}"
        self._session.document.undo.push(EditCommand.of(self._session.document, patch, title, kind=FILL, inputs=inputs))

    def drop(self) -> None:
        """Keep none."""
        if self.variants or self.busy:
            self._forget()
            self._session.document.set_draft(None)

    def close(self) -> None:
        """End the thread."""
        self._work.stop()

    def _forget(self) -> None:
        self.variants, self.busy, self._request = [], False, None
        self.changed.emit()

    def _asked(self, span: Span) -> dict[str, Array]:
        asked = self._session.document.asked[span.start : span.stop]
        return {
            control.name: asked[:, column]
            for column, control in enumerate(CONTROLS)
            if np.isfinite(asked[:, column]).any()
        }

    def _arrived(self, request: FillRequest, patches: list[Patch]) -> None:
        if request is not self._request or request.take is not self._session.document.take:
            return
        self.variants, self.busy, self._seen = patches, False, request.steering.frames
        self._session.view.move_playhead(sum(request.steering.frames) // 2)
        self.choose(0)

    def _refused(self, request: FillRequest, sentence: str, advice: str) -> None:
        self._forget()
        self.failed.emit(sentence, advice)

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            self.seed, self._seen = 0, None
        if change & (Change.TAKE | Change.READING) or (change & Change.CURVES and self.variants):
            self._forget()


def _filled(session: Session) -> Mask:
    """Return which frames, (frames,) bool, fills in effect have made."""
    filled = np.zeros(len(session.document.take), bool)
    contents = session.document.contents()
    for edit in contents.edits[: contents.position]:
        if edit.kind == FILL:
            filled[edit.start : edit.stop] = True if edit.lost is None else ~edit.lost
    return filled


def _variants(request: FillRequest) -> list[Patch]:
    from engine.editing import Patch
    from engine.inpaint.fill import refill

    fills = refill(request.take, request.steering, seeds=range(request.seed, request.seed + VARIANTS))
    different = fills[:1] if fills[0].style == "bridge" else fills  # there is one smooth curve
    return [Patch.between(request.take, made.take, made.span) for made in different]
