# SPDX-License-Identifier: Apache-2.0
"""Forged RTPS: a datagram that carries any payload in the name of a real writer.

No library stands between the payload and the reader's network stack, so the reader meets what a
broken or hostile sender could send.
"""

from __future__ import annotations

import socket
import struct

_PORT_BASE, _DOMAIN_GAIN, _PARTICIPANT_GAIN, _UNICAST_DATA = 7400, 250, 2, 11
_DATA = 0x15
_DATA_FRAGMENT = 0x16
_LITTLE_ENDIAN = 0x01
_LITTLE_ENDIAN_WITH_DATA = 0x05
_MAX_DATAGRAM = 60_000


class Forger:
    """Sends data in the name of the writer ``guid`` to the participants of a domain on a host.

    ``ports`` are those of the participants; without, the first that RTPS defines for the domain.
    """

    def __init__(
        self,
        domain_id: int,
        guid: bytes,
        next_number: int,
        host: str = "127.0.0.1",
        ports: list[int] | None = None,
    ) -> None:
        self._prefix, self._writer = guid[:12], guid[12:]
        self._number = next_number
        self._host = host
        base = _PORT_BASE + _DOMAIN_GAIN * domain_id + _UNICAST_DATA
        self._ports = ports or [base + _PARTICIPANT_GAIN * index for index in range(4)]
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(self, payload: bytes, *, counts: bool = True) -> None:
        """Send one sample; what does not count leaves its sequence number to the next one."""
        assert len(payload) < _MAX_DATAGRAM
        fields = (0, 16, bytes(4), self._writer, 0, self._number)
        body = struct.pack("<HH4s4siI", *fields) + payload
        self._datagram(_DATA, _LITTLE_ENDIAN_WITH_DATA, body)
        self._number += counts

    def send_fragments(self, payload: bytes, size: int, *, without: int) -> None:
        """Send one sample in fragments of ``size`` bytes, all but one (counted from 1)."""
        for number in range(1, -(-len(payload) // size) + 1):
            part = payload[(number - 1) * size : number * size]
            fields = (0, 28, bytes(4), self._writer, 0, self._number, number, 1, size)
            body = struct.pack("<HH4s4siIIHHI", *fields, len(payload)) + part
            if number != without:
                self._datagram(_DATA_FRAGMENT, _LITTLE_ENDIAN, body)
        self._number += 1

    def _datagram(self, kind: int, flags: int, body: bytes) -> None:
        header = b"RTPS\x02\x05\x01\x10" + self._prefix
        message = header + struct.pack("<BBH", kind, flags, 0) + body
        for port in self._ports:
            self._socket.sendto(message, (self._host, port))

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()
