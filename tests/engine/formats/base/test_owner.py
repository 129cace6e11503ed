"""An owner is a process of a computer's boot."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from engine.formats.base.owner import MARK, owner_mark, owner_runs


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
