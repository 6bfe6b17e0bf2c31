# SPDX-License-Identifier: Apache-2.0
"""Lines for a person."""

from __future__ import annotations

import sys

from safety_island.cli import streams

LOST = "standard output is lost (%s): nothing more is written there, everything else goes on"
"""What is said once when the reader of a report has gone."""


def tell(text: str) -> None:
    """Print a line on standard error at once; when that is lost, nothing else is."""
    try:
        print(text, file=sys.stderr, flush=True)
    except OSError:
        streams.give_up(sys.stderr)


def tell_lost(reason: str) -> None:
    """Say that standard output is lost."""
    tell(LOST % reason)
