"""`retake`: with a command, the command line; with a file or nothing, the window."""

from __future__ import annotations

import sys


def main() -> int:
    """Start what the arguments ask for."""
    from app import cli

    return cli.run(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
