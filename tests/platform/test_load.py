# SPDX-License-Identifier: Apache-2.0
"""Platforms by name."""

from __future__ import annotations

import pytest

from safety_island.errors import ConfigurationError
from safety_island.platform import load
from tests.platform.rig import Rig


def test_an_unknown_platform_is_refused_with_the_list() -> None:
    with pytest.raises(ConfigurationError, match=r"'amiga' is unknown: choose one of posix, sim"):
        load("amiga")


def test_a_platform_knows_its_name(rig: Rig) -> None:
    assert load(rig.platform.name).name == rig.platform.name


def test_stopping_is_not_called_without_a_reason(rig: Rig) -> None:
    calls: list[int] = []
    with rig.platform.on_stop(lambda: calls.append(1)):
        pass
    assert calls == []
