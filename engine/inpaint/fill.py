"""Filling a span of a take: any frame rate, any region, steered by pins, a guide, visemes and controls, or by nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from scipy.interpolate import make_interp_spline

from engine.controls import CONTROL_INDEX, CONTROLS, bundled_measurer
from engine.errors import EditError
from engine.inpaint.gap import Gap, gap_of
from engine.inpaint.infer import Filler, bundled
from engine.inpaint.regions import region_shapes
from engine.inpaint.request import FillRequest, Style, checked
from engine.inpaint.seams import REACH_FRAMES, bridged, land
from engine.models.resample import interpolate
from engine.pose import Pose
from engine.speech.visemes import Cue, classes_over, one_hot
from engine.take import MODEL_FPS, Array, Mask, Take, runs

BRIDGE_S = 0.25  # up to here a smooth curve through the seams is closer to what was there than a performance
_CONTEXT = 60  # model frames on either side that the network looks at
_LENDING = 5400  # model frames on either side that may lend motion to a long span
_SEAM = 2  # known frames on either side that fix value and slope
_CLOSED_MM, _HOLD = 1.5, 0.25  # where lips or lids meet in the fill, landing on the seams must not part them


@dataclass(frozen=True, eq=False)
class Fill:
    """A filled take and what it was made from.

    Attributes
    ----------
    take : the take with the span filled and not lost any more; known frames outside it are as they were, bit for bit
    span : half-open range of frames that was filled
    seed : which of the many possible motions this is
    style : "bridge" for a smooth curve, "perform" for the network's motion
    inputs : what steered it; `refill` runs it again, with more pins or another seed
    """

    take: Take
    span: tuple[int, int]
    seed: int
    style: Style
    inputs: FillRequest = field(repr=False)


def fill(
    take: Take,
    frames: tuple[int, int],
    *,
    region: str = "face",
    pins: Mapping[int, Pose] | None = None,
    guide: Take | None = None,
    guide_offset: int = 0,
    visemes: Sequence[Cue] = (),
    controls: Mapping[str, Array | float] | None = None,
    style: Style = "auto",
    seed: int = 0,
    variants: int = 1,
    filler: Filler | None = None,
) -> list[Fill]:
    """Fill a span of a take with motion (BSS20), one variant per seed from `seed` on.

    Parameters
    ----------
    frames : half-open range to fill
    region : which shapes: face, lower, upper, eyes, left or right
    pins : poses to go through exactly, by frame: (52,) weights, or some weights by shape
    guide : another take, of the same rate, to follow roughly; its frame is the take's plus `guide_offset`
    visemes : what is said when, in seconds of the take
    controls : asked control curves in mm by name, one value per frame of the span or one for all; NaN asks for nothing
    style : "bridge" for a smooth curve, "perform" for the network's motion; "auto" bridges short unguided spans

    Raises `EditError`, with nothing changed, for a span, pins or guidance that do not fit the take.
    """
    request = FillRequest(
        frames, region, dict(pins or {}), guide, guide_offset, tuple(visemes), dict(controls or {}), style
    )
    return refill(take, request, seeds=range(seed, seed + variants), filler=filler)


def refill(
    take: Take,
    request: FillRequest,
    *,
    seeds: Sequence[int] | None = None,
    filler: Filler | None = None,
) -> list[Fill]:
    """Fill a span as `request` says, once per seed, its own without any; raises `EditError` as `fill` does."""
    seeds = (request.seed,) if seeds is None else seeds
    if not len(seeds):
        raise EditError("At least one variant must be asked for.")
    request = checked(request, take)
    style = _style(request, take)
    window = _Window.of(take, request.frames)
    gap = _gap(take, request, window)
    if style == "bridge":
        made = np.repeat(bridged(gap.known)[None], len(seeds), axis=0)
    else:
        gap = gap if gap.guided.any() else replace(gap, rest=_rest(take, [request.frames, *request.besides]))
        made = (filler or bundled()).fill(gap, seeds=seeds)
    return [
        Fill(_placed(take, request, motion, window), request.frames, seed, style, replace(request, seed=seed))
        for seed, motion in zip(seeds, made, strict=True)
    ]


def fill_spans(take: Take, spans: Sequence[tuple[int, int]], request: FillRequest, *, seed: int = 0) -> Take:
    """Fill several spans one after the other, each with the pins and controls that lie in it.

    Raises `EditError` for spans that overlap or share no pin with one that is asked for.
    """
    ordered = sorted(spans)
    for (_, stop), (start, _) in pairwise(ordered):
        if start < stop:
            raise EditError(f"Two spans overlap at frame {start}.", "Join them into one, or fill one after the other.")
    stray = [frame for frame in request.pins if not any(start <= frame < stop for start, stop in ordered)]
    if stray:
        raise EditError(f"The pin at frame {stray[0]} lies outside the span.", "Pins steer frames of the span.")
    for index, (start, stop) in enumerate(ordered):
        inside = {frame: pose for frame, pose in request.pins.items() if start <= frame < stop}
        part = replace(
            request, frames=(start, stop), pins=inside, besides=tuple(ordered), unmade=tuple(ordered[index + 1 :])
        )
        take = refill(take, part, seeds=(seed,))[0].take
    return take


def lost_spans(take: Take) -> list[tuple[int, int]]:
    """Return the lost runs of a take as spans ready to fill."""
    return runs(take.lost)


def fill_lost(take: Take, *, seed: int = 0, request: FillRequest | None = None) -> Take:
    """Fill every lost run; short ones are bridged and long ones performed unless `request` says otherwise."""
    request = request or FillRequest((0, 0))
    return fill_spans(take, lost_spans(take), replace(request, lost=True), seed=seed)


def _style(request: FillRequest, take: Take) -> Style:
    if request.style != "auto":
        return request.style
    guided = request.guide is not None or request.visemes or request.controls
    short = (request.frames[1] - request.frames[0]) / take.fps <= BRIDGE_S
    return "bridge" if short and not guided else "perform"


@dataclass(frozen=True)
class _Window:
    """Model frames [first, first + frames) around a span; `pace` take frames pass in one of them."""

    first: int
    frames: int
    pace: float

    @classmethod
    def of(cls, take: Take, span: tuple[int, int]) -> _Window:
        pace = take.fps / MODEL_FPS
        first = max(0, int(np.floor(span[0] / pace)) - _CONTEXT)
        last = min(int(np.ceil((len(take) - 1) / pace)), int(np.ceil(span[1] / pace)) + _CONTEXT)
        return cls(first, max(2, last - first + 1), pace)

    @property
    def at(self) -> Array:
        """The take's frame at each model frame, fractional."""
        return np.asarray((self.first + np.arange(self.frames)) * self.pace, np.float64)

    def nearest(self, frame: int) -> int:
        """The model frame, counted from the window's first, nearest to a frame of the take."""
        return int(np.clip(round(frame / self.pace) - self.first, 0, self.frames - 1))


