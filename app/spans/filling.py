"""Fills under way: variants are made on a thread of their own, shown as drafts, and one is kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QObject, Signal

from app.session import Change, Session
from app.session.asked import Asked, Base
from app.session.edits import Runner, Tell
from engine.controls import CONTROLS
from engine.editing import FillRequest, fill_variants
from engine.project import Span
from engine.project.records import FILL
from engine.speech.visemes import Cue
from engine.take import Array, Mask
from engine.words import counted

if TYPE_CHECKING:
    from engine.editing import Patch

VARIANTS = 6


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
        self.seed = 0  # of the first of the variants that were asked for last
        self._shown: Asked | None = None  # what the variants came of
        self._seen: tuple[int, int] | None = None  # the span whose variants were shown last
        self._runner = Runner(session, _carry_out, name="fill")
        self._runner.arrived.connect(self._arrived)
        self._runner.failed.connect(self._refused)
        session.changed.connect(self._on_change)

    @property
    def idle(self) -> bool:
        """Whether nothing is being made."""
        return self._runner.idle

    @property
    def busy(self) -> bool:
        """Whether variants are being made, perhaps others than those that are shown."""
        return self._runner.last is not None and self._runner.last is not self._shown

    @property
    def chosen_seed(self) -> int:
        """What the variant that is shown was drawn from; with the same steering it gives the same motion."""
        return self.first - 1 + self.chosen

    @property
    def title(self) -> str:
        """What to call the variant that is shown; others that are asked for count on."""
        if len(self.variants) == 1:
            return "A smooth bridge: there is only one"
        return f"Variant {self.chosen_seed + 1} · seed {self.chosen_seed}"

    @property
    def first(self) -> int:
        """The number of the first of the variants: a seed and one more."""
        return 1 + (_request(self._shown).seed if self._shown is not None else self.seed)

    def start(
        self, span: Span, how: FillRequest | None = None, *, keep_curves: bool = False, keep_visemes: bool = False
    ) -> None:
        """Make variants for a span, others than were shown of it before; pins that lie in it are met.

        `how` says in which style and by which guide. With `keep_curves` the span's asked curves are followed, with
        `keep_visemes` the mouth says what the visemes lane does.
        """
        marks, frames = self._session.document.marks, (span.start, span.stop)
        others = tuple((other.start, other.stop) for other in marks.spans if other != span)
        filled = _filled(self._session)
        request = replace(
            how or FillRequest(frames),
            frames=frames,
            region=span.region,
            pins={pin.frame: dict(pin.weights) for pin in marks.pins if span.start <= pin.frame < span.stop},
            visemes=self.said(span) if keep_visemes else (),
            controls=self._asked(span) if keep_curves else {},
            besides=others,
            unmade=tuple((start, stop) for start, stop in others if not filled[start:stop].all()),
        )
        self._make(replace(request, seed=self.seed + VARIANTS * (self._seen == frames)))

    def make_again(self, inputs: Mapping[str, Any]) -> None:
        """Make variants of a fill that was kept, the kept one first; raises `EditError` where it cannot be told how."""
        self._make(FillRequest.restored(inputs))

    def _make(self, request: FillRequest) -> None:
        self.seed = request.seed
        title = f"fill {counted(request.frames[1] - request.frames[0], 'frame')}"
        self._runner.ask(Asked(FILL, request, Base.of(self._session.document), title, variants=VARIANTS))
        self.changed.emit()

    def said(self, span: Span) -> tuple[Cue, ...]:
        """Return the cues of the visemes lane that reach into a span, in seconds of the take."""
        lane, fps = self._session.document.visemes, self._session.document.take.fps
        return lane.over(span.start / fps, span.stop / fps) if lane is not None else ()

    def again(self) -> None:
        """Make other variants of the same span, steered by the same."""
        if self._runner.last is not None:
            self._make(replace(_request(self._runner.last), seed=self.seed + VARIANTS))

    def choose(self, index: int) -> None:
        """Show a variant, counted around."""
        if self.variants:
            self.chosen = index % len(self.variants)
            self._session.document.set_draft(self.variants[self.chosen])
            self.changed.emit()

    def accept(self) -> None:
        """Keep the variant that is shown, as one undo step."""
        if self.variants and self._shown is not None:
            kept, patch = replace(_request(self._shown), seed=self.chosen_seed), self.variants[self.chosen]
            asked = replace(self._shown, inputs=kept)
            self._forget()
            self._runner.keep(asked, patch)

    def drop(self) -> None:
        """Keep none."""
        if self.variants or self.busy:
            self._forget()
            self._session.document.set_draft(None)

    def close(self) -> None:
        """End the thread."""
        self._runner.close()

    def _forget(self) -> None:
        self.variants, self._shown = [], None
        self._runner.drop()
        self.changed.emit()

    def _asked(self, span: Span) -> dict[str, Array]:
        asked = self._session.document.asked[span.start : span.stop]
        return {
            control.name: asked[:, column]
            for column, control in enumerate(CONTROLS)
            if np.isfinite(asked[:, column]).any()
        }

    def _arrived(self, asked: Asked, patches: list[Patch]) -> None:
        if self._runner.is_last(asked):
            self.variants, self._shown, self._seen = patches, asked, asked.frames
            self._session.view.move_playhead(sum(asked.frames) // 2)
            self.choose(0)

    def _refused(self, sentence: str, advice: str) -> None:
        self._forget()
        self.failed.emit(sentence, advice)

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            self.seed, self._seen = 0, None
        if change & (Change.TAKE | Change.READING) or (change & Change.CURVES and (self.variants or self.busy)):
            self._forget()


def _request(asked: Asked) -> FillRequest:
    assert isinstance(asked.inputs, FillRequest)
    return asked.inputs


def _filled(session: Session) -> Mask:
    """Return which frames, (frames,) bool, fills in effect have made."""
    filled = np.zeros(len(session.document.take), bool)
    contents = session.document.contents()
    for edit in contents.edits[: contents.position]:
        if edit.kind == FILL:
            filled[edit.start : edit.stop] = True if edit.lost is None else ~edit.lost
    return filled


def _carry_out(asked: Asked, _: Tell) -> list[Patch]:
    return fill_variants(asked.of.take, _request(asked), asked.variants)
