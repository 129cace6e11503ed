"""Fills a span of a take at any frame rate, in any region, with or without pins, a guide, visemes and controls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from scipy.interpolate import make_interp_spline

from engine.controls import CONTROL_INDEX, CONTROLS, bundled_measurer
from engine.errors import EditError
from engine.inpaint import seams
from engine.inpaint.gap import Gap, gap_of
from engine.inpaint.infer import Filler, bundled
from engine.inpaint.regions import region_shapes
from engine.inpaint.request import FillRequest, Style, checked
from engine.inpaint.seams import bridge_weights, constrain
from engine.models.resample import interpolate
from engine.pose import Pose
from engine.speech.visemes import Cue, classes_over, one_hot
from engine.take import MODEL_FPS, Array, Mask, Take, runs


@dataclass(frozen=True)
class Tuning:
    """Settings of a fill; ranges tried were not recorded."""

    bridge_s: float = 0.25  # seconds; spans up to here are nearer to the truth when interpolated than when generated
    context_frames: int = 60  # model frames on either side that the network is given
    retrieval_frames: int = 5400  # model frames on either side that motion may be retrieved from
    seam_frames: int = 2  # known frames on either side; two fix value and slope
    # Lips or lids nearer than `closed_mm` are kept together by a pull of `hold` against the correction onto the seams.
    closed_mm: float = 1.5  # mm
    hold: float = 0.25  # strength beside squared accelerations


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class Fill:
    """A filled take and its inputs.

    Attributes
    ----------
    take : the take with the span filled and not lost any more; known frames outside it are as they were, bit for bit
    span : half-open range of frames that was filled
    seed : which of the many possible motions this is
    style : "bridge" for a smooth curve, "perform" for the network's motion
    inputs : the request; `refill` runs it again, with more pins or another seed
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
    """Fill a span of a take with motion (BSS20), with one variant per seed from `seed` on.

    Parameters
    ----------
    frames : half-open range to fill
    region : which shapes: face, lower, upper, eyes, left or right
    pins : poses met exactly, by frame: (52,) weights, or some weights by shape
    guide : another take, of the same rate, to follow roughly; its frame is the take's plus `guide_offset`
    visemes : visemes or phones with their times in seconds of the take
    controls : target curves in mm by control, one value per frame of the span or a single value; NaN for no target
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
    """Fill a span by a request, once per seed or with the request's own; raises `EditError` as `fill` does."""
    seeds = (request.seed,) if seeds is None else seeds
    if not len(seeds):
        raise EditError("At least one variant must be asked for.")
    request = checked(request, take)
    style = _style(request, take)
    window = _Window.of(take, request.frames)
    gap = _gap(take, request, window)
    if style == "bridge":
        motions = np.repeat(bridge_weights(gap.known)[None], len(seeds), axis=0)
    else:
        gap = gap if gap.guided.any() else replace(gap, rest=_rest_of(take, [request.frames, *request.besides]))
        motions = (filler or bundled()).fill(gap, seeds=seeds)
    return [
        Fill(_insert(take, request, motion, window), request.frames, seed, style, replace(request, seed=seed))
        for seed, motion in zip(seeds, motions, strict=True)
    ]


def fill_spans(take: Take, spans: Sequence[tuple[int, int]], request: FillRequest, *, seed: int = 0) -> Take:
    """Fill several spans one after the other, each with the pins and controls that lie in it.

    Raises `EditError` for spans that overlap and for a pin outside all of them.
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
    """Return the lost runs of a take as spans, half-open ranges of frames."""
    return runs(take.lost)


def fill_lost(take: Take, *, seed: int = 0, request: FillRequest | None = None) -> Take:
    """Fill every lost run; short ones are interpolated and long ones generated unless `request` has another style."""
    request = request or FillRequest((0, 0))
    return fill_spans(take, lost_spans(take), replace(request, lost=True), seed=seed)


def _style(request: FillRequest, take: Take) -> Style:
    if request.style != "auto":
        return request.style
    guided = request.guide is not None or request.visemes or request.controls
    short = (request.frames[1] - request.frames[0]) / take.fps <= TUNING.bridge_s
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
        first = max(0, int(np.floor(span[0] / pace)) - TUNING.context_frames)
        last = min(int(np.ceil((len(take) - 1) / pace)), int(np.ceil(span[1] / pace)) + TUNING.context_frames)
        return cls(first, max(2, last - first + 1), pace)

    @property
    def at(self) -> Array:
        """The take's frame at each model frame, fractional."""
        return np.asarray((self.first + np.arange(self.frames)) * self.pace, np.float64)

    def nearest(self, frame: int) -> int:
        """The model frame, counted from the window's first, nearest to a frame of the take."""
        return int(np.clip(round(frame / self.pace) - self.first, 0, self.frames - 1))


