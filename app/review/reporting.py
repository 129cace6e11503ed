"""Writes what goes to others in a process of its own: it draws many faces, and the window goes on meanwhile."""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from engine.errors import EngineError
from engine.project import ENDING, Contents, create

Arguments = Callable[[Path, Path], list[str]]  # of the command, for a project and what is written
PERCENT = re.compile(r"(\d+) %$")


@dataclass(frozen=True, eq=False)
class _Wish:
    """What to write about, what it is called, where it goes, and with which command."""

    contents: Contents
    name: str
    out: Path
    arguments: Arguments


def report(project: Path, out: Path) -> list[str]:
    """Return the arguments that write a report."""
    return ["review", str(project), "-o", str(out), "--progress"]


def findings(project: Path, out: Path) -> list[str]:
    """Return the arguments that write flags and notes: as a table or JSON, or as markers for editors."""
    return ["review", str(project), "--markers" if out.suffix.lower() == ".edl" else "--findings", str(out)]


def movie(sound: tuple[Path, float] | None) -> Arguments:
    """Return what gives the arguments that write a movie: with a sound that begins at a time of the take, or silent."""
    heard = ["--no-sound"] if sound is None else ["--audio", str(sound[0]), f"--audio-offset={sound[1]}"]
    shown = ["--before-edits", "--difference", "--burn-in", "--progress"]
    return lambda project, out: ["render", str(project), "-o", str(out), *shown, *heard]


class Reporting(QObject):
    """Writes one file after another; the newest wish wins."""

    written = Signal(object)  # the Path of what was written
    failed = Signal(str, str)  # sentence, advice
    under_way = Signal(bool)
    progress = Signal(float)  # the share that is done, from the thread

    def __init__(self) -> None:
        super().__init__()
        self._lock = threading.Lock()
        self._process: subprocess.Popen[str] | None = None
        self._cancelled = False
        self._work = LatestWins(self._carry_out, name="report")
        self._work.done.connect(self._done)
        self._work.failed.connect(self._refused)
        self._work.rested.connect(self._rested)

    @property
    def idle(self) -> bool:
        """Whether nothing is being written."""
        return self._work.idle

    def write(self, contents: Contents, name: str, out: Path, arguments: Arguments = report) -> None:
        """Write what a command makes of a project's contents; `written` or `failed` follows."""
        with self._lock:
            self._cancelled = False
        self._work.submit(_Wish(contents, name, out, arguments))
        self.under_way.emit(True)

    def cancel(self) -> None:
        """Stop writing; what is half done leaves no file."""
        with self._lock:
            self._cancelled = True
            if self._process is not None:
                self._process.kill()

    def close(self) -> None:
        """End the process and the thread."""
        self.cancel()
        self._work.stop()

    def _rested(self) -> None:
        self.under_way.emit(not self._work.idle)

    def _done(self, wish: _Wish, _: None) -> None:
        self.written.emit(wish.out)

    def _refused(self, wish: _Wish, sentence: str, advice: str) -> None:
        self.failed.emit(sentence, advice)

    def _carry_out(self, wish: _Wish) -> None:
        with tempfile.TemporaryDirectory(prefix="retake-review-") as folder:
            project = Path(folder) / f"{Path(wish.name).stem or 'take'}{ENDING}"
            create(project, wish.contents).close()
            code, last = self._run(wish.arguments(project, wish.out.resolve()))
        if code:
            raise EngineError(last if code > 0 and last else f"Writing {wish.out.name} was cancelled.")

    def _run(self, arguments: list[str]) -> tuple[int, str]:
        """Run a command of ours; returns its exit code, below zero where it was ended, and its last sentence."""
        frozen = getattr(sys, "frozen", False)
        command = [sys.executable, *([] if frozen else ["-m", "app"]), *arguments]
        with self._lock:
            if self._cancelled:
                return -1, ""
            process = self._process = subprocess.Popen(
                command,
                stderr=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                text=True,
                encoding="utf-8",
                errors="replace",
            )
        last = ""
        assert process.stderr is not None
        with process.stderr as lines:
            for line in lines:
                found = PERCENT.search(line.rstrip())
                if found is not None:
                    self.progress.emit(int(found[1]) / 100)
                else:
                    last = line.strip() or last
        code = process.wait()
        with self._lock:
            self._process = None
        return code, last
