# SPDX-License-Identifier: Apache-2.0
"""Where the package lies on disk, or in the program that it was packed into."""

from __future__ import annotations

from pathlib import Path

PACKAGE = Path(__file__).parent
"""The folder ``safety_island``."""
