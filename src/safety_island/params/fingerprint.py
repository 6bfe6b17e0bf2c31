# SPDX-License-Identifier: Apache-2.0
"""One number for a whole parameter set."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict

from safety_island.params.schema import IslandParameters


def parameters_hash(parameters: IslandParameters) -> int:
    """Return 64 bits of a hash of every parameter: sets that differ in any value differ in it."""
    text = json.dumps(asdict(parameters), sort_keys=True)
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], "big")
