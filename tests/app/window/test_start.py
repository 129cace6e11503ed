"""What the window waits for before it is seen."""

from __future__ import annotations

import subprocess
import sys

HEAVY = ("scipy", "torch", "pyrender", "trimesh", "av")
LOADED = "app.window.start, app.window.main_window, app.bench.measure"
ASKED = f"import sys, {LOADED}; print(*[name for name in {HEAVY} if name in sys.modules])"


def test_the_window_is_seen_before_anything_heavy_is_loaded() -> None:
    done = subprocess.run([sys.executable, "-c", ASKED], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
