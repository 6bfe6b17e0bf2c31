# SPDX-License-Identifier: Apache-2.0
"""The table of targets, and its agreement with the other tables that name them."""

import pytest

from safety_island.can.targets import TARGET_OUTPUT
from safety_island.errors import ConfigurationError
from safety_island.targets.kconfig.targets import NAMES, find_target


def test_targets_of_the_contract() -> None:
    firmware = ("fvp_baser_aemv8r_smp", "s32z270dc2_rtu0_r52@D", "freertos_posix")
    assert (*firmware, "posix") == NAMES
    assert list(TARGET_OUTPUT) == list(NAMES)


def test_board_is_the_name_without_its_revision() -> None:
    assert [find_target(name).board for name in NAMES] == [
        "fvp_baser_aemv8r_smp",
        "s32z270dc2_rtu0_r52",
        "freertos_posix",
        "posix",
    ]


@pytest.mark.parametrize(("name", "hint"), [("posx", "; did you mean 'posix'?"), ("stm32", "")])
def test_unknown_target_is_refused_with_the_list(name: str, hint: str) -> None:
    with pytest.raises(ConfigurationError) as raised:
        find_target(name)
    assert str(raised.value).endswith(f"expected one of {', '.join(NAMES)}{hint}")