def _gap(take: Take, request: FillRequest, window: _Window) -> Gap:
    (start, stop), shapes = request.frames, region_shapes(request.region)
    known = interpolate(take.weights, window.at)
    inside = (window.at > start - 1) & (window.at < stop)
    known[np.ix_(inside, shapes)] = np.nan
    known[interpolate(_unknown(take, request).astype(np.float64)[:, None], window.at)[:, 0] > 0] = np.nan
    for frame, pose in request.poses().items():
        row = window.nearest(frame)
        known[row] = np.where(np.isfinite(pose) & np.isnan(known[row]), pose, known[row])
    hole = np.isnan(known)
    guide = None
    if request.guide is not None:
        source = np.where(request.guide.lost[:, None], np.nan, request.guide.weights)
        guide = np.where(hole, interpolate(source, window.at + request.guide_offset), np.nan)
    shift = window.first / MODEL_FPS
    moved = [Cue(cue.start_s - shift, cue.stop_s - shift, cue.label) for cue in request.visemes]
    classes = np.where(inside, classes_over(moved, frames=window.frames, fps=MODEL_FPS), -1)
    return gap_of(known, guide=guide, visemes=one_hot(classes), controls=_controls(request, window, inside))


def _unknown(take: Take, request: FillRequest) -> Mask:
    """Return which frames, (frames,), nobody knows anything of: lost ones, and further spans that are not filled yet."""
    unknown: Mask = take.lost.copy()
    for start, stop in request.unmade:
        unknown[start:stop] = True
    unknown[slice(*request.frames)] &= take.lost[slice(*request.frames)]
    return unknown


