"""Uses a built program as a person would: smoke.py PROGRAM; exits 0 where all of it works.

Under Xvfb, with a home of its own and nothing of a checkout or an environment on its path, the program opens a take, a
curve is dragged by the mouse, the lost span is filled, the project is saved and the program quit; then the project is
opened again and exported by a command. Prints how long each step took.
"""

from __future__ import annotations

import csv
import os
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

PATIENCE_S = 90.0
WIDTH, HEIGHT = 1440, 900
SETTLE_S, PAUSE_S = 15.0, 8.0  # while networks and preview are loaded beside the window; after each step
PEAK = (701, 215)  # px, on the upper curve where the jaw is open
FRAMES, FPS = 240, 30
EDITS = 2  # a drag and a fill
LOST = range(120, 150)
SIDES = ("Left", "Right")
EYE = ("EyeBlink", "EyeLookDown", "EyeLookIn", "EyeLookOut", "EyeLookUp", "EyeSquint", "EyeWide")
SHAPES = (
    *(f"{shape}{side}" for side in SIDES for shape in EYE),
    *("JawForward", "JawRight", "JawLeft", "JawOpen", "MouthClose", "MouthFunnel", "MouthPucker"),
    *("MouthRight", "MouthLeft"),
    *(f"Mouth{shape}{side}" for shape in ("Smile", "Frown", "Dimple", "Stretch") for side in SIDES),
    *("MouthRollLower", "MouthRollUpper", "MouthShrugLower", "MouthShrugUpper"),
    *(f"Mouth{shape}{side}" for shape in ("Press", "LowerDown", "UpperUp") for side in SIDES),
    *("BrowDownLeft", "BrowDownRight", "BrowInnerUp", "BrowOuterUpLeft", "BrowOuterUpRight"),
    *("CheekPuff", "CheekSquintLeft", "CheekSquintRight", "NoseSneerLeft", "NoseSneerRight", "TongueOut"),
)
ROTATIONS = ("HeadYaw", "HeadPitch", "HeadRoll", *(f"{s}Eye{a}" for s in SIDES for a in ("Yaw", "Pitch", "Roll")))


def write_take(path: Path) -> None:
    """Write a take whose jaw opens once a second and whose face is lost for one second."""
    with path.open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["Timecode", "BlendShapeCount", *SHAPES, *ROTATIONS])
        for frame in range(FRAMES):
            stamp = f"10:00:{frame // FPS:02d}:{frame % FPS * 2:02d}.000"
            opening = 0.5 * max(0.0, 1 - abs(frame % FPS - 15) / 8)
            weights = [opening if name == "JawOpen" else 0.01 for name in SHAPES]
            row = [0] if frame in LOST else [61, *(f"{value:.6f}" for value in (*weights, *[0.0] * 9))]
            table.writerow([stamp, *row])


def until(true: Callable[[], object], what: str) -> float:
    """Wait for something; returns the seconds it took, and ends the program with a sentence where it does not come."""
    begun = time.perf_counter()
    while not true():
        if time.perf_counter() - begun > PATIENCE_S:
            raise SystemExit(f"FAILED: {what} did not come within {PATIENCE_S:g} s.")
        time.sleep(0.1)
    return time.perf_counter() - begun


@contextmanager
def screen() -> Iterator[str]:
    """Run Xvfb; yields its DISPLAY."""
    reading, writing = os.pipe()
    command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-nolisten", "tcp"]
    server = subprocess.Popen(command, pass_fds=[writing], stderr=subprocess.DEVNULL)
    os.close(writing)
    try:
        with os.fdopen(reading) as pipe:
            yield f":{pipe.readline().strip()}"
    finally:
        server.terminate()
        server.wait()


class Person:
    """Somebody at the screen, with a mouse and a keyboard (xdotool)."""

    def __init__(self, environment: dict[str, str], folder: Path) -> None:
        self._environment, self._folder = environment, folder

    def do(self, *words: object) -> str:
        """Do what xdotool calls `words`; returns what it prints."""
        done = subprocess.run(
            ["xdotool", *map(str, words)], env=self._environment, capture_output=True, text=True, check=False
        )
        return done.stdout

    def window(self, name: str) -> str:
        """Return the window whose title holds a name, or nothing."""
        return self.do("search", "--onlyvisible", "--name", name).partition("\n")[0]

    def focus(self, name: str) -> None:
        """Give the keyboard to a window; without a window manager nobody else does when a dialog closes."""
        self.do("windowfocus", "--sync", self.window(name))

    def drag(self, start: tuple[int, int], end: tuple[int, int]) -> None:
        """Press at one place, move in small steps and let go at another."""
        self.do("mousemove", *start, "mousedown", 1)
        for step in range(1, 11):
            place = (round(a + (b - a) * step / 10) for a, b in zip(start, end, strict=True))
            self.do("mousemove", *place)
            time.sleep(0.03)
        self.do("mouseup", 1)

    def picture(self, name: str) -> None:
        """Keep a picture of the screen where ImageMagick is there to take one."""
        if shutil.which("import"):
            path = self._folder / f"{name}.png"
            subprocess.run(["import", "-window", "root", path], env=self._environment, check=False)


