"""Locks beside files, which tell who writes one even where the file system has no locks, and after a kill."""

from __future__ import annotations

import hashlib
import os
import re
import socket
import time
from contextlib import suppress
from pathlib import Path

from filelock import SoftFileLease, Timeout

from engine.errors import EngineError

LEASE_S = 15.0  # after which a lock that another computer no longer refreshes is taken over
POLL_S = 0.5  # between looks at a lock that another computer may have left
MAX_NAME_BYTES = 255  # of a file system
HASH_DIGITS = 16
MOMENT_S = 2.0  # in which a lock that was made has its owner's name in it
NOBODY = ""
OWN = re.compile(r"\..*(\.retake|\.partial\d*\.csv)\.lock|\.[0-9a-f]{16}\.lock", re.DOTALL)  # the locks' names


class InUseError(EngineError):
    """Another running program, or another window, has the file open."""


class FileLock:
    """The right to write a file, which one program at a time has; given back by `release`, or by the end of its owner.

    A hidden file beside the one that is locked names the owner: host, process, when that process began. On the same
    computer an owner that runs no more has lost it at once, and one that is merely stopped keeps it, however long; the
    clock plays no part. On another computer it is lost when nobody refreshed it for `LEASE_S`, as this computer's
    monotonic clock measures; its owner sees that before the next write.
    """

    def __init__(self, path: Path) -> None:
        """Take the lock of a file; raises `InUseError` where another has it, `OSError` where none can be made."""
        self.path = path
        os.stat(path.parent / ".")  # a folder that is not there would be made
        self._lease = SoftFileLease(_beside(path), timeout=0, thread_local=False, lease_duration=LEASE_S)
        try:
            self._lease.acquire()
        except Timeout:
            self._await()

    @property
    def held(self) -> bool:
        """Whether the lock is still this program's: one that slept for long may have lost it to another computer."""
        owner = self._lease.owner
        return self._lease.compromise is None and owner is not None and owner.token == self._lease.token

    def release(self) -> None:
        """Let others have the file."""
        with suppress(OSError):  # a folder that is gone has no lock either
            self._lease.release(force=True)

    def _await(self) -> None:
        """Take the lock when it proves to be nobody's any more; raises `InUseError` where it is somebody's.

        An owner on this computer is known at once. One on another has not refreshed it for a lease; and what a power
        cut left of a lock names nobody: whoever is taking it will have written his name in a moment.
        """
        began, seen = time.monotonic(), self._refreshed()
        while (host := self._owner_elsewhere()) is not None and self._refreshed() == seen:
            waited_s = time.monotonic() - began
            if host == NOBODY and waited_s > MOMENT_S:
                self._lease.force_break()
            with suppress(Timeout):
                self._lease.acquire()
                return
            if waited_s > 2 * LEASE_S:
                break
            time.sleep(POLL_S)
        where = f"in Retake on {host}" if host else "in another Retake"
        raise InUseError(f"{self.path.name} is open {where}.", "Close it there first, or work on a copy.")

    def _refreshed(self) -> int | None:
        try:
            return os.stat(self._lease.lock_file).st_mtime_ns
        except OSError:
            return None

    def _owner_elsewhere(self) -> str | None:
        """Return the name of the other computer that has the lock, `NOBODY`, or None where it is held on this one."""
        owner = self._lease.owner
        name = owner.hostname.partition("?")[0] if owner is not None else NOBODY
        return None if name == socket.gethostname() else name


def _beside(path: Path) -> Path:
    """Return the name of the file that is the lock of another."""
    name = f".{path.name}.lock"
    if len(os.fsencode(name)) > MAX_NAME_BYTES:
        name = f".{hashlib.sha256(os.fsencode(path.name)).hexdigest()[:HASH_DIGITS]}.lock"
    return path.with_name(name)


def drop_abandoned(path: Path) -> None:
    """Remove a lock whose owner, on this computer, runs no more; any other stays.

    One that a kill left before its owner's name was in it is known by staying so for a moment.
    """
    if not OWN.fullmatch(path.name):
        return
    lease = SoftFileLease(path, timeout=0, thread_local=False, lease_duration=LEASE_S)
    with suppress(Timeout, OSError):
        if not (found := path.stat()).st_size:
            time.sleep(MOMENT_S)
            if path.stat() == found:
                lease.force_break()
        else:
            lease.acquire()
            lease.release(force=True)
