# SPDX-License-Identifier: Apache-2.0
"""One process of the demo: started, listened to, ended."""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import IO, Any

_LIBC = ctypes.CDLL(None)
_PR_SET_PDEATHSIG = 1
STOP_LIMIT_S = 3.0
"""A process that was told to end and has not by then is killed."""


class _Pipe:
    """Cuts what a non-blocking pipe gives into lines."""

    def __init__(self, stream: IO[bytes]) -> None:
        self.stream = stream
        os.set_blocking(stream.fileno(), False)
        self._rest = b""

    def lines(self) -> Iterator[str]:
        """Yield the lines that are complete."""
        while True:
            try:
                data = os.read(self.stream.fileno(), 65536)
            except BlockingIOError:
                return
            if not data:
                return
            *complete, self._rest = (self._rest + data).split(b"\n")
            for line in complete:
                yield line.decode(errors="replace")


@dataclass
class Child:
    """A command of ``island`` in a process of its own, whose standard output is JSON lines."""

    name: str
    arguments: Sequence[str]
    program: Sequence[str] = (sys.executable, "-m", "safety_island")
    said: list[str] = field(default_factory=list)
    """Lines of its standard error."""
    is_controlled: bool = False
    """Whether it obeys lines on its standard input."""

    def start(self) -> None:
        """Start it; it ends when this process does, however that comes about."""
        environment = {k: v for k, v in os.environ.items() if k != "CYCLONEDDS_URI"}
        self.process = subprocess.Popen(
            [*self.program, *self.arguments],
            stdin=subprocess.PIPE if self.is_controlled else subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment,
            start_new_session=True,  # Ctrl-C goes to the demo, which ends its children in order
            preexec_fn=_end_with_parent,
        )
        assert self.process.stdout is not None
        assert self.process.stderr is not None
        self._out, self._err = _Pipe(self.process.stdout), _Pipe(self.process.stderr)

    @property
    def streams(self) -> tuple[IO[bytes], IO[bytes]]:
        """What to wait on for ``events``."""
        return self._out.stream, self._err.stream

    def events(self) -> Iterator[dict[str, Any]]:
        """Yield what it reported since the last call; log lines are added to ``said``."""
        self.said += self._err.lines()
        for line in self._out.lines():
            try:
                event = json.loads(line)
            except ValueError:
                self.said.append(line)
            else:
                yield event

    def say(self, line: str) -> None:
        """Write a line to its standard input; one that has ended does not read it."""
        if self.process.stdin is not None:
            with contextlib.suppress(OSError):
                os.write(self.process.stdin.fileno(), line.encode() + b"\n")

    @property
    def exit_code(self) -> int | None:
        """None while it runs."""
        return self.process.poll()

    def tell_to_stop(self) -> None:
        """Ask it to end, also when it stands still; one that has ended is left alone."""
        if self.exit_code is None:
            self.process.send_signal(signal.SIGTERM)
            self.go_on()

    def stand_still(self) -> None:
        """Stop it in its tracks, as a machine that hangs does."""
        self.process.send_signal(signal.SIGSTOP)

    def go_on(self) -> None:
        """Let it go on from where it stood still."""
        self.process.send_signal(signal.SIGCONT)

    def kill(self) -> None:
        """End it at once."""
        self.process.kill()

    def wait(self, limit_s: float = STOP_LIMIT_S) -> int:
        """Wait for its end, or kill it after the limit; return its exit code."""
        try:
            return self.process.wait(limit_s)
        except subprocess.TimeoutExpired:
            self.process.kill()
            return self.process.wait()

    def close(self) -> None:
        """Give the pipes back."""
        for stream in (self.process.stdin, *self.streams):
            if stream is not None:
                stream.close()


def how_it_ended(exit_code: int) -> str:
    """Say how a process ended."""
    if exit_code >= 0:
        return f"exit code {exit_code}"
    try:
        return f"signal {signal.Signals(-exit_code).name}"
    except ValueError:
        return f"signal {-exit_code}"


def _end_with_parent() -> None:
    """In the new process: ask the kernel for SIGTERM when the parent dies."""
    _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
