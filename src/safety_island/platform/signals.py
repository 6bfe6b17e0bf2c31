# SPDX-License-Identifier: Apache-2.0
"""The signals that ask a process to end."""

from __future__ import annotations

import signal

_ASKING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def stop_signals() -> tuple[signal.Signals, ...]:
    """Return them; without SIGHUP where ``nohup`` has it ignored."""
    is_deaf = signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    return tuple(number for number in _ASKING if not (number is signal.SIGHUP and is_deaf))
