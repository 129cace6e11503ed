"""A digest of what every verb makes of takes, from the shell and in the window: two versions of the program say the same.

Run: QT_QPA_PLATFORM=offscreen python -m tests.performance.outputs TAKE... > digests.txt, before a change and after it.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from PySide6.QtCore import QEventLoop
from PySide6.QtWidgets import QApplication

from app import cli
from app.settings import Settings
from app.window.main_window import MainWindow
from engine.character import bundled, save
from engine.formats import labels as label_files
from engine.formats import read_take
from engine.formats.labels import LabelFile
from engine.formats.markers import write as write_markers
from engine.formats.markers.capture import Markers
from engine.project import Span
from engine.spacetime.layout import standard
from engine.take import SHAPE_INDEX, SHAPES, Take

LONGEST_FRAMES = 600  # of a take in the window
SHELL: dict[str, str] = {  # {take}, {guide}, {head}, {labels}, {markers} are files
    "edit set": "edit {take} --control lips_vertical --frames 60:90 --set 9",
    "edit add": "edit {take} --control brow_inner --frames 60:90 --add 2 --believability 1",
    "edit scale": "edit {take} --control lips_horizontal --frames 60:90 --scale 1.2 --exact",
    "smooth": "smooth {take} --cutoff 5 --frames 50:150",
    "fill": "fill {take} --frames 60:120 --seed 3 --variants 2",
    "fill bridge": "fill {take} --frames 60:66 --pin 62:jawOpen=.5",
    "fill steered": "fill {take} --frames 60:110 --region lower --guide {guide} --control lips_vertical=6 --pin 80:jawOpen=.4",
    "fill spans": "fill {take} --frames 40:60 --frames 70:100 --seed 1",
    "clean": "clean {take} --strength .8",
    "clean span": "clean {take} --frames 40:140 --json",
    "pin": "pin {take} --frame 70 --range 55:95 --weights mouthSmileLeft=.8,jawOpen=.1",
    "pin free": "pin {take} --frame 70 --range 55:95 --weights mouthSmileLeft=.8 --free --closure 0",
    "pin control": "pin {take} --frame 70 --range 55:95 --control lips_vertical=9",
    "retarget": "retarget {take} --character {head}",
    "retarget settings": "retarget {take} --character {head} --alpha .05 --beta .2 --closure 0 --unbounded",
    "retarget labels": "retarget {take} --method manifold --labels {labels} --character {head}",
    "retarget markers": "retarget {markers} --character {head}",
    "suggest": "retarget {take} --method manifold --suggest 4 --labels {labels}",
    "flags": "flags {take}",
    "drive": "drive {take} --mesh {head}",
}


def digest(*arrays: np.ndarray) -> str:
    """Return a short digest of arrays' bytes."""
    return hashlib.sha256(b"".join(np.ascontiguousarray(array).tobytes() for array in arrays)).hexdigest()[:16]


def files(folder: Path) -> dict[str, Path]:
    """Write what the commands read beside the take: another head, labels for it, markers, a guide."""
    head, layout = bundled(), standard(bundled())
    stretch = np.array([1.25, 0.95, 1.1], np.float32)
    found = {name: folder / file for name, file in (("head", "broad.npz"), ("labels", "a.json"), ("markers", "m.csv"))}
    save(replace(head, neutral=head.neutral * stretch, deltas=0.8 * head.deltas * stretch), found["head"])
    poses = {30: {"jawOpen": 0.6}, 70: {"mouthSmileLeft": 0.7, "mouthSmileRight": 0.5}}
    label_files.write(LabelFile(poses, None), found["labels"])
    jaw = np.sin(np.linspace(0, np.pi, 30))[:, None, None] * layout.deltas(head)[SHAPE_INDEX["jawOpen"]]
    write_markers(Markers(layout.rest(head) + jaw, layout.names, 30.0), found["markers"])
    return found


def in_the_shell(take: Path, folder: Path) -> None:
    """Run every command on a take and print digests of what it says and writes."""
    known = {**files(folder), "take": take, "guide": take}
    for name, line in SHELL.items():
        ending = ".npz" if name == "drive" else ".csv"
        out = folder / f"{name.replace(' ', '_')}{ending}"
        said = io.StringIO()
        words = [word.format(**known) for word in line.split()]
        with contextlib.redirect_stdout(said):
            code = cli.run([*words, *([] if name == "suggest" else ["-o", str(out)])])
        told = said.getvalue().replace(str(folder), "")
        written = []
        for file in sorted(folder.glob(f"{out.stem}*{ending}")):
            arrays = [np.load(file)[key] for key in sorted(np.load(file))] if ending == ".npz" else []
            written.append(digest(*arrays) if arrays else digest(np.frombuffer(file.read_bytes(), np.uint8)))
        print(
            f"{take.stem:12} shell  {name:18} {code} {digest(np.frombuffer(told.encode(), np.uint8))} {' '.join(written)}"
        )


