# SPDX-License-Identifier: Apache-2.0
"""Each test that asks for a rig runs on every backend."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from safety_island.platform import BACKENDS
from tests.platform.rig import Rig, open_rig


@pytest.fixture(params=sorted(BACKENDS))
def rig(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Rig]:
    """One backend, closed at the end."""
    with open_rig(request.param, tmp_path) as opened:
        yield opened
