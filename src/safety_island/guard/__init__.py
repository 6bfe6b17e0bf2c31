# SPDX-License-Identifier: Apache-2.0
"""The guard: independent checks between the controllers and the outputs.

Its rules are plain functions without a decorator, and import nothing but mathematics: whoever needs
them compiled does so from outside (``core/guard.py``).
"""

from safety_island.guard.limit import EXPLANATIONS, Limit, Verdict
from safety_island.guard.params import GuardParams

__all__ = ["EXPLANATIONS", "GuardParams", "Limit", "Verdict"]
