# SPDX-License-Identifier: Apache-2.0
"""Which channel of a log counts: commands of two islands, or a copy of one, must not be mixed."""

from __future__ import annotations

from safety_island.can.candump import LogEntry
from safety_island.command.frames import COMMAND_IDS
from safety_island.errors import ConfigurationError


class Channels:
    """Takes what is on ``wanted``; without one everything, while one channel carries commands."""

    def __init__(self, wanted: str | None) -> None:
        self._wanted = wanted
        self._found: dict[str, int] = {}
        """Frames of commands on each channel."""

    @property
    def are_mixed(self) -> bool:
        """Whether several channels carry commands and none was chosen."""
        return self._wanted is None and sum(map(bool, self._found.values())) > 1

    def takes(self, entry: LogEntry) -> bool:
        """Whether an entry counts; to be asked about every one."""
        is_command = entry.frame is not None and entry.frame.arbitration_id in COMMAND_IDS
        self._found[entry.channel] = self._found.get(entry.channel, 0) + is_command
        if self._wanted is None:
            return not self.are_mixed
        return entry.channel == self._wanted

    def check(self, name: str) -> None:
        """Raise ConfigurationError when nothing, or too much, was taken of the log."""
        if self.are_mixed:
            carrying = {key: n for key, n in self._found.items() if n}
            raise ConfigurationError(
                f"{name}: commands are on {len(carrying)} channels, {_listed(carrying)}; "
                "choose one with --channel"
            )
        if self._wanted is not None and self._wanted not in self._found:
            raise ConfigurationError(
                f"{name}: no channel '{self._wanted}', found {_listed(self._found)}"
            )


def _listed(found: dict[str, int]) -> str:
    return ", ".join(f"{key or 'one without a name'} ({n} frames)" for key, n in found.items())
