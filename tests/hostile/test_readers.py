"""No file makes a reader fail otherwise than in one sentence, take long, or fill the memory."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import ROOT
from tests.hostile.readers import READERS

QUICK_S = 2.0  # of mutations for each reader in the ordinary suite: a minute and a half in all, with the start of each
SLOW_COUNT = int(os.environ.get("RETAKE_MUTATIONS", "1000000"))
CASES = ROOT.parent / "shared" / "cases" / "hostile"


def fuzzed(reader: str, folder: Path, *options: str) -> dict[str, object]:
    """Return what came of mutations of a reader's files, tried in a process of its own."""
    run = subprocess.run(
        [sys.executable, "-m", "tests.hostile.fuzz", reader, "--keep", str(folder), *options],
        cwd=ROOT,
        env={**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr[-3000:]
    outcome: dict[str, object] = json.loads(run.stdout.splitlines()[-1])
    return outcome


@pytest.mark.parametrize("reader", READERS)
def test_mutations_are_read_or_refused_in_a_sentence(reader: str, tmp_path: Path) -> None:
    outcome = fuzzed(reader, tmp_path, "--seconds", str(QUICK_S), "--seed", "1")
    assert outcome["faults"] == {} and outcome["mutations"] > 5


@pytest.mark.slow
@pytest.mark.parametrize("reader", READERS)
def test_a_million_mutations_are_read_or_refused_in_a_sentence(reader: str, tmp_path: Path) -> None:
    outcome = fuzzed(reader, tmp_path, "--count", str(SLOW_COUNT), "--seed", "2")
    print(outcome)
    assert outcome["faults"] == {} and outcome["mutations"] == SLOW_COUNT


READ_BY = {
    "MIN_cue_overflow.json": "mouth cues",
    "MIN_gltf_100_nodes_5.7GiB.gltf": "gltf",
    "MIN_project_fps_1e-320.retake": "projects",
    "MIN_project_html_devzero.retake": "projects",
    "MIN_project_offset_list.retake": "projects",
    "MIN_textgrid_brackets.TextGrid": "textgrid",
    "character-hang-8a87f0.npz": "npz heads",
    "film-AttributeError-cfa86b.mp4": "films",
    "model-RecursionError-1bcc0d.safetensors": "models",
}


@pytest.mark.parametrize("name", READ_BY)
def test_what_once_did_harm_does_none(name: str, tmp_path: Path) -> None:
    if not (CASES / name).exists():
        pytest.skip("needs the collected cases beside the repository")
    outcome = fuzzed(READ_BY[name], tmp_path, "--file", str(CASES / name))
    assert outcome["faults"] == {} and outcome["mutations"] == 1