class Window:
    """A window on a take, and what it has come to after each action."""

    def __init__(self, take: Take, folder: Path) -> None:
        self.window = MainWindow(take, settings=Settings(folder / "settings.ini"), unsaved=folder / "unsaved")
        self.window.show()
        loop = QEventLoop()
        self.window.inference.ready.connect(loop.quit)
        loop.exec()
        self.session = self.window.session

    def until(self, done: Callable[[], bool]) -> None:
        """Work through events until something is so."""
        while not done():
            QApplication.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents, 50)

    def step(self, name: str, act: Callable[[], object]) -> None:
        """Act, wait for the step that it makes, and print what it came to."""
        session = self.session
        before = session.document.contents().edits[-1:]
        act()
        self.until(lambda: session.document.contents().edits[-1:] != before and not self.window.inference.busy)
        edit = session.document.contents().edits[-1]
        made = digest(
            session.document.take.weights,
            session.document.take.lost,
            np.nan_to_num(session.document.asked),
            session.document.controls,
        )
        print(
            f"{session.document.take.name[:12]:12} window {name:18} {made} {edit.kind} {edit.start} {edit.stop} {edit.title!r}"
        )

    def filled(self) -> None:
        """Fill the chosen span and keep the third variant."""
        self.window.spans.fill()
        self.until(lambda: bool(self.window.filling.variants) and not self.window.filling.busy)
        self.window.filling.choose(2)
        self.window.filling.accept()

    def filled_again(self) -> None:
        """Take the fill back, fill as it was made, and keep the second variant."""
        self.window.edits.again()
        self.until(lambda: bool(self.window.filling.variants) and not self.window.filling.busy)
        self.window.filling.choose(1)
        self.window.filling.accept()

    def retargeted(self, head: Path) -> None:
        """Retarget to a head, solve the whole take and keep it."""
        state = self.window.retarget.retargeting
        self.window.retarget.retarget_tool()
        state.choose_target(head)
        self.until(lambda: state.ready)
        state.solve()
        self.until(lambda: state.result is not None)
        count = self.session.document.undo.index()
        state.keep()
        self.until(lambda: self.session.document.undo.index() > count)


def in_the_window(take: Take, folder: Path) -> None:
    """Carry every verb out in one window, one after the other."""
    shown = Window(take, folder)
    window, session = shown.window, shown.session
    session.view.choose_lane(0)
    session.view.move_playhead(100)
    shown.step("set", lambda: window.edits.set_value(8.0))
    asked = session.document.controls[110:140].copy()
    asked[:, 0] += 2.0
    shown.step("drag", lambda: (window.inference.ask(110, asked), window.inference.finish("drag")))
    shown.step("drag again", lambda: (window.inference.ask(110, asked - 1.0), window.inference.finish("drag")))
    session.view.expand(0)
    session.view.choose_lane(next(lane for lane in session.view.lanes if lane > session.view.lanes[0] and lane >= 16))
    session.view.select((150, 170))
    shown.step("weight", lambda: window.edits.set_value(0.4))
    window.edits.copy()
    session.view.move_playhead(200)
    shown.step("paste", window.edits.paste)
    session.view.select((210, 260))
    shown.step("smooth", window.edits.smooth)
    shown.step("clean", window.clean.keep)
    session.view.choose_tool("pin")
    session.view.select(None)
    session.view.move_playhead(120)
    shown.step("pin", lambda: (window.pins._move("mouthSmileLeft", 0.8), window.pins.keep()))
    session.view.choose_tool("drag")
    session.view.select((115, 135))
    window.filling.start(Span(115, 135))
    shown.until(lambda: bool(window.filling.variants) and not window.filling.busy)
    window.filling.drop()
    session.view.select((60, 90))
    shown.step("fill", shown.filled)
    shown.step("fill again", shown.filled_again)
    shown.step("retarget", lambda: shown.retargeted(folder / "broad.npz"))
    session.document.undo.setClean()
    window.close()
    shown.until(lambda: window.closed)


def main() -> int:
    application = QApplication(["outputs"])
    assert application is not None and len(SHAPES)
    for path in map(Path, sys.argv[1:]):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            in_the_shell(path, folder)
            take = read_take(path)
            rows = slice(0, LONGEST_FRAMES)
            in_the_window(Take(take.weights[rows], take.fps, take.lost[rows], name=path.stem), folder)
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
