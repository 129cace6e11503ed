"""What `make run` does without a display: close the lips over a span of a take, and show what became of it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from app.preview import movie
from app.printing import remark, say
from engine.assets import DEMO_TAKE
from engine.controls import CONTROL_INDEX, measure
from engine.editing import ControlRequest, Patch, set_control
from engine.errors import EngineError
from engine.formats import read_take, write_take
from engine.take import Take
from engine.words import counted

SPAN_FRAMES = 20
MOVIE_MARGIN_FRAMES = 20
LIPS = CONTROL_INDEX["lips_vertical"]
OUT = Path("out")


def widest_span(take: Take) -> tuple[int, int]:
    """Return the range around the frame at which the lips are furthest apart: where a change shows best."""
    centre = int(np.argmax(np.where(take.lost, -np.inf, measure(take.weights)[:, LIPS])))
    start = max(0, min(centre - SPAN_FRAMES // 2, len(take) - SPAN_FRAMES))
    return start, min(len(take), start + SPAN_FRAMES)


def close_lips(take: Take, frames: tuple[int, int]) -> Patch:
    """Close the lips over a range of frames; the whole face follows."""
    return set_control(take, ControlRequest("lips_vertical", frames, "set", 0.0))


def write_results(take: Take, edited: Take, frames: tuple[int, int], stem: str) -> list[Path]:
    """Write the edited take, a picture of before and after, and a short movie of both; returns their paths."""
    OUT.mkdir(exist_ok=True)
    written = [OUT / f"{stem}_lips_closed.csv", OUT / f"{stem}_before_after.png", OUT / f"{stem}_before_after.mp4"]
    write_take(edited, written[0])
    movie.write_picture([take, edited], sum(frames) // 2, written[1], height=720)
    start, stop = max(0, frames[0] - MOVIE_MARGIN_FRAMES), min(len(take), frames[1] + MOVIE_MARGIN_FRAMES)
    movie.write_movie([take, edited], written[2], height=480, frames=(start, stop))
    return written


def main() -> int:
    """Run the job on the take named on the command line, or on the bundled one."""
    try:
        path = Path(sys.argv[1]) if len(sys.argv) > 1 else DEMO_TAKE
        take = read_take(path)
        frames = widest_span(take)
        patch = close_lips(take, frames)
        edited = patch.apply(take)
        written = write_results(take, edited, frames, path.stem)
    except EngineError as error:
        remark(error)
        return 2
    start, stop = frames
    lips = measure(edited.weights)[start:stop, LIPS]
    say(f"{take.name}: {counted(len(take), 'frame')} at {take.fps:g} fps, {int(take.lost.sum())} lost")
    say(f"closed the lips over frames {start}:{stop}; they are now at most {lips.max():.2f} mm apart")
    say(
        f"{counted(len(take) - (patch.stop - patch.start), 'frame')} outside {patch.start}:{patch.stop} are bit-identical"
    )
    for file in written:
        say(f"wrote {file}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
