# SPDX-License-Identifier: Apache-2.0
"""The two lines of CycloneDDS that this program knows."""

from __future__ import annotations

from enum import StrEnum


class Release(StrEnum):
    """A line of releases: one set of functions, of structures and of configuration elements."""

    V0_10 = "0.10"
    V11 = "11"
