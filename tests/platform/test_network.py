# SPDX-License-Identifier: Apache-2.0
"""What every network promises."""

from __future__ import annotations

import pytest

from safety_island.platform import NetworkError
from tests.platform.rig import Rig


def test_an_interface_with_an_address_is_ready_at_once(rig: Rig) -> None:
    network = rig.platform.network
    address = network.wait_for_address(rig.interface, limit_s=0.0)
    assert address is not None and address == network.address(rig.interface)
    assert address in network.describe(rig.interface)


def test_a_missing_interface_is_an_error_that_names_those_there_are(rig: Rig) -> None:
    pattern = rf"'nosuch0' has no IPv4 address after 0\.01 s .*no such.*{rig.interface}"
    with pytest.raises(NetworkError, match=pattern):
        rig.platform.network.wait_for_address("nosuch0", limit_s=0.01)
    assert rig.platform.network.address("nosuch0") is None


def test_a_name_that_only_begins_like_an_interface_is_another(rig: Rig) -> None:
    assert rig.platform.network.address(rig.interface + "x" * 20) is None


def test_a_stop_ends_the_wait(rig: Rig) -> None:
    network = rig.platform.network
    assert network.wait_for_address("nosuch0", 1000.0, stopped=lambda: True) is None
