"""The lock file of the bundle pins all that the project needs, with hashes, and tells of no machine."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from packaging.markers import default_environment
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
LOCK = (ROOT / "packaging" / "requirements.lock").read_text(encoding="utf-8")
PINNED = {
    canonicalize_name(name): version for name, version in re.findall(r"^([\w.-]+)==(\S+) \\$", LOCK, re.MULTILINE)
}
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


@pytest.mark.parametrize("text", PROJECT["dependencies"])
def test_every_dependency_is_pinned_to_a_version_that_the_project_allows(text: str) -> None:
    wanted = Requirement(text)
    if wanted.marker is None or wanted.marker.evaluate({**default_environment(), "sys_platform": "linux"}):
        assert wanted.specifier.contains(PINNED[canonicalize_name(wanted.name)])


def test_every_entry_has_a_hash() -> None:
    entries = re.split(r"^(?=[\w.-]+==)", LOCK, flags=re.MULTILINE)[1:]
    assert len(entries) == len(PINNED) > 40
    assert all(re.search(r"--hash=sha256:[0-9a-f]{64}", entry) for entry in entries)


def test_it_names_no_host_and_no_path_of_a_machine() -> None:
    for path in [ROOT / "packaging" / name for name in ("requirements.lock", "overrides.txt", "lock.sh")]:
        text = path.read_text(encoding="utf-8")
        assert "://" not in text and not re.search(r"^--(index|extra|find|trusted)", text, re.MULTILINE), path.name
    assert not (ROOT / "packaging" / "__init__.py").exists()


def test_every_package_of_the_bundle_has_its_licence_told() -> None:
    told = (ROOT / "THIRD_PARTY.md").read_text(encoding="utf-8").lower()
    names = {canonicalize_name(name) for name in re.findall(r"[\w.-]+", told)}
    assert [name for name in PINNED if name not in names] == []


def test_no_cuda_is_bundled() -> None:
    assert PINNED["torch"].endswith("+cpu") and not any(
        name.startswith(("nvidia", "cuda", "triton")) for name in PINNED
    )
