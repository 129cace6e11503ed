"""Wraps the desktop bundle in a Debian package: deb.py BUNDLE OUT."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

HERE = Path(__file__).parent
CONTROL = """Package: retake
Version: {version}
Architecture: {architecture}
Maintainer: The makers of Retake <retake@localhost>
Installed-Size: {kilobytes}
Depends: {depends}
Section: graphics
Priority: optional
Description: Edit a facial performance without reshooting it
 Retake shows a captured face take as curves that anyone can read, turns
 dragged curves back into a whole plausible face, fills lost spans, pins
 poses, cleans jitter and shows what was changed.
"""
SHARED = {  # where each file of the desktop goes
    "retake.desktop": "usr/share/applications/retake.desktop",
    "retake.xml": "usr/share/mime/packages/retake.xml",
    "retake.svg": "usr/share/icons/hicolor/scalable/apps/retake.svg",
}


def libraries() -> list[str]:
    """Return the Debian packages that the Makefile installs: one list serves both."""
    text = (HERE.parent / "Makefile").read_text().replace("\\\n", " ")
    found = re.search(r"^APT := (.*)$", text, re.MULTILINE)
    if found is None:
        raise SystemExit("The Makefile has no list of Debian packages.")
    return found.group(1).split()


def build(bundle: Path, out: Path) -> Path:
    """Write the package of a bundle's folder into `out`; returns its path."""
    architecture = subprocess.run(
        ["dpkg", "--print-architecture"], capture_output=True, text=True, check=True
    ).stdout.strip()
    release = version("retake")
    target = out / f"retake_{release}_{architecture}.deb"
    with tempfile.TemporaryDirectory(dir=out) as folder:
        root = Path(folder) / "retake"
        shutil.copytree(bundle, root / "opt" / "retake", symlinks=True)
        for name, place in SHARED.items():
            (root / place).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(HERE / "desktop" / name, root / place)
        (root / "usr" / "bin").mkdir(parents=True)
        (root / "usr" / "bin" / "retake").symlink_to("/opt/retake/retake")
        size = sum(path.stat().st_size for path in root.rglob("*") if path.is_file()) // 1024
        (root / "DEBIAN").mkdir()
        (root / "DEBIAN" / "control").write_text(
            CONTROL.format(version=release, architecture=architecture, kilobytes=size, depends=", ".join(libraries()))
        )
        root.chmod(0o755)
        subprocess.run(["dpkg-deb", "--root-owner-group", "-Zxz", "-z3", "--build", root, target], check=True)
    return target


if __name__ == "__main__":
    print(build(Path(sys.argv[1]), Path(sys.argv[2])))