def edits_in(project: Path) -> int:
    """Return how many edits a project holds that no program has open."""
    with closing(sqlite3.connect(f"file:{project}?mode=ro", uri=True)) as database:
        return int(database.execute("SELECT count(*) FROM edits").fetchone()[0])


def environment_of(home: Path, display: str) -> dict[str, str]:
    """Return the environment of a machine that has nothing but the program."""
    return {"HOME": str(home), "PATH": "/usr/bin:/bin", "DISPLAY": display, "LANG": "C.UTF-8"}


def opened(
    person: Person, program: str, path: Path, environment: dict[str, str]
) -> tuple[subprocess.Popen[bytes], float]:
    """Start the program on a file; returns it, and the seconds until its window is there."""
    running = subprocess.Popen([program, str(path)], env=environment, cwd=path.parent)

    def shown() -> bool:
        if running.poll() is not None:
            raise SystemExit(f"FAILED: the program ended with {running.returncode} before its window came.")
        return bool(person.window(path.name))

    try:
        return running, until(shown, "the window")
    except SystemExit:
        person.picture("no_window")
        raise


def work(person: Person, program: str, folder: Path, environment: dict[str, str]) -> Path:
    """Open a take, drag, fill, save and quit; returns the project."""
    take, project = folder / "smoke.csv", folder / "work.retake"
    write_take(take)
    running, started = opened(person, program, take, environment)
    print(f"window after {started:.1f} s")
    time.sleep(SETTLE_S)
    person.picture("1_opened")
    person.drag(PEAK, (PEAK[0], PEAK[1] + 60))
    time.sleep(PAUSE_S)
    person.picture("2_dragged")
    person.do("key", "f")
    time.sleep(PAUSE_S)
    person.picture("3_filling")
    person.do("key", "Return")
    time.sleep(PAUSE_S)
    person.picture("4_filled")
    person.do("key", "ctrl+s")
    until(lambda: person.window("Save"), "the dialog to save")
    time.sleep(1)
    person.do("key", "ctrl+a")
    person.do("type", "--delay", 20, str(project))
    person.do("key", "Return")
    print(f"saved after {until(project.exists, 'the project'):.1f} s")
    time.sleep(PAUSE_S)
    person.picture("5_saved")
    person.focus(project.name)
    person.do("key", "ctrl+q")
    print(f"quit after {until(lambda: running.poll() is not None, 'the end of the program'):.1f} s")
    if running.returncode:
        raise SystemExit(f"FAILED: the program ended with {running.returncode}.")
    if (kept := edits_in(project)) != EDITS:
        raise SystemExit(f"FAILED: the project holds {kept} edits of {EDITS}.")
    return project


def check_again(person: Person, program: str, project: Path, environment: dict[str, str]) -> None:
    """Open the project again, and export it by a command."""
    running, started = opened(person, program, project, environment)
    time.sleep(PAUSE_S)
    person.picture("6_reopened")
    person.focus(project.name)
    person.do("key", "ctrl+q")
    until(lambda: running.poll() is not None, "the end of the program")
    print(f"project opened again after {started:.1f} s")
    out, drawn = project.with_name("out.csv"), project.with_name("out.png")
    edit = ["edit", project, "--control", "lips_vertical", "--frames", "10:20", "--set", "0", "-o", out]
    for arguments in (edit, ["render", out, "--frame", "15", "-o", drawn]):
        begun = time.perf_counter()
        subprocess.run([program, *map(str, arguments)], env=environment, cwd=project.parent, check=True)
        print(f"{arguments[0]}: {time.perf_counter() - begun:.1f} s")
    rows = out.read_text().splitlines()[1:]
    short = sum(row.count(",") == 1 for row in rows)
    if len(rows) != FRAMES or short:
        raise SystemExit(f"FAILED: {len(rows)} rows were written, {short} of them without a face.")


def main() -> int:
    """Try the program named on the command line."""
    program = str(Path(sys.argv[1]).resolve())
    pictures = Path(sys.argv[2]).resolve() if len(sys.argv) > 2 else None
    with tempfile.TemporaryDirectory() as name, screen() as display:
        folder = Path(name)
        environment = environment_of(folder, display)
        person = Person(environment, pictures or folder)
        subprocess.run([program, "--version"], env=environment, cwd=folder, check=True)
        check_again(person, program, work(person, program, folder, environment), environment)
    print("smoke test passed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
