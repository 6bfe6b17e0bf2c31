# SPDX-License-Identifier: Apache-2.0
"""Sizes of the arrays in the life cycle's memory; every byte of it is there from the start."""

MAX_OVERRUN_WINDOW = 1000
"""Most ticks over which the mean period is taken: the range of the parameter ends here."""

MAX_PUBLISHERS = 16
"""Other publishers of the control command that are known by their GUIDs; more are counted only."""
