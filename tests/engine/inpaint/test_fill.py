from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from engine.controls import measure
from engine.errors import EditError
from engine.inpaint.fill import Fill, fill, fill_lost, fill_spans, lost_spans, refill
from engine.inpaint.infer import Filler
from engine.inpaint.network import Generator, GeneratorConfig
from engine.inpaint.regions import REGIONS, region_shapes
from engine.inpaint.request import FillRequest, merged_pins
from engine.inpaint.statistics import statistics_of
from engine.lab.performer import demo
from engine.lab.performer.performer import perform
from engine.models.resample import interpolate
from engine.speech.visemes import Cue
from engine.take import SHAPE_INDEX, SHAPES, Take

SPAN = (60, 130)


@pytest.fixture(scope="module")
def take() -> Take:
    return perform(replace(demo.SCRIPT, lost_s=((2.0, 2.1), (8.4, 9.2))))


@pytest.fixture(scope="module")
def filler(take: Take) -> Filler:
    """A small network that has learnt nothing, so that it throws the face about: exactness must not need training."""
    torch.manual_seed(0)
    generator = Generator(GeneratorConfig(hidden=16))
    torch.nn.init.normal_(generator.dense.weight, std=0.3)
    return Filler(generator, statistics_of(take.weights))


def at_rate(take: Take, fps: float) -> Take:
    frames = np.arange(int((len(take) - 1) * fps / take.fps)) * take.fps / fps
    return Take(interpolate(take.weights, frames), fps)


def outside(made: Fill, take: Take, region: str = "face") -> np.ndarray:
    inside = np.zeros(take.weights.shape, bool)
    inside[made.span[0] : made.span[1], region_shapes(region)] = True
    return ~inside


@pytest.mark.parametrize("region", list(REGIONS))
@pytest.mark.parametrize("fps", [24.0, 30.0, 60.0])
def test_nothing_changes_outside_the_span_and_region(take: Take, filler: Filler, region: str, fps: float) -> None:
    source = at_rate(take, fps)
    made = fill(source, SPAN, region=region, filler=filler)[0]
    untouched = outside(made, source, region)
    np.testing.assert_array_equal(made.take.weights[untouched], source.weights[untouched])
    assert np.abs(made.take.weights - source.weights)[~untouched].max() > 0.05
    assert made.take.weights.min() >= 0 and made.take.weights.max() <= 1


@pytest.mark.parametrize("fps", [24.0, 30.0, 59.94, 120.0])
def test_pins_are_hit(take: Take, filler: Filler, fps: float) -> None:
    source = at_rate(take, fps)
    pose = np.clip(source.weights[10] + 0.2, 0, 1)
    pins = {61: pose, 90: {"jawOpen": 0.5, "mouthClose": 0.0}, 129: {"eyeBlinkLeft": 1.0}}
    made = fill(source, SPAN, pins=pins, filler=filler)[0].take.weights
    np.testing.assert_allclose(made[61], pose, atol=1e-6)
    assert made[90, SHAPE_INDEX["jawOpen"]] == pytest.approx(0.5, abs=1e-6)
    assert made[129, SHAPE_INDEX["eyeBlinkLeft"]] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("fps", [30.0, 60.0])
def test_seams_jump_no_more_than_the_take_does_from_frame_to_frame(take: Take, fps: float) -> None:
    source = at_rate(take, fps)
    made = fill(source, SPAN, style="perform")[0].take.weights
    steps, turns = np.abs(np.diff(source.weights, axis=0)), np.abs(np.diff(source.weights, 2, axis=0))
    for seam in SPAN:
        assert np.abs(made[seam] - made[seam - 1]).mean() <= np.percentile(steps.mean(axis=1), 99)
        assert np.abs(np.diff(made[seam - 2 : seam + 2], 2, axis=0)).mean() <= np.percentile(turns.mean(axis=1), 99)


def test_the_same_seed_gives_the_same_motion_and_another_seed_another(take: Take, filler: Filler) -> None:
    first, second = fill(take, SPAN, seed=4, variants=2, filler=filler)
    again = fill(take, SPAN, seed=5, filler=filler)[0]
    np.testing.assert_allclose(second.take.weights, again.take.weights, atol=1e-6)
    assert (first.seed, second.seed) == (4, 5)
    assert np.abs(first.take.weights - second.take.weights).max() > 1e-3


