"""``python -m safety_island`` is the command ``island``."""

import sys

from safety_island.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
