"""Lines for a person."""

from __future__ import annotations

import sys


def tell(text: str) -> None:
    """Print a line on standard error at once."""
    print(text, file=sys.stderr, flush=True)