def _rest(take: Take, spans: Sequence[tuple[int, int]]) -> list[Array]:
    """Return what is known of a take around the first of the spans and outside all of them, at the model rate."""
    pace = take.fps / MODEL_FPS
    known: Mask = ~take.lost
    for start, stop in spans:
        known[start:stop] = False
    reach = round(_LENDING * pace)
    known[: max(0, spans[0][0] - reach)] = known[spans[0][1] + reach :] = False
    steps = [(start, np.arange(0.0, stop - 1 - start, pace)) for start, stop in runs(known)]
    if pace == 1:
        return [take.weights[start : start + len(at)] for start, at in steps]
    return [interpolate(take.weights, start + at) for start, at in steps]


def _controls(request: FillRequest, window: _Window, inside: np.ndarray) -> Array:
    curves = np.full((window.frames, len(CONTROLS)), np.nan)
    start, stop = request.frames
    for name, curve in request.controls.items():
        asked = np.broadcast_to(np.asarray(curve, np.float64), (stop - start,))[:, None]
        curves[inside, CONTROL_INDEX[name]] = interpolate(asked, window.at[inside] - start)[:, 0]
    return curves


def _placed(take: Take, request: FillRequest, motion: Array, window: _Window) -> Take:
    """Put motion at the model rate into the take's span and region, through its seams and pins."""
    (start, stop), shapes = request.frames, np.flatnonzero(region_shapes(request.region))
    first, last = max(0, start - _SEAM), min(len(take), stop + _SEAM)
    known = take.weights[first:last].copy()
    known[np.ix_(np.arange(start, stop) - first, shapes)] = np.nan
    known[take.lost[first:last]] = np.nan  # they follow the fill, not the fill them
    for frame, pose in request.poses().items():
        row = known[frame - first]
        known[frame - first] = np.where(np.isnan(row), pose, row)
    made = (
        motion[first - window.first : last - window.first]
        if window.pace == 1
        else _resampled(motion, window, first, last)
    )
    there = np.isfinite(known)
    if there.any() and not np.array_equal(
        made[there], known[there]
    ):  # another rate, or a span beside it is not filled yet
        made = land(made, known, reach_frames=REACH_FRAMES * window.pace, hold=_closures(made))
        made = np.where(there, known, np.clip(made, 0.0, 1.0))
    rows = take.weights[start:stop].copy()
    rows[:, shapes] = made[start - first : stop - first][:, shapes]
    return take.with_rows(start, rows, found=np.ones(stop - start, bool))


def _resampled(motion: Array, window: _Window, first: int, last: int) -> Array:
    """Return motion at the take's own frames [first, last), by a cubic spline through the model frames."""
    degree = 3 if window.frames > 3 else 1
    spline = make_interp_spline(window.at, motion, k=degree, axis=0)
    return np.asarray(spline(np.clip(np.arange(first, last), window.at[0], window.at[-1])))


def _closures(made: Array) -> Array:
    """Return how much each frame's pose is held while landing, (frames,): at lips or lids that meet."""
    gaps = bundled_measurer().measure(np.clip(made, 0.0, 1.0))
    columns = [CONTROL_INDEX[name] for name in ("lips_vertical", "eyelid_right", "eyelid_left")]
    return np.asarray(_HOLD * (gaps[:, columns].min(axis=1) < _CLOSED_MM))
