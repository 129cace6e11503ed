from __future__ import annotations

import time
from pathlib import Path

import pytest

from engine.errors import EngineError
from engine.speech import process
from engine.speech.process import Cancelled

ECHO = """
import json, sys
job = json.loads(sys.stdin.buffer.readline())
parts = [sys.stdin.buffer.read(length) for length in job["lengths"]]
print(json.dumps({"part": 0.5}), flush=True)
print(json.dumps({"sizes": [len(part) for part in parts], "said": job["said"]}), flush=True)
"""


def worker(folder: Path, monkeypatch: pytest.MonkeyPatch, program: str) -> None:
    path = folder / "worker.py"
    path.write_text(program)
    monkeypatch.setattr(process, "WORKER", path)


def test_parts_of_any_length_arrive_and_the_answer_comes_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    worker(tmp_path, monkeypatch, ECHO)
    followed: list[float] = []
    answer = process.run({"said": "ä"}, [b"", b"x" * 3_000_000], lambda part: followed.append(part) or True)
    assert answer == {"sizes": [0, 3_000_000], "said": "ä"}
    assert followed[0] == 0.0 and followed[-1] == 0.5 and followed == sorted(followed)


def test_a_program_that_dies_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    worker(tmp_path, monkeypatch, "raise SystemExit(3)")
    with pytest.raises(EngineError, match="ended before it was done"):
        process.run({}, [b"x" * 1_000_000])


def test_what_nobody_wants_any_more_is_ended_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    worker(tmp_path, monkeypatch, "import time; time.sleep(600)")
    begun, looks = time.monotonic(), iter([True, True])
    with pytest.raises(Cancelled):
        process.run({}, [], lambda _: next(looks, False))
    assert time.monotonic() - begun < 60
