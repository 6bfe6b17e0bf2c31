# SPDX-License-Identifier: Apache-2.0
"""Island, bridge and main compute as processes, and what can be done to them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from safety_island.cli.demo.children import bridge_file
from safety_island.dds import topics
from safety_island.input_gate.reason import SampleReason
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.status_fields import InputStatus, Status
from tests.live.ear import ROUND_S, Ear, Heard

LIMIT_S = 40.0
"""How long to wait for what must come, on a machine that is busy with other tests."""
LONGEST = ("--duration", "120")  # nobody outlives a run of the tests that was killed
ISLAND, BRIDGE, VEHICLE = "island", "bridge", "main-compute"
Wanted = Callable[[Status], bool]


class Scene:
    """Up to three processes, and an ear on either domain.

    ``meanwhile`` is called in every round of waiting. Everything ends with ``close``.
    """

    def __init__(self, domains: tuple[int, int], folder: Path) -> None:
        main, island = self.domains = domains
        self.meanwhile: Callable[[], None] = lambda: None
        self.main = Ear(main, topics.CONTROL, topics.OPERATION_MODE, topics.ODOMETRY)
        self.island = Ear(island, topics.STATUS, topics.CONTROL, topics.ODOMETRY)
        self._folder = folder
        self._running: dict[str, subprocess.Popen[bytes]] = {}
        config = folder / "bridge.yaml"
        config.write_text(bridge_file(domains), "utf-8")
        self._commands = {
            ISLAND: ["run", *LONGEST, "--domain", str(island)],
            BRIDGE: ["bridge", *LONGEST, str(config)],
            VEHICLE: ["main-compute", *LONGEST, "--domain", str(main), "--repeat"],
        }

    def start(self, name: str, at: str = "") -> None:
        """Start a process, again when it was killed; ``at`` tells two of a kind apart."""
        self._running[at or name] = self.command(self._commands[name], at or name)

    def command(self, arguments: list[str], name: str) -> subprocess.Popen[bytes]:
        """Start a command of ``island`` on loopback; what it says goes to a file."""
        environment = {key: value for key, value in os.environ.items() if key != "CYCLONEDDS_URI"}
        with (self._folder / f"{name}.log").open("ab") as log:
            return subprocess.Popen(
                [sys.executable, "-m", "safety_island", *arguments, "--interface", "lo"],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                env=environment,
            )

    def kill(self, name: str) -> None:
        """End a process as a crash does, and wait until it is gone."""
        process = self._running.pop(name)
        process.kill()
        process.wait()

    def stop(self, name: str) -> None:
        """End a process in an orderly way, and wait until it is gone."""
        process = self._running.pop(name)
        process.terminate()
        process.wait()

    def signal(self, name: str, number: signal.Signals) -> None:
        """Send a signal."""
        self._running[name].send_signal(number)

    def log(self, name: str) -> str:
        """What a process has printed so far."""
        return self._folder.joinpath(f"{name}.log").read_text("utf-8")

    def arm(self) -> tuple[int, str]:
        """Run ``island arm``; return its exit code and all that the command ever said."""
        self._folder.joinpath("arm.log").unlink(missing_ok=True)
        domain = str(self.domains[1])
        process = self.command(["arm", "--domain", domain, "--timeout", "30"], "arm")
        self.until(lambda: process.poll() is not None, "island arm ends")
        return process.returncode, self._folder.joinpath("arm.log").read_text("utf-8")

    def until(self, done: Callable[[], bool], what: str) -> None:
        """Listen until something has happened; fail with the logs when it does not."""
        end = time.monotonic() + LIMIT_S
        while not done():
            assert time.monotonic() < end, f"it did not come to this: {what}\n{self._story()}"
            self.meanwhile()
            self.main.listen(0.0)
            self.island.listen(ROUND_S)

    def status(self, wanted: Wanted, what: str, writer: bytes = b"") -> Heard:
        """Return the first status from now on that is wanted, of one island or of any."""
        heard = self.island.heard[topics.STATUS]
        looked_at = len(heard)
        found: list[Heard] = []

        def done() -> bool:
            nonlocal looked_at
            new, looked_at = heard[looked_at:], len(heard)
            found.extend(one for one in new if writer in (b"", one.writer) and wanted(one.message))
            return bool(found)

        self.until(done, what)
        return found[0]

    def state(self, state: State, *reasons: Reason, writer: bytes = b"") -> Heard:
        """Return the first status from now on in a state, for one of some reasons (none: any)."""

        def wanted(status: Status) -> bool:
            return status.state == state and (not reasons or status.reason in reasons)

        return self.status(wanted, f"{state.name} {[reason.name for reason in reasons]}", writer)

    def moves(self) -> None:
        """Wait until the main compute says that the vehicle drives."""
        odometry = self.main.heard[topics.ODOMETRY]
        known = len(odometry)
        self.until(lambda: any(o.message.vx > 0.5 for o in odometry[known:]), "the vehicle drives")

    def _story(self) -> str:
        """The last states, and what the processes said."""
        last: list[str] = []
        for one in self.island.heard[topics.STATUS]:
            status = one.message
            text = f"{State(status.state).name} {Reason(status.reason).name} {status.subject}"
            last += [text] if not last or last[-1] != text else []
        logs = [f"{path.name}: {path.read_text('utf-8')}" for path in self._folder.glob("*.log")]
        return "\n".join([*last[-12:], *logs])

    def close(self) -> None:
        """End everything."""
        for name in list(self._running):
            self.kill(name)
        self.main.close()
        self.island.close()


def row(status: Status, entry: topics.TopicEntry) -> InputStatus:
    """What the status says of one input."""
    order = (
        topics.TRAJECTORY, topics.ODOMETRY, topics.STEERING, topics.ACCELERATION,
        topics.OPERATION_MODE,
    )  # fmt: skip
    return status.inputs[order.index(entry)]


def refused(status: Status, entry: topics.TopicEntry, reason: SampleReason) -> int:
    """How many samples of an input were refused for a reason."""
    return row(status, entry).refused[reason]
