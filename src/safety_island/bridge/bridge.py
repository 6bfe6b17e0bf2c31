# SPDX-License-Identifier: Apache-2.0
"""The domain bridge at work: one thread, one wait for all domains, bytes in and bytes out."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict
from types import TracebackType
from typing import Any, Protocol

from safety_island.bridge.config_file import DEFAULT_NAME
from safety_island.bridge.link import Link, Say, WaitFor
from safety_island.bridge.outlet import Counts
from safety_island.bridge.routes import Route
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.dds.wait_group import WaitGroup

LONGEST_WAIT_S = 0.1
"""After at most this time [s] the bridge sees that it is told to stop."""
LOOK_S, HOLDING_S = 0.05, 0.01
"""Times [s] between looks at who is there: usually, and while a new publisher holds samples."""
REPORT_S = 1.0
STALL_S, CATCH_UP_S = 0.2, 0.05
"""When the process stood still for this time [s], the library gets some time to receive all that
has come meanwhile, so that only the newest of it is forwarded, and nothing that has ended."""

Report = Callable[[str, Mapping[str, Any]], None]
"""Called with an event and its values.

``counts`` once a second, ``alarm`` when publishers of a route are not forwarded that it does not
keep to, ``route`` for each route at the end.
"""


class StopEvent(Protocol):
    """What tells a loop to end; a ``threading.Event`` does."""

    def is_set(self) -> bool:
        """Whether to end."""


class Bridge:
    """The links of all routes over one participant for each domain; a context manager."""

    def __init__(
        self,
        routes: Sequence[Route],
        *,
        name: str = DEFAULT_NAME,
        wait_for: WaitFor | None = None,
        dds: DdsConfig | None = None,
        say: Say,
    ) -> None:
        with ExitStack() as stack:
            domains = sorted({end[0] for route in routes for end in (route.source, route.target)})
            found = {
                domain: stack.enter_context(Participant(domain, dds, f"{name}_{domain}"))
                for domain in domains
            }
            self._participants = list(found.values())
            self._changes: list[int] = []
            self._worked_at = time.monotonic()
            self._alarms: list[Mapping[str, Any]] = []
            self._group = stack.enter_context(WaitGroup[Link]()) if domains else None
            self.links = [
                Link(
                    route,
                    found[route.source[0]],
                    found[route.target[0]],
                    self._group,
                    wait_for or WaitFor(),
                    say,
                    self._alarms.append,
                )
                for route in routes
                if self._group is not None
            ]
            stack.callback(self._close_links)
            self._stack = stack.pop_all()

    def look(self) -> None:
        """Open, change or close routes by who is there now."""
        changes = [participant.changes() for participant in self._participants]
        for link in self.links:
            if changes != self._changes or link.is_unsettled:
                link.look()
        self._changes = changes

    def forward(self, timeout_s: float) -> None:
        """Wait at most ``timeout_s`` [s] for samples and forward all."""
        if self._group is None:
            time.sleep(timeout_s)
            return
        ready = self._group.wait(timeout_s)
        stood_still = time.monotonic() - self._worked_at > timeout_s + STALL_S
        if stood_still:
            time.sleep(CATCH_UP_S)
        for link in self.links if stood_still else dict.fromkeys(ready):
            link.forward(stood_still=stood_still)
        self._worked_at = time.monotonic()

    def run(self, stop: StopEvent, report: Report | None = None, duration_s: float = 0.0) -> None:
        """Forward until ``stop`` is set, or for ``duration_s`` [s] when that is not 0."""
        now = time.monotonic()
        end = now + duration_s if duration_s else float("inf")
        next_look = now
        next_report = now + REPORT_S if report is not None else float("inf")
        while not stop.is_set() and now < end:
            if now >= next_look:
                self.look()
                is_holding = any(link.is_holding for link in self.links)
                next_look = now + (HOLDING_S if is_holding else LOOK_S)
                self._report_alarms(report)
            if report is not None and now >= next_report:
                next_report += REPORT_S
                report("counts", self.totals())
            self.forward(min(LONGEST_WAIT_S, max(0.0, min(next_look, next_report, end) - now)))
            now = time.monotonic()
        if report is not None:
            self._report_end(report)

    @property
    def all_open(self) -> bool:
        """Whether every route forwards."""
        return all(link.is_open for link in self.links)

    def totals(self) -> dict[str, int]:
        """Counts over all routes, how many are open and how many there are."""
        rows = [asdict(link.counts) for link in self.links]
        sums = {name: sum(row[name] for row in rows) for name in asdict(Counts())}
        opened = sum(link.is_open for link in self.links)
        return {**sums, "routes_open": opened, "routes": len(self.links)}

    def close(self) -> None:
        """Leave every domain. A second call does nothing."""
        self._stack.close()

    def __enter__(self) -> Bridge:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _report_alarms(self, report: Report | None) -> None:
        alarms, self._alarms[:] = list(self._alarms), []
        if report is not None:
            for alarm in alarms:
                report("alarm", alarm)

    def _report_end(self, report: Report) -> None:
        report("counts", self.totals())
        for link in self.links:
            (from_domain, topic), (to_domain, out) = link.route.source, link.route.target
            ends = {"topic": topic, "from": from_domain, "to": to_domain, "out": out}
            report("route", {**ends, "open": link.is_open, **asdict(link.counts)})

    def _close_links(self) -> None:
        for link in self.links:
            link.close()
