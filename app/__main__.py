"""`retake`: with a command, the command line; with a file or nothing, the window."""

from __future__ import annotations

import sys
from pathlib import Path


def main() -> int:
    """Start what the arguments ask for."""
    arguments = sys.argv[1:]
    if not arguments:
        return _window(None)
    from app import cli

    if len(arguments) == 1 and not arguments[0].startswith("-") and arguments[0] not in cli.names():
        return _window(Path(arguments[0]))
    return cli.run(arguments)


def _window(path: Path | None) -> int:
    from app.window.start import start

    return start(path)


if __name__ == "__main__":
    sys.exit(main())
