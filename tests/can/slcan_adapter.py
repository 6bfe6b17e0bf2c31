# SPDX-License-Identifier: Apache-2.0
"""The other end of a serial line: an adapter that speaks the Lawicel protocol over a real pty."""

from __future__ import annotations

import os
import re
import select
import threading
import tty

from safety_island.platform.interfaces import CanFrame

OK, SENT, ERROR = b"\r", b"z\r", b"\a"
WHOLE = re.compile(r"t[0-9A-F]{3}8[0-9A-F]{16}")


class SlcanAdapter:
    """Answers every command; keeps the frames that it was given while it was open.

    ``stall`` lets it read no more: the line fills up, as with hardware flow control.
    """

    def __init__(self) -> None:
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.path = os.ttyname(self._slave)
        self.frames: list[CanFrame] = []
        self.commands: list[str] = []
        self.is_open = False
        self._wake, self._wake_end = os.pipe()
        self._may_read = threading.Event()
        self._may_read.set()
        self._is_closing = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def emit(self, frame: CanFrame) -> None:
        """Hand a frame from the bus to the computer."""
        text = f"t{frame.arbitration_id:03X}{len(frame.data)}{frame.data.hex().upper()}\r"
        os.write(self._master, text.encode())

    def stall(self) -> None:
        """Read nothing until ``resume``."""
        self._may_read.clear()

    def resume(self) -> None:
        """Read on."""
        self._may_read.set()

    def close(self) -> None:
        """Unplug it."""
        self._is_closing = True
        self._may_read.set()
        os.write(self._wake_end, b"x")
        self._thread.join()
        for descriptor in (self._master, self._slave, self._wake, self._wake_end):
            os.close(descriptor)

    def _run(self) -> None:
        buffer = b""
        while not self._is_closing:
            select.select([self._master, self._wake], [], [])
            self._may_read.wait()
            if self._is_closing:
                return
            buffer += os.read(self._master, 4096)
            *lines, buffer = buffer.split(b"\r")
            for line in lines:
                if answer := self._answer(line.decode()):
                    os.write(self._master, answer)

    def _answer(self, line: str) -> bytes:
        if not line:
            return b""
        self.commands.append(line)
        if line[0] == "t":
            if not self.is_open or not WHOLE.fullmatch(line):
                return ERROR
            self.frames.append(CanFrame(int(line[1:4], 16), bytes.fromhex(line[5:])))
            return SENT
        if line[0] in "OC":
            self.is_open = line[0] == "O"
        return OK
