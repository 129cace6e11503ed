"""Which program made a temporary file, and whether it still runs: told by its process, never by the file's age."""

from __future__ import annotations

import hashlib
import os
import re
import socket
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path

MARK = re.compile(r"([0-9a-f]{8})-([0-9a-f]{8})-([0-9]{1,10})-([0-9]{1,20})")
START_FIELD = 19  # of /proc/PID/stat, counted behind the program's name


def owner_mark() -> str:
    """Return a text for the names of this program's temporary files: computer, its boot, process, that one's start."""
    return f"{_computer()}-{boot_mark()}-{os.getpid()}-{_began(os.getpid()) or 0}"


def owner_runs(mark: str) -> bool | None:
    """Return whether the program that a mark names still runs; None where it cannot be known here."""
    found = MARK.fullmatch(mark)
    if found is None or found[1] != _computer():
        return None
    if found[2] != boot_mark():
        return False
    pid, began = int(found[3]), int(found[4])
    return _exists(pid) and _began(pid) in (began, None)


@cache
def _computer() -> str:
    parts = [socket.gethostname()]
    with suppress(OSError):
        parts.append(Path("/etc/machine-id").read_text())
    with suppress(OSError):
        parts.append(str(Path("/proc/self/ns/pid").stat().st_ino))  # containers count their processes apart
    return _digits("\n".join(parts))


@cache
def boot_mark() -> str:
    """Return a text that changes when the computer starts anew; the same one always where that cannot be known."""
    with suppress(OSError):
        return _digits(Path("/proc/sys/kernel/random/boot_id").read_text())
    return _digits("")


def _digits(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()[:8]


def _exists(pid: int) -> bool:
    if sys.platform == "win32":
        return False  # a file that its maker has open cannot be removed there
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True


def _began(pid: int) -> int | None:
    """Return when a process began, in clock ticks since the boot: a number that setting the clock does not change."""
    try:
        return int(Path(f"/proc/{pid}/stat").read_bytes().rpartition(b")")[2].split()[START_FIELD])
    except (OSError, IndexError, ValueError):
        return None
