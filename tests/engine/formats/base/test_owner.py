"""An owner is a process of a computer's boot."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from engine.formats.base.owner import MARK, boot_mark, owner_mark, owner_runs


def test_an_owner_is_known_by_its_process_and_not_by_a_clock(tmp_path: Path) -> None:
    assert owner_runs(owner_mark()) is True
    computer, boot, pid, began = MARK.fullmatch(owner_mark()).groups()
    assert owner_runs(f"{computer}-{boot}-{pid}-{int(began) + 1}") is False  # the number was given to another since
    assert owner_runs(f"{computer}-{boot[::-1]}-{pid}-{began}") is (boot == boot[::-1])
    assert owner_runs(f"{'0' * 8}-{boot}-{pid}-{began}") is None  # another computer's
    code = "from engine.formats.base.owner import owner_mark; print(owner_mark())"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()
    assert owner_runs(ended) is False
    for text in ("", "csv", f"{ended}-", "x" * 500):
        assert owner_runs(text) is None


def test_a_mark_is_of_this_process_and_says_when_it_began() -> None:
    computer, boot, pid, began = MARK.fullmatch(owner_mark()).groups()
    assert int(pid) == os.getpid() and boot == boot_mark() and owner_mark() == owner_mark()
    if Path("/proc/self/stat").exists():
        fields = Path("/proc/self/stat").read_text().rpartition(")")[2].split()
        assert began == fields[19]
    child = "import os; from engine.formats.base.owner import owner_mark; print(os.getpid(), owner_mark())"
    other_pid, mark = subprocess.run(
        [sys.executable, "-c", child], capture_output=True, text=True, check=True
    ).stdout.split()
    assert MARK.fullmatch(mark).groups()[:3] == (computer, boot, other_pid)


def test_a_process_of_before_the_boot_or_whose_number_is_impossible_runs_no_more() -> None:
    computer, boot, pid, began = MARK.fullmatch(owner_mark()).groups()
    assert owner_runs(f"{computer}-{'0' * 8 if boot != '0' * 8 else '1' * 8}-{pid}-{began}") is False
    assert owner_runs(f"{computer}-{boot}-4194999-1") is False
    assert owner_runs(f"{computer}-{boot}-1-{began}x") is None
