# SPDX-License-Identifier: Apache-2.0
"""Bringing CAN output up as the mode demands."""

from __future__ import annotations

import pytest

from safety_island.can.spec import parse_spec
from safety_island.can.start import CanUnavailableError, start_output
from safety_island.can.targets import TARGET_OUTPUT
from safety_island.command.mode import OutputMode
from safety_island.errors import ConfigurationError
from tests.can.rig import REFERENCE, FakeClock, LogLines

PERIOD_S = 0.15


@pytest.fixture
def log() -> LogLines:
    return LogLines()


@pytest.mark.parametrize("mode", [OutputMode.CAN_ONLY, OutputMode.DDS_AND_CAN])
def test_a_bus_that_opens(mode: OutputMode, log: LogLines) -> None:
    output = start_output(mode, parse_spec("mock"), PERIOD_S, FakeClock(), log)
    assert output.send(REFERENCE, 0)
    assert log.lines == []
    output.close()


def test_dds_only_opens_nothing(log: LogLines) -> None:
    output = start_output(
        OutputMode.DDS_ONLY, parse_spec("slcan:/nowhere"), PERIOD_S, FakeClock(), log
    )
    assert output.send(REFERENCE, 0) is False
    assert log.lines == []
    output.close()


def test_can_only_needs_a_bus(log: LogLines) -> None:
    with pytest.raises(ConfigurationError, match="output mode CAN_ONLY has no CAN bus: name one"):
        start_output(OutputMode.CAN_ONLY, None, PERIOD_S, FakeClock(), log)
    with pytest.raises(CanUnavailableError, match=r"\(output mode CAN_ONLY needs it\)$"):
        start_output(OutputMode.CAN_ONLY, parse_spec("slcan:/nowhere"), PERIOD_S, FakeClock(), log)


@pytest.mark.parametrize("bus", [None, "slcan:/nowhere"])
def test_with_dds_it_goes_on_and_says_so(bus: str | None, log: LogLines) -> None:
    spec = parse_spec(bus) if bus else None
    output = start_output(OutputMode.DDS_AND_CAN, spec, PERIOD_S, FakeClock(), log)
    assert output.send(REFERENCE, 0) is False
    assert len(log.lines) == 1
    assert log.lines[0].endswith("; commands go out over DDS alone")
    output.close()


@pytest.mark.parametrize("mode", [OutputMode.CAN_ONLY, OutputMode.DDS_AND_CAN])
def test_a_specification_that_no_bus_can_have_is_an_error_in_every_mode(
    mode: OutputMode, log: LogLines
) -> None:
    with pytest.raises(ConfigurationError, match="unknown CAN backend"):
        start_output(mode, parse_spec("sockcan:can0"), PERIOD_S, FakeClock(), log)


@pytest.mark.parametrize("target", TARGET_OUTPUT)
def test_the_bus_of_each_target_is_one_that_exists(target: str) -> None:
    if bus := TARGET_OUTPUT[target].can:
        assert str(parse_spec(bus)) == bus
