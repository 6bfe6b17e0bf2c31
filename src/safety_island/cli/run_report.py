# SPDX-License-Identifier: Apache-2.0
"""What ``island run`` tells of itself: a few lines for a person, or every tick as a JSON line."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Protocol

from safety_island.cli.jsonlines import JsonLines
from safety_island.cli.run_can import CanSide
from safety_island.cli.status.names import guard_limits_of, input_name, verdict_of
from safety_island.cli.tick_times import TickTimes
from safety_island.control.status import LongitudinalState, MpcStatus
from safety_island.kernel.records import Records
from safety_island.node import Outcome, TickReport
from safety_island.node.command_check import CommandCheck
from safety_island.node.input import Input
from safety_island.node.input_set import InputSet
from safety_island.platform import Clock, Logger


class Observed(Protocol):
    """What a report reads of the controller node."""

    clock: Clock
    logger: Logger
    inputs: InputSet
    check: CommandCheck


class RunReport:
    """An observer of the controller node.

    ``trace`` is the trajectory follower's TRACE record; ``since_start`` tells the time [s] since
    the start of the process; ``lines`` None: only the first command and the summary, as log lines;
    ``can``: what is sent on CAN, if anything.
    """

    def __init__(
        self,
        node: Observed,
        trace: Records,
        since_start: Callable[[], float],
        lines: JsonLines | None,
        can: CanSide | None = None,
    ) -> None:
        self.published = self.skipped = self.ticks = self.refused = 0
        self.first_control_s: float | None = None
        self._node = node
        self._trace = trace
        self._since_start = since_start
        self._lines = lines
        self._can = can
        self._max_lateness_s = 0.0
        self._times = TickTimes()

    def __call__(self, report: TickReport) -> None:
        """Take one tick."""
        self.ticks += 1
        self.skipped += report.skipped
        self.refused += report.refused
        self._max_lateness_s = max(self._max_lateness_s, report.lateness_s)
        if report.published:
            self._take_published(report)
        if self._lines is not None:
            ages = sample_ages(self._node.inputs.items, self._node.clock.wall_ns())
            values = tick_values(report, self._trace, ages) | guard_values(self._node.check)
            if self._can is not None:
                values["can"] = self._can.take()
            self._lines.write("tick", values)
        elif self._can is not None:
            self._can.show()

    def _take_published(self, report: TickReport) -> None:
        self.published += 1
        self._times.add(report.tick_time_s)
        if self.first_control_s is None:
            self.first_control_s = self._since_start()
            self._node.logger.info(
                "first Control sent %.2f s after the start of the process", self.first_control_s
            )
            if self._lines is not None:
                self._lines.write("first_control", {"after_s": self.first_control_s})

    def summary(self) -> dict[str, Any]:
        """Return the figures of the whole run; times in seconds."""
        times = self._times
        return {
            "can_counts": self._can.summary() if self._can is not None else None,
            "ticks": self.ticks,
            "published": self.published,
            "missed_ticks": self.skipped,
            "refused_samples": self.refused,
            "first_control_s": self.first_control_s,
            "max_lateness_s": self._max_lateness_s,
            "tick_times_s": {
                "median": times.quantile(50),
                "p99": times.quantile(99),
                "max": times.max_s if times.count else None,
            },
        }

    def finish(self) -> None:
        """Tell the summary."""
        figures = self.summary()
        if self._lines is not None:
            self._lines.write("summary", figures)
        median_s = figures["tick_times_s"]["median"]
        median = "" if not median_s else f", tick {median_s * 1e3:.2f} ms at the median"
        self._node.logger.info(
            "%d ticks, %d commands, %d ticks missed%s",
            self.ticks,
            self.published,
            self.skipped,
            median,
        )


def sample_ages(inputs: Sequence[Input], wall_ns: int) -> dict[str, float]:
    """Time [s] since the newest sample of each input was sent, by wall clock; inf: none came."""
    return {
        item.name: (wall_ns - item.taken.source_timestamp_ns) / 1e9 if item.taken else math.inf
        for item in inputs
    }


def guard_values(check: CommandCheck) -> dict[str, Any]:
    """Return what the guard did with the command of the tick, and by which of its limits."""
    return {"guard": verdict_of(check.verdict), "guard_limits": guard_limits_of(check.limits)}


def tick_values(report: TickReport, trace: Records, ages: dict[str, float]) -> dict[str, Any]:
    """Return one tick as named values; lengths in m, angles in rad, times in s."""
    values: dict[str, Any] = {
        "number": report.number,
        "outcome": report.outcome.name,
        "detail": report.detail,
        "state": report.life.state.name,
        "reason": report.life.reason.name,
        "subject": input_name(report.subject),
        "lateness_s": report.lateness_s,
        "skipped": report.skipped,
        "tick_s": report.tick_time_s,
        "ages_s": ages,
        "refused": report.refused,
    }
    command = report.command
    if command is not None and report.outcome is Outcome.PUBLISHED:
        row = trace[0]
        values |= {
            "steering_tire_angle": command.steering_tire_angle,
            "steering_tire_rotation_rate": command.steering_tire_rotation_rate,
            "velocity": command.velocity,
            "acceleration": command.acceleration,
            "longitudinal_state": LongitudinalState(row["lon_state"]).name,
            "mpc_status": MpcStatus(row["mpc_status"]).name,
            "lateral_error": float(row["lateral_error"]),
            "stop_dist": float(row["stop_dist"]),
        }
    return values
