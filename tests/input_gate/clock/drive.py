# SPDX-License-Identifier: Apache-2.0
"""Random arrivals of four inputs: late, repeated, after gaps, by clocks that are set or run off.

As a program it prints a digest of every state on the way: compiled or plain, it is the same.
"""

from __future__ import annotations

import hashlib
import random

from safety_island.input_gate.sender_clock import SenderClock
from safety_island.input_gate.stamps import StampGate

LIMITS_S = (0.5, 0.3, 0.2, 0.2)


class Drive:
    """Four inputs, and a tick of 0.1 s; what arrives depends on the dice alone."""

    def __init__(self, seed: int) -> None:
        self.dice = random.Random(seed)
        self.sender = SenderClock()
        self.inputs = [StampGate(limit_s, self.sender) for limit_s in LIMITS_S]
        self.now, self.clock_s, self.rate = 1000.0, 500.0, 1.0

    def tick(self) -> list[str]:
        """Let samples arrive; what each was refused for."""
        dice = self.dice
        self.now += dice.choice((0.1, 0.1, 0.1, 0.15)) + dice.choice((0.0,) * 60 + (1.0, 11.0))
        self.clock_s += 0.1 * self.rate + dice.choice((0.0,) * 40 + (-3.0, -0.15, 0.4, 5.0))
        self.rate = dice.choice((self.rate,) * 40 + (0.9, 1.0, 1.05))
        found = [self._offer(gate) for gate in self.inputs if dice.random() < 0.9]
        self.sender.measure(self.now)
        for gate in self.inputs:
            gate.fade()
        return [*found, f"{self.sender.stamp_ns(self.now)} {self.sender.rate_error}"]

    def _offer(self, gate: StampGate) -> str:
        late_s = self.dice.choice((0.0, 0.0, 0.0, 0.01, 0.06, 0.13, 0.21, 0.4))
        stamp_ns = round((self.clock_s - late_s) * 1e9)
        stamp = divmod(gate.stamp_ns if self.dice.random() < 0.03 else stamp_ns, 10**9)
        data = repr(stamp).encode() + self.dice.choice((b"", b"", b"other"))
        reason = gate.judge(stamp, data, self.now, self.dice.random() < 0.02)
        if reason is None:
            gate.hold(data, self.now)
        return str(reason)

    def memory(self) -> bytes:
        """Return the bytes of all that is remembered."""
        return self.sender.stamps.tobytes() + self.sender.state.tobytes()


def digest(ticks: int) -> str:
    """Return a digest of all outcomes and states."""
    found = hashlib.sha256()
    drive = Drive(5)
    for _ in range(ticks):
        found.update(repr(drive.tick()).encode() + drive.memory())
    return found.hexdigest()


if __name__ == "__main__":
    print(digest(1500))