def test_a_fill_can_be_run_again_with_one_more_pin(take: Take, filler: Filler) -> None:
    made = fill(take, SPAN, pins={70: {"jawOpen": 0.3}}, filler=filler)[0]
    more = replace(made.inputs, pins={**made.inputs.pins, 100: {"mouthSmileLeft": 0.8}})
    again = refill(take, more, seeds=(made.seed,), filler=filler)[0].take
    assert again.curve("jawOpen")[70] == pytest.approx(0.3)
    assert again.curve("mouthSmileLeft")[100] == pytest.approx(0.8)


def test_every_lost_run_is_filled_and_no_longer_lost(take: Take, filler: Filler, monkeypatch) -> None:
    monkeypatch.setattr("engine.inpaint.fill.bundled", lambda: filler)
    assert [stop - start for start, stop in lost_spans(take)] == [3, 24]
    made = fill_lost(take)
    assert not made.lost.any()
    np.testing.assert_array_equal(made.weights[~take.lost], take.weights[~take.lost])


def test_short_spans_are_bridged_unless_told_otherwise(take: Take, filler: Filler) -> None:
    assert fill(take, (60, 66), filler=filler)[0].style == "bridge"
    assert fill(take, (60, 66), style="perform", filler=filler)[0].style == "perform"
    assert fill(take, SPAN, filler=filler)[0].style == "perform"
    assert fill(take, SPAN, style="bridge", filler=filler)[0].style == "bridge"


def test_asked_controls_bend_the_face(take: Take) -> None:
    still = Filler(Generator(GeneratorConfig(hidden=16)), statistics_of(take.weights))  # adds nothing of its own
    for wanted in (1.0, 12.0):
        made = fill(take, SPAN, controls={"lips_vertical": wanted}, filler=still)[0].take.weights
        assert np.median(np.abs(measure(made[SPAN[0] + 8 : SPAN[1] - 8])[:, 0] - wanted)) < 3.0


def test_a_whole_take_is_filled_when_something_steers_it(take: Take, filler: Filler) -> None:
    made = fill(take, (0, len(take)), pins={0: take.weights[0]}, filler=filler)[0]
    np.testing.assert_allclose(made.take.weights[0], take.weights[0])


def test_a_guide_is_followed(take: Take) -> None:
    still = Filler(Generator(GeneratorConfig(hidden=16)), statistics_of(take.weights))
    made = fill(take, SPAN, guide=take, guide_offset=40, filler=still)[0].take.weights
    middle = slice(SPAN[0] + 15, SPAN[1] - 15)
    shifted = take.weights[middle.start + 40 : middle.stop + 40]
    plain = fill(take, SPAN, style="bridge", filler=still)[0].take.weights
    assert np.abs(made[middle] - shifted).mean() < 0.6 * np.abs(plain[middle] - shifted).mean()


BAD = {
    "outside": (dict(frames=(200, 2000)), "not within the take"),
    "one frame": (dict(frames=(50, 51)), "one frame"),
    "backwards": (dict(frames=(60, 50)), "not within"),
    "everything": (dict(frames=(0, 10**9)), "not within"),
    "region": (dict(region="nose"), "no region called 'nose'"),
    "pin outside": (dict(pins={10: {"jawOpen": 0.2}}), "frame 10 lies outside"),
    "pin shape": (dict(pins={70: {"jaw": 0.2}}), "no shape called 'jaw'"),
    "pin range": (dict(pins={70: {"jawOpen": 7.0}}), "outside 0..1"),
    "pin nan": (dict(pins={70: {"jawOpen": np.nan}}), "not a number that a face could take"),
    "pin length": (dict(pins={70: np.zeros(51)}), "needs 52 finite weights"),
    "pin region": (dict(region="eyes", pins={70: {"jawOpen": 0.2}}), "moves nothing in the region"),
    "viseme": (dict(visemes=[Cue(2, 3, "Q7")]), "no viseme or phone called 'Q7'"),
    "viseme time": (dict(visemes=[Cue(3, 2, "M")]), "ends before it begins"),
    "control": (dict(controls={"nose": 2.0}), "no control called 'nose'"),
    "control length": (dict(controls={"lips_vertical": np.ones(3)}), "3 values where the span has 70"),
    "control sign": (dict(controls={"lips_vertical": -2.0}), "negative"),
    "style": (dict(style="magic"), "no style called 'magic'"),
    "variants": (dict(variants=0), "At least one variant"),
}


