"""The entry point of the desktop bundle."""

import sys

from app.__main__ import main

sys.exit(main())
