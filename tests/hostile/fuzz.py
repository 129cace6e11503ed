"""Feed one reader with mutations, in a process of its own under limits: python -m tests.hostile.fuzz READER.

Prints one line of JSON: how many mutations were read and refused, the slowest and the largest, and the faults. A fault
is an exception that is no `EngineError`, a sentence over 300 characters, more than 2 s, or more than 1 GiB above what
the process held at its start. The content of each is kept in the folder of faults.
"""

from __future__ import annotations

import argparse
import faulthandler
import gc
import hashlib
import json
import random
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from engine.errors import EngineError
from tests.hostile.readers import READERS, Reader

LIMIT_S, LIMIT_BYTES = 2.0, 1 << 30
ROOM_BYTES = 6 << 30  # of addresses: what is only reserved takes no memory
HANG_S = 60  # then the process is ended, with its stack
LONGEST = 300
KEPT = 20  # faults of one kind that are kept


@dataclass
class Outcome:
    """What came of the mutations of one reader."""

    reader: str
    mutations: int = 0
    read: int = 0
    slowest_s: float = 0.0
    largest_bytes: int = 0
    faults: Counter[str] = field(default_factory=Counter)


def memory() -> int:
    """Return the most bytes that the process has held so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def contents(reader: Reader, folder: Path, rng: random.Random) -> Iterator[tuple[str, bytes]]:
    """Yield mutations of the reader's samples without end, the samples themselves first."""
    made = folder / "samples"
    made.mkdir()
    samples = list(reader.samples(made))
    yield from samples
    while True:
        name, content = rng.choice(samples)
        try:
            if name.endswith(".json"):
                from tests.hostile.mutate import document

                yield name, document(content, rng)
            else:
                yield name, reader.mutation(content, rng)
        except (ValueError, OverflowError, RecursionError):  # what no file can hold
            continue


def tried(reader: Reader, path: Path, outcome: Outcome) -> str:
    """Read one file; returns what is wrong with how that went, nothing where all is well."""
    began, before = time.process_time(), memory()
    wrong = ""
    try:
        reader.read(path)
        outcome.read += 1
    except EngineError as error:
        if len(str(error)) > LONGEST or not str(error).isprintable() or not error.sentence:
            wrong = f"a sentence of {len(str(error))} characters: {str(error)[:100]}"
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
        frames = traceback.extract_tb(error.__traceback__)
        place = next((f for f in reversed(frames) if "/engine/" in f.filename or "/app/" in f.filename), frames[-1])
        wrong = f"{type(error).__name__} at {Path(place.filename).name}:{place.lineno}: {str(error)[:120]}"
    spent, grown = time.process_time() - began, memory() - before
    outcome.slowest_s = max(outcome.slowest_s, spent)
    outcome.largest_bytes = max(outcome.largest_bytes, grown)
    if not wrong and spent > LIMIT_S:
        wrong = f"{spent:.1f} s"
    return wrong or (f"{grown >> 20} MiB" if grown > LIMIT_BYTES else "")


def run(
    name: str, *, count: int, seconds: float, seed: int, keep: Path | None = None, file: Path | None = None
) -> Outcome:
    """Try mutations of a reader until there were so many, or so many seconds have passed; or one file alone."""
    reader, outcome, rng = READERS[name], Outcome(name), random.Random(seed)
    memory_disk = Path("/dev/shm")
    folder = Path(tempfile.mkdtemp(prefix="hostile", dir=memory_disk if memory_disk.is_dir() else None))
    tempfile.tempdir = str(folder)
    ends = None  # counted from the second file on: the first one loads the libraries
    try:
        tries = contents(reader, folder, rng) if file is None else iter([(file.name, file.read_bytes())])
        for ending, content in tries:
            if outcome.mutations == 1:
                ends = time.monotonic() + seconds
            if outcome.mutations >= count or (ends is not None and time.monotonic() > ends):
                break
            path = folder / f"tried{Path(ending).suffix}"
            path.unlink(missing_ok=True)
            path.write_bytes(content)
            outcome.mutations += 1
            signal.alarm(HANG_S)
            wrong = tried(reader, path, outcome)
            if wrong:
                outcome.faults[wrong] += 1
                if keep is not None and outcome.faults[wrong] <= KEPT and len(outcome.faults) <= KEPT:
                    mark = hashlib.sha256(content).hexdigest()[:8]
                    (keep / f"{name.replace(' ', '-')}-{mark}{path.suffix}").write_bytes(content)
            if outcome.mutations % 500 == 0:
                gc.collect()
    finally:
        signal.alarm(0)
        shutil.rmtree(folder, ignore_errors=True)
    return outcome


def main() -> None:
    """Run one reader and print what came of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("reader", choices=READERS)
    parser.add_argument("--count", type=int, default=1_000_000)
    parser.add_argument("--seconds", type=float, default=1e9)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--file", type=Path, help="one file to try, and no mutations")
    parser.add_argument("--keep", type=Path, help="a folder for what went wrong")
    asked = parser.parse_args()
    warnings.simplefilter("error", RuntimeWarning)
    faulthandler.register(signal.SIGALRM, chain=True)  # and then the process ends, as by any alarm
    if asked.keep is not None:
        asked.keep.mkdir(parents=True, exist_ok=True)
    held = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (held + ROOM_BYTES, held + ROOM_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    outcome = run(
        asked.reader, count=asked.count, seconds=asked.seconds, seed=asked.seed, keep=asked.keep, file=asked.file
    )
    print(json.dumps({**outcome.__dict__, "faults": dict(outcome.faults.most_common(30))}))


if __name__ == "__main__":
    sys.exit(main())