@pytest.mark.parametrize("case", list(BAD))
def test_mistakes_are_one_sentence_and_change_nothing(take: Take, filler: Filler, case: str) -> None:
    inputs, says = BAD[case]
    before = take.weights.copy()
    with pytest.raises(EditError, match=says) as caught:
        fill(take, **({"frames": SPAN, "filler": filler} | inputs))
    assert "\n" not in str(caught.value)
    np.testing.assert_array_equal(take.weights, before)


def test_guides_that_do_not_fit_are_refused(take: Take, filler: Filler) -> None:
    short = Take(take.weights[:100], take.fps)
    with pytest.raises(EditError, match="does not cover the span"):
        fill(take, SPAN, guide=short, filler=filler)
    with pytest.raises(EditError, match="60 frames per second"):
        fill(take, SPAN, guide=replace(take, fps=60.0), filler=filler)
    with pytest.raises(EditError, match="does not cover"):
        fill(take, SPAN, guide=take, guide_offset=-61, filler=filler)


def test_everything_with_nothing_to_go_by_is_refused(take: Take, filler: Filler) -> None:
    with pytest.raises(EditError, match="covers the whole take"):
        fill(take, (0, len(take)), filler=filler)


def test_overlapping_spans_and_stray_pins_are_refused(take: Take) -> None:
    with pytest.raises(EditError, match="overlap at frame 60"):
        fill_spans(take, [(50, 70), (60, 80)], FillRequest((0, 0)))
    with pytest.raises(EditError, match="frame 75 lies outside"):
        fill_spans(take, [(50, 70)], FillRequest((0, 0), pins={75: {"jawOpen": 0.1}}))


def test_contradictory_pins_are_refused_and_others_joined() -> None:
    with pytest.raises(EditError, match="different values of jawOpen"):
        merged_pins([(5, {"jawOpen": 0.1}), (5, {"jawOpen": 0.2})])
    joined = merged_pins([(5, {"jawOpen": 0.1}), (5, {"jawLeft": 0.2, "jawOpen": 0.1})])[5]
    assert np.isfinite(joined).sum() == 2 and joined[SHAPES.index("jawLeft")] == 0.2


@pytest.mark.parametrize("fps", [30.0, 60.0])
@pytest.mark.parametrize("style", ["bridge", "perform"])
def test_what_lies_in_lost_frames_and_spans_to_be_made_is_no_context(fps: float, style: str) -> None:
    """Lost frames touch the span, a marked span lies near it: whatever they hold, the fill is the same."""
    rng = np.random.default_rng(5)
    pace = round(fps / 30)
    base = np.clip(0.3 + np.cumsum(rng.normal(0, 0.01, (300 * pace, len(SHAPES))), axis=0), 0, 1)
    span, gone, marked = (100 * pace, 130 * pace), (130 * pace, 145 * pace), (80 * pace, 95 * pace)
    lost = np.zeros(len(base), bool)
    lost[slice(*gone)] = True
    request = FillRequest(span, style=style, besides=(marked,), unmade=(marked,))
    fills = []
    for value in (0.0, 1.0):
        spoilt = base.copy()
        spoilt[slice(*gone)], spoilt[slice(*marked)] = value, value
        fills.append(refill(Take(spoilt, fps, lost), request)[0].take)
    np.testing.assert_array_equal(*(made.weights[slice(*span)] for made in fills))
    for made in fills:  # what is still lost goes on from the fill
        assert made.lost.sum() == gone[1] - gone[0]
        line = np.linspace(made.weights[gone[0] - 1], made.weights[gone[1]], gone[1] - gone[0] + 2)
        np.testing.assert_allclose(made.weights[slice(*gone)], line[1:-1], atol=1e-12)


def test_a_fill_joins_a_span_that_is_marked_and_not_filled_yet() -> None:
    rng = np.random.default_rng(5)
    take = Take(np.clip(0.3 + np.cumsum(rng.normal(0, 0.01, (300, len(SHAPES))), axis=0), 0, 1), 30.0)
    beside = (130, 160)
    made = refill(take, FillRequest((100, 130), style="perform", besides=(beside,), unmade=(beside,)))[0].take
    step = np.abs(made.weights[130] - made.weights[129]).max()
    assert step < 0.1
    np.testing.assert_array_equal(made.weights[130:], take.weights[130:])


@pytest.mark.parametrize("region", ["face", "lower"])
def test_a_filled_frame_is_lost_no_more_whatever_the_region(take: Take, region: str) -> None:
    lost = np.zeros(len(take), bool)
    lost[60:80] = True
    made = fill(Take(take.weights, take.fps, lost), (60, 80), region=region, style="bridge")[0].take
    assert not made.lost.any()
