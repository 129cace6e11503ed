"""Edits a take repeatedly while a pointer moves: expensive preparations are cached between requests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from engine import retouch
from engine.editing.drags import Dragger, ask
from engine.editing.requests import (
    CleanRequest,
    ControlRequest,
    DragRequest,
    PasteRequest,
    PinRequest,
    Request,
    SmoothRequest,
    SpansRequest,
    WeightRequest,
)
from engine.errors import EditError
from engine.extended import bundled_face
from engine.inpaint.request import FillRequest
from engine.patch import Patch
from engine.take import SHAPE_INDEX, Array, Take

if TYPE_CHECKING:
    from engine.clean.takes import Cleaned
    from engine.spacetime.pin import PinSolver


class Editor:
    """Returns patches for requests to a take; a patch depends on the take and the request alone.

    Parameters
    ----------
    take : what is edited
    controls : its curves, (frames, 16), where they have been measured already
    asked : targets of earlier edits, (frames, 16), NaN for none, which drags do not undo
    """

    def __init__(self, take: Take, controls: Array | None = None, *, asked: Array | None = None) -> None:
        self.take = take
        self._controls, self._asked = controls, asked
        self._pins: tuple[object, PinSolver] | None = None  # for which frames, and how
        self._cleaned: Cleaned | None = None  # at full strength

    def patch(self, request: Request) -> Patch:
        """Return the patch of a request; raises `EditError` where it does not fit the take."""
        return _PATCHES[type(request)](self, request)

    @cached_property
    def controls(self) -> Array:
        """The take's control curves, (frames, 16)."""
        return bundled_face().measure(self.take.weights) if self._controls is None else self._controls

    @cached_property
    def dragger(self) -> Dragger:
        """The solver of drags; the first use loads the networks."""
        return Dragger(self.take, self._controls, asked=self._asked)

    def _drag(self, request: DragRequest) -> Patch:
        return self.dragger.drag(request.start, request.asked, believability=request.believability)

    def _control(self, request: ControlRequest) -> Patch:
        start, asked = ask(
            self.dragger.controls,
            request.control,
            request.frames,
            request.change,
            request.amount,
            fps=self.take.fps,
        )
        return self.dragger.drag(start, asked, believability=request.believability)

    def _weight(self, request: WeightRequest) -> Patch:
        if request.shape not in SHAPE_INDEX:
            raise EditError(f"There is no shape called {request.shape!r}.", "Shapes have ARKit names, such as jawOpen.")
        return retouch.replace_weight(self.take, SHAPE_INDEX[request.shape], request.start, request.curve)

    def _paste(self, request: PasteRequest) -> Patch:
        return retouch.paste(self.take, request.start, request.weights, feather_s=request.feather_s)

    def _smooth(self, request: SmoothRequest) -> Patch:
        return retouch.smooth(self.take, request.frames, request.cutoff_hz, feather_s=request.feather_s)

    def cleaned(self, frames: tuple[int, int]) -> Cleaned:
        """Return frames cleaned at full strength, and what was removed."""
        from engine.clean.takes import clean

        if self._cleaned is None or self._cleaned.touched != frames:
            self._cleaned = clean(self.take, frames=frames)
        return self._cleaned

    def _clean(self, request: CleanRequest) -> Patch:
        if not 0.0 <= request.strength <= 1.0:
            raise EditError(f"A strength of {request.strength:g} is not between 0 and 1.")
        (start, stop), cleaned = request.frames, self.cleaned(request.frames)
        raw = self.take.weights[start:stop]
        mixed = self.take.with_rows(start, raw + request.strength * (cleaned.take.weights[start:stop] - raw))
        return replace(Patch.between(self.take, mixed, request.frames), lag_ms=cleaned.lag_ms)

    def _pin(self, request: PinRequest) -> Patch:
        from engine.spacetime.pin import PinSolver, Spreading

        usual = Spreading()
        spreading = usual if request.closure is None else Spreading(usual.alpha, request.closure, usual.stiffness)
        which = (tuple(request.pins), request.frames, request.whole, request.closure)
        if self._pins is None or self._pins[0] != which or not request.whole:
            solver = PinSolver(self.take, request.pins, request.frames, whole=request.whole, spreading=spreading)
            self._pins = which, solver
        return Patch.between(self.take, self._pins[1].take(request.pins), request.frames)

    def variants(self, request: FillRequest, count: int) -> list[Patch]:
        """Return a fill for each seed from the request's seed on; a smooth curve has a single variant."""
        from engine.inpaint.fill import refill

        fills = refill(self.take, request, seeds=range(request.seed, request.seed + count))
        different = fills[:1] if fills[0].style == "bridge" else fills
        return [Patch.between(self.take, each.take, each.span) for each in different]

    def _fill(self, request: FillRequest) -> Patch:
        return self.variants(request, 1)[0]

    def _spans(self, request: SpansRequest) -> Patch:
        from engine.inpaint.fill import fill_spans

        filled = fill_spans(self.take, request.spans, request.steering, seed=request.steering.seed)
        return Patch.between(self.take, filled, request.frames)


_PATCHES: dict[type, Callable[[Editor, Any], Patch]] = {
    DragRequest: Editor._drag,
    ControlRequest: Editor._control,
    WeightRequest: Editor._weight,
    PasteRequest: Editor._paste,
    SmoothRequest: Editor._smooth,
    CleanRequest: Editor._clean,
    PinRequest: Editor._pin,
    FillRequest: Editor._fill,
    SpansRequest: Editor._spans,
}
