# SPDX-License-Identifier: Apache-2.0
"""What ``island bridge`` is to the machine: a real-time process, and a service with a watchdog."""

from __future__ import annotations

from safety_island.cli.start_again import must_rejoin
from safety_island.cli.stopping import StopFlag
from safety_island.cli.tell import tell
from safety_island.platform.posix.real_time import BRIDGE, take_real_time
from safety_island.platform.posix.service import ServiceManager


class BridgeService(StopFlag):
    """The flag that the bridge looks at in every round of its loop.

    The first round, with every thread there, takes real-time scheduling and tells the service
    manager "ready"; each one tells it that the bridge is well. Raises RealTimeError.
    """

    def __init__(self, realtime: str, cpu: str) -> None:
        super().__init__()
        self._realtime, self._cpu = realtime, cpu
        self._manager = ServiceManager()
        self._is_ready = False
        self.must_rejoin = False
        """Whether it ends because a domain must be joined anew."""

    def is_set(self) -> bool:
        """Whether to end."""
        if not self._is_ready:
            self._is_ready = True
            result = take_real_time(self._realtime, self._cpu, BRIDGE, rank=1)
            if result is not None:
                tell(str(result))
            self._manager.ready()
        if super().is_set():
            self._manager.stopping()
            return True
        self.must_rejoin = must_rejoin()
        self._manager.alive()
        return self.must_rejoin
