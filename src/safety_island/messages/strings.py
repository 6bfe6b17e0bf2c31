# SPDX-License-Identifier: Apache-2.0
"""The strings that follow the stamp of a message: the same in nearly every one of a topic."""

from __future__ import annotations

from safety_island.messages import wire
from safety_island.messages.wire import HEADER_SIZE

_START = HEADER_SIZE + 8


class LeadingStrings:
    """Reads ``count`` strings behind a stamp; compares first with those of the message before.

    ``texts`` are the strings that were read last.
    """

    def __init__(self, type_name: str, count: int) -> None:
        self.texts: tuple[str, ...] = ()
        self._type_name, self._count = type_name, count
        self._bytes: bytes | None = None
        self._end = _START

    def read(self, data: bytes) -> int:
        """Return the place after the strings. Raises DecodeError for what is no string."""
        if data[_START : self._end] == self._bytes:
            return self._end
        end, texts = _START, []
        for _ in range(self._count):
            text, end = wire.read_string(data, end, self._type_name)
            texts.append(text)
        self.texts, self._end, self._bytes = tuple(texts), end, bytes(data[_START:end])
        return end
