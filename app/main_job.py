"""What `make run` does without a display: close the lips over a span of a take and write the result."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from engine.controls import CONTROL_INDEX
from engine.editing import Edit, ask, drag_exact
from engine.errors import EngineError
from engine.formats import read_take, write_take
from engine.performance import demo
from engine.take import Take

SPAN_FRAMES = 20
OUT = Path("out")


def widest_span(take: Take, column: int) -> tuple[int, int]:
    """Return the range around the frame at which a control is largest: where a change shows best."""
    from engine.controls import measure

    centre = int(np.argmax(np.where(take.lost, -np.inf, measure(take.weights)[:, column])))
    start = max(0, min(centre - SPAN_FRAMES // 2, len(take) - SPAN_FRAMES))
    return start, min(len(take), start + SPAN_FRAMES)


def close_lips(take: Take) -> tuple[Edit, tuple[int, int]]:
    """Close the lips where they are furthest apart; returns the edit and its range of frames."""
    frames = widest_span(take, CONTROL_INDEX["lips_vertical"])
    return drag_exact(take, ask(take, "lips_vertical", frames, "set", 0.0)), frames


def main() -> int:
    """Run the job on the take named on the command line, or on the bundled one."""
    try:
        path = Path(sys.argv[1]) if len(sys.argv) > 1 else demo.BUNDLED
        take = read_take(path)
        edit, (start, stop) = close_lips(take)
        OUT.mkdir(exist_ok=True)
        target = OUT / f"{path.stem}_lips_closed.csv"
        write_take(edit.take, target)
    except EngineError as error:
        print(error, file=sys.stderr)
        return 2
    lips = edit.reached[start:stop, CONTROL_INDEX["lips_vertical"]]
    print(f"{take.name}: {len(take)} frames at {take.fps:g} fps, {int(take.lost.sum())} lost")
    print(f"closed the lips over frames {start}:{stop}; they are now at most {lips.max():.2f} mm apart")
    print(f"wrote {target}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
