# SPDX-License-Identifier: Apache-2.0
"""A private network namespace: its own loopback, no way out, nobody else on the DDS ports."""

from __future__ import annotations

import os
import queue
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
_ROOT_USER = os.geteuid() == 0
_UNSHARE = ["unshare", "--net"] if _ROOT_USER else ["unshare", "--net", "--map-root-user"]
_ENTER = ["--net"] if _ROOT_USER else ["--user", "--preserve-credentials", "--net"]
_LOOPBACK_UP = """
import fcntl, socket, struct, sys
SIOCSIFFLAGS, IFF_UP_RUNNING = 0x8914, 0x41
request = struct.pack("16sh14x", b"lo", IFF_UP_RUNNING)
fcntl.ioctl(socket.socket(socket.AF_INET, socket.SOCK_DGRAM), SIOCSIFFLAGS, request)
print("up", flush=True)
sys.stdin.read()
"""


def reason_against() -> str | None:
    """Say why this machine cannot make a network namespace; None when it can."""
    for tool in ("unshare", "nsenter"):
        if shutil.which(tool) is None:
            return f"{tool} (util-linux) is not on this machine"
    tried = subprocess.run([*_UNSHARE, "true"], capture_output=True, text=True, check=False)
    return None if tried.returncode == 0 else f"unshare is not allowed: {tried.stderr.strip()}"


class Namespace:
    """Runs processes that see each other and nothing else; ends them when it is closed.

    One that is made ``beside`` another belongs to the same user, so that links can join them.
    """

    def __init__(self, beside: Namespace | None = None) -> None:
        unshare = _UNSHARE if beside is None else [*beside._enter(), "unshare", "--net"]
        command = [*unshare, sys.executable, "-c", _LOOPBACK_UP]
        self._holder = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert self._holder.stdout is not None
        assert self._holder.stdout.readline() == "up\n"
        self._running: list[Running] = []

    def start(
        self, command: Sequence[str], environment: Mapping[str, str] | None = None
    ) -> Running:
        """Start a process inside; its standard output can be waited for line by line."""
        running = Running([*self._enter(), *command], {**os.environ, **(environment or {})})
        self._running.append(running)
        return running

    def island(
        self, module: str, *arguments: str, environment: Mapping[str, str] | None = None
    ) -> Running:
        """Start a Python module of this repository inside."""
        paths = {"PYTHONPATH": f"{ROOT / 'src'}{os.pathsep}{ROOT}"}
        command = [sys.executable, "-m", module, *arguments]
        return self.start(command, {**(environment or {}), **paths})

    def run(self, *command: str) -> None:
        """Run a command inside to its end; it must succeed."""
        done = subprocess.run(
            [*self._enter(), *command], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"{command}: {done.stderr}"

    def link(self, name: str, address: str, other: Namespace, its_address: str) -> None:
        """Join two namespaces by a cable: an interface ``name`` in each, with these addresses."""
        peer = ["peer", "name", name, "netns", str(other._holder.pid)]
        self.run("ip", "link", "add", name, "type", "veth", *peer)
        for namespace, its in ((self, address), (other, its_address)):
            namespace.run("ip", "address", "add", f"{its}/24", "dev", name)
            namespace.run("ip", "link", "set", name, "up")

    def _enter(self) -> list[str]:
        return ["nsenter", "--target", str(self._holder.pid), *_ENTER]

    def close(self) -> None:
        """End every process and the namespace."""
        for running in self._running:
            running.close()
        assert self._holder.stdin is not None and self._holder.stdout is not None
        self._holder.stdin.close()
        self._holder.stdout.close()
        self._holder.wait()


class Running:
    """One process; it is asked to end by closing its standard input."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str]) -> None:
        self.process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=ROOT,
            env=dict(environment),
        )
        self._lines: queue.Queue[str] = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def expect(self, wanted: Callable[[str], Any], timeout_s: float = 60.0) -> Any:
        """Return the first true ``wanted(line)``; fail with the lines when none comes in time."""
        seen: list[str] = []
        while True:
            try:
                line = self._lines.get(timeout=timeout_s)
            except queue.Empty:
                raise AssertionError(f"not what was waited for: {seen[-20:]}") from None
            if line == "":
                raise AssertionError(f"ended with {self.process.wait()}: {seen[-20:]}")
            if found := wanted(line):
                return found
            seen.append(line)

    def tell(self, line: str) -> None:
        """Write a line to its standard input."""
        assert self.process.stdin is not None
        self.process.stdin.write(f"{line}\n")
        self.process.stdin.flush()

    def close(self) -> None:
        """Ask the process to end, and end it when it does not."""
        assert self.process.stdin is not None and self.process.stdout is not None
        with suppress(OSError):
            self.process.stdin.close()
        try:
            self.process.wait(5.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self._reader.join()
        self.process.stdout.close()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._lines.put(line.rstrip("\n") or " ")
        self._lines.put("")
