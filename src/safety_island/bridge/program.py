# SPDX-License-Identifier: Apache-2.0
"""The bridge as a program: files and options in, exit code out."""

from __future__ import annotations

import gc
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field

from safety_island.bridge.bridge import Bridge, Report, StopEvent
from safety_island.bridge.config_file import Mode, read_bridge_file
from safety_island.bridge.link import Say, WaitFor
from safety_island.bridge.routes import Overrides, plan_routes
from safety_island.dds.config import DdsConfig


@dataclass(frozen=True)
class BridgeOptions:
    """The command line of the bridge; None leaves what the files say."""

    from_domain: int | None = None
    to_domain: int | None = None
    mode: Mode | None = None
    wait_for: WaitFor = field(default_factory=WaitFor)
    dds: DdsConfig = field(default_factory=lambda: DdsConfig(loopback_only=True))
    duration_s: float = 0.0
    """End after this time [s]; 0: when told."""


def run(
    paths: Sequence[str],
    options: BridgeOptions,
    stop: StopEvent,
    report: Report | None = None,
    say: Say | None = None,
) -> int:
    """Run the bridge of some files until ``stop`` is set; return the exit code.

    Raises ConfigurationError for anything in files and options that cannot be used, before a
    domain is entered. Lines for a person go to ``say`` (default: standard error).
    """
    say = say or _print
    files = [read_bridge_file(path) for path in paths]
    overrides = Overrides(options.from_domain, options.to_domain, options.mode)
    for file in files:
        for line in file.notes:
            say(line)
    routes = plan_routes(files, overrides, say)
    for route in routes:
        say(f"{route}: waiting for {_awaited(options.wait_for)}")
    name = files[0].name
    with Bridge(routes, name=name, wait_for=options.wait_for, dds=options.dds, say=say) as bridge:
        gc.collect()
        gc.freeze()
        bridge.run(stop, report, options.duration_s)
        totals = bridge.totals()
    lost = totals["refused"] + totals["failed"]
    say(f"forwarded {totals['forwarded']} samples, {lost or 'none'} lost")
    return 0


def _awaited(wait_for: WaitFor) -> str:
    ends = [("a publisher", wait_for.publisher), ("a subscription", wait_for.subscription)]
    return " and ".join(name for name, wanted in ends if wanted) or "nothing"


def _print(text: str) -> None:
    print(f"bridge: {text}", file=sys.stderr, flush=True)
