"""``python -m safety_island`` is the command ``island``."""

import sys

from safety_island.cli.main import main

sys.exit(main())
