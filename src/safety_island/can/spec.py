# SPDX-License-Identifier: Apache-2.0
"""What ``--can`` says: a backend, a channel, options."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from safety_island.errors import ConfigurationError
from safety_island.words import did_you_mean

Option = int | float | bool | str


class Backend(NamedTuple):
    """One row of the table of backends."""

    name: str
    module: str
    """Imported when the backend is chosen; it has ``new_device(spec, backend, clock)``."""
    may_block: bool
    """Opening or sending may take longer than asked: a thread does it."""
    example: str
    meaning: str
    echoes: bool = False
    """It receives the frames that it sent itself."""
    silent_reads: int = 1
    """So many reads without a frame in a row mean that nothing is there."""
    kernel_queue: bool = False
    """The kernel holds frames back; its socket tells how much."""


@dataclass(frozen=True)
class BusSpec:
    """A bus by name: ``BACKEND[:CHANNEL][,KEY=VALUE...]``, for example ``socketcan:can0``."""

    backend: str
    channel: str = ""
    options: dict[str, Option] = field(default_factory=dict)

    def __str__(self) -> str:
        options = "".join(f",{key}={value}" for key, value in self.options.items())
        return f"{self.backend}:{self.channel}{options}" if self.channel else self.backend + options

    def refuse_channel(self) -> None:
        """Raise ConfigurationError when there is a channel."""
        if self.channel:
            raise ConfigurationError(
                f"--can {self}: backend '{self.backend}' has no channel, found '{self.channel}'"
            )

    def require_channel(self, example: str) -> None:
        """Raise ConfigurationError when there is no channel."""
        if not self.channel:
            raise ConfigurationError(
                f"--can {self}: the channel is missing, expected for example '{example}'"
            )

    def refuse_options(self, known: Iterable[str]) -> None:
        """Raise ConfigurationError when there is an option besides the known ones."""
        names = sorted(known)
        for key in self.options:
            if key not in names:
                hint = did_you_mean(key, names)
                what = f"it knows {', '.join(names)}" if names else "it has none"
                raise ConfigurationError(
                    f"--can {self}: backend '{self.backend}' has no option '{key}', {what}{hint}"
                )


def parse_spec(text: str) -> BusSpec:
    """Read a bus as ``--can`` takes it. Raises ConfigurationError."""
    head, *pairs = text.split(",")
    backend, _, channel = head.partition(":")
    if not backend:
        raise ConfigurationError(
            f"--can '{text}': expected BACKEND[:CHANNEL][,KEY=VALUE...], "
            "for example socketcan:can0 or mock"
        )
    options: dict[str, Option] = {}
    for pair in pairs:
        key, equals, value = pair.partition("=")
        if not equals or not key.isidentifier():
            raise ConfigurationError(f"--can '{text}': found '{pair}', expected KEY=VALUE")
        options[key] = _typed(value)
    return BusSpec(backend, channel, options)


def _typed(text: str) -> Option:
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
