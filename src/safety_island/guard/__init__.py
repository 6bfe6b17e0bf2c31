# SPDX-License-Identifier: Apache-2.0
"""The guard: independent checks between the controllers and the outputs."""

from safety_island.guard.guard import Guard
from safety_island.guard.limit import EXPLANATIONS, Limit, Verdict
from safety_island.guard.params import GuardParams
from safety_island.guard.proposal import Decision, Proposal

__all__ = ["EXPLANATIONS", "Decision", "Guard", "GuardParams", "Limit", "Proposal", "Verdict"]