def _gap(take: Take, request: FillRequest, window: _Window) -> Gap:
    """Return the span with its context and guidance, resampled to the model frames of a window."""
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
    """Return which frames, (frames,), are no context: lost ones, and further spans that are not filled yet."""
    unknown: Mask = take.lost.copy()
    for start, stop in request.unmade:
        unknown[start:stop] = True
    unknown[slice(*request.frames)] &= take.lost[slice(*request.frames)]
    return unknown


def _rest_of(take: Take, spans: Sequence[tuple[int, int]]) -> list[Array]:
    """Return the known stretches around the first of the spans and outside all of them, resampled to the model rate."""
    pace = take.fps / MODEL_FPS
    known: Mask = ~take.lost
    for start, stop in spans:
        known[start:stop] = False
    reach = round(TUNING.retrieval_frames * pace)
    known[: max(0, spans[0][0] - reach)] = known[spans[0][1] + reach :] = False
    steps = [(start, np.arange(0.0, stop - 1 - start, pace)) for start, stop in runs(known)]
    if pace == 1:
        return [take.weights[start : start + len(at)] for start, at in steps]
    return [interpolate(take.weights, start + at) for start, at in steps]


def _controls(request: FillRequest, window: _Window, inside: np.ndarray) -> Array:
    """Return control targets at a window's model frames, (frames, 8) mm, NaN where there is none."""
    curves = np.full((window.frames, len(CONTROLS)), np.nan)
    start, stop = request.frames
    for name, curve in request.controls.items():
        target = np.broadcast_to(np.asarray(curve, np.float64), (stop - start,))[:, None]
        curves[inside, CONTROL_INDEX[name]] = interpolate(target, window.at[inside] - start)[:, 0]
    return curves


def _insert(take: Take, request: FillRequest, motion: Array, window: _Window) -> Take:
    """Insert motion at the model rate into the take's span and region, corrected onto its seams and pins."""
    (start, stop), shapes = request.frames, np.flatnonzero(region_shapes(request.region))
    first, last = max(0, start - TUNING.seam_frames), min(len(take), stop + TUNING.seam_frames)
    known = take.weights[first:last].copy()
    known[np.ix_(np.arange(start, stop) - first, shapes)] = np.nan
    known[take.lost[first:last]] = np.nan  # they follow the fill, not the fill them
    for frame, pose in request.poses().items():
        row = known[frame - first]
        known[frame - first] = np.where(np.isnan(row), pose, row)
    rows_of = _cut if window.pace == 1 else _resample
    weights = rows_of(motion, window, first, last)
    there = np.isfinite(known)
    # Seams are missed at another rate, or where a span beside this one is not filled yet.
    if there.any() and not np.array_equal(weights[there], known[there]):
        reach_frames = seams.TUNING.reach_frames * window.pace
        weights = constrain(weights, known, reach_frames=reach_frames, hold=_closure_hold(weights))
        weights = np.where(there, known, np.clip(weights, 0.0, 1.0))
    rows = take.weights[start:stop].copy()
    rows[:, shapes] = weights[start - first : stop - first][:, shapes]
    return take.with_rows(start, rows, found=np.ones(stop - start, bool))


def _cut(motion: Array, window: _Window, first: int, last: int) -> Array:
    """Return motion at the take's frames [first, last), where the take runs at the model rate."""
    return motion[first - window.first : last - window.first]


def _resample(motion: Array, window: _Window, first: int, last: int) -> Array:
    """Resample motion to the take's own frames [first, last), by a cubic spline through the model frames."""
    degree = 3 if window.frames > 3 else 1
    spline = make_interp_spline(window.at, motion, k=degree, axis=0)
    return np.asarray(spline(np.clip(np.arange(first, last), window.at[0], window.at[-1])))


def _closure_hold(weights: Array) -> Array:
    """Return the pull against the correction onto the seams, (frames,): `hold` where lips or lids meet, else 0."""
    gaps = bundled_measurer().measure(np.clip(weights, 0.0, 1.0))
    columns = [CONTROL_INDEX[name] for name in ("lips_vertical", "eyelid_right", "eyelid_left")]
    return np.asarray(TUNING.hold * (gaps[:, columns].min(axis=1) < TUNING.closed_mm))
