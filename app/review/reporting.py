"""Writes the report in a process of its own: it draws every change, and the window goes on meanwhile."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from engine.errors import EngineError
from engine.project import ENDING, Contents, create

PATIENCE_S = 600.0


@dataclass(frozen=True, eq=False)
class _Wish:
    """What to report on, what it is called, and where the report goes."""

    contents: Contents
    name: str
    out: Path


class Reporting(QObject):
    """Writes one report after another; the newest wish wins."""

    written = Signal(object)  # the Path of a report
    failed = Signal(str, str)  # sentence, advice

    def __init__(self) -> None:
        super().__init__()
        self._process: subprocess.Popen[str] | None = None
        self._work = LatestWins(self._carry_out, name="report")
        self._work.done.connect(self._done)
        self._work.failed.connect(self._refused)

    @property
    def idle(self) -> bool:
        """Whether no report is being written."""
        return self._work.idle

    def write(self, contents: Contents, name: str, out: Path) -> None:
        """Write the report of a project's contents; `written` or `failed` follows."""
        self._work.submit(_Wish(contents, name, out))

    def cancel(self) -> None:
        """Stop writing; a report that is half done leaves no file."""
        process = self._process
        if process is not None:
            process.kill()

    def close(self) -> None:
        """End the process and the thread."""
        self.cancel()
        self._work.stop()

    def _done(self, wish: _Wish, _: None) -> None:
        self.written.emit(wish.out)

    def _refused(self, wish: _Wish, sentence: str, advice: str) -> None:
        self.failed.emit(sentence, advice)

    def _carry_out(self, wish: _Wish) -> None:
        with tempfile.TemporaryDirectory(prefix="retake-review-") as folder:
            project = Path(folder) / f"{Path(wish.name).stem or 'take'}{ENDING}"
            create(project, wish.contents).close()
            arguments = ["review", str(project), "-o", str(wish.out.resolve())]
            frozen = getattr(sys, "frozen", False)
            command = [sys.executable, *([] if frozen else ["-m", "app"]), *arguments]
            self._process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
            try:
                _, said = self._process.communicate(timeout=PATIENCE_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.communicate()
                raise EngineError(
                    "The report took too long and was stopped.", "Try retake review from a shell."
                ) from None
            finally:
                code, self._process = self._process.returncode, None
        if code:
            last = said.strip().splitlines()[-1:] or ["The report was not written."]
            raise EngineError(last[0] if code > 0 else "Writing the report was cancelled.")
