# SPDX-License-Identifier: Apache-2.0
"""Errors of the DDS room that are not mistakes in a configuration."""

from safety_island.errors import IslandError


class DdsError(IslandError):
    """The DDS library refused something; the text says what was asked and what it answered."""
