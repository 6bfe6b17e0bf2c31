# SPDX-License-Identifier: Apache-2.0
"""The CAN side of ``island run``: the output, its log file, and what left on it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from safety_island.can.candump import format_frame
from safety_island.can.decoder import Decoded, decode
from safety_island.can.log_writer import CanLogWriter
from safety_island.can.monitor import Seen
from safety_island.can.report import command_text, command_values
from safety_island.can.start import start_output
from safety_island.cli.run_settings import RunSettings
from safety_island.node import ControllerNode
from safety_island.node.outputs import Output
from safety_island.platform import Platform
from safety_island.platform.interfaces import CanFrame


class CanSide:
    """CAN output with everything around it; the frames of the newest command can be taken.

    Opens the bus as the mode demands. Raises CanError when ``CAN_ONLY`` has none, and
    ConfigurationError for a bus or a log file that cannot be.
    """

    def __init__(self, platform: Platform, settings: RunSettings, period_s: float) -> None:
        self._logger = platform.logger
        self._frames: tuple[int, tuple[CanFrame, ...]] | None = None
        self._shows = settings.can is not None and settings.can.backend == "mock"
        self._log = CanLogWriter(settings.can_log, platform.logger) if settings.can_log else None
        clock_ns = platform.clock.monotonic_ns
        self._is_taken = False
        self.output = start_output(
            settings.mode, settings.can, period_s, clock_ns, platform.logger, self._record
        )
        bus = f" on {settings.can}" if settings.can is not None else ""
        platform.logger.info("output mode %s%s", settings.mode.name, bus)

    def _record(self, stamp_ns: int, frames: Iterable[CanFrame]) -> None:
        self._frames = (stamp_ns, tuple(frames))
        if self._log is not None:
            self._log.record(*self._frames)

    def take(self) -> dict[str, Any] | None:
        """Return what left since the last call, decoded again; None when nothing did."""
        if self._frames is None:
            return None
        (stamp_ns, frames), self._frames = self._frames, None
        values: dict[str, Any] = {"frames": [format_frame(frame) for frame in frames]}
        decoded = decode(frames)
        if not isinstance(decoded, Decoded):
            return values | {"fault": str(decoded)}
        seen = Seen(stamp_ns / 1e9, decoded)
        return values | {"text": command_text(seen)} | command_values(seen)

    def show(self) -> None:
        """Log the newest command of a bus that nobody else can listen to, now and then."""
        if self._shows and (values := self.take()) is not None:
            shown = values.get("text", values["frames"])
            self._logger.info("CAN %s", shown, throttled=True)

    def summary(self) -> dict[str, object]:
        """Return output mode and counts of the whole run."""
        return {"output_mode": self.output.mode.name, **self.output.counters.as_dict()}

    def outputs(self, node: ControllerNode) -> tuple[Output, ...]:
        """Return where the commands of the node go; it closes them."""
        mode, self._is_taken = self.output.mode, True
        found: list[Output] = [node.control_topic()] if mode.uses_dds else []
        return (*found, self.output) if mode.uses_can else tuple(found)

    def close(self) -> None:
        """Write the rest of the log, and close a bus that no node took over."""
        if not self._is_taken:
            self.output.close()
        if self._log is not None:
            self._log.close()
