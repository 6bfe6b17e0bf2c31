# SPDX-License-Identifier: Apache-2.0
"""Brings CAN output up as the mode demands."""

from __future__ import annotations

from safety_island.can.backends import new_link
from safety_island.can.bus import MonotonicNs
from safety_island.can.output import CanOutput, Recorder
from safety_island.can.spec import BusSpec
from safety_island.command.mode import OutputMode
from safety_island.errors import ConfigurationError
from safety_island.platform.interfaces import CanError, Logger

BUDGET_SHARE = 0.1
"""Share of the control period that one command may wait for the bus."""


class CanUnavailableError(CanError):
    """``CAN_ONLY`` without a bus: nobody would hear the commands."""


def start_output(
    mode: OutputMode,
    spec: BusSpec | None,
    period_s: float,
    clock: MonotonicNs,
    logger: Logger,
    recorder: Recorder | None = None,
) -> CanOutput:
    """Return the output, its bus open when the mode uses CAN.

    ``period_s``: the control period; ``clock``: monotonic [ns]. When the bus cannot be opened,
    ``CAN_ONLY`` raises CanUnavailableError, ``DDS_AND_CAN`` logs it, goes on over DDS, and tries
    again with back-off. A specification that no bus can have raises ConfigurationError in both.
    """
    budget_s = BUDGET_SHARE * period_s
    if not mode.uses_can:
        return CanOutput(mode, None, budget_s, clock, logger)
    if spec is None:
        missing = f"output mode {mode.name} has no CAN bus: name one, for example socketcan:can0"
        if not mode.uses_dds:
            raise ConfigurationError(missing)
        return CanOutput(mode, None, budget_s, clock, logger, open_failure=missing)
    link = new_link(spec, clock)
    failure = None
    try:
        link.open()
    except CanError as error:
        if not mode.uses_dds:
            link.close()
            raise CanUnavailableError(f"{error} (output mode {mode.name} needs it)") from error
        failure = str(error)
    return CanOutput(mode, link, budget_s, clock, logger, recorder, failure)
