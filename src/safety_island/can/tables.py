# SPDX-License-Identifier: Apache-2.0
"""The tables of ``docs/can.md``, made from the code."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

from safety_island.can.backends import BACKENDS
from safety_island.can.targets import TARGET_OUTPUT
from safety_island.command.frames import FRAMES, Signal
from safety_island.command.mode import OutputMode
from safety_island.errors import ConfigurationError

_BLOCK = re.compile(r"(<!-- table: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    titles = list(head)
    lines = [titles, ["---"] * len(titles), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _place(signal: Signal) -> str:
    first, bit = divmod(signal.start_bit, 8)
    if signal.bits < 8:
        return f"{first}, bit {bit}"
    last = first + signal.bits // 8 - 1
    return f"{first}" if last == first else f"{first}-{last}"


def frame_table() -> str:
    """Return the table of frames and signals."""
    rows = [
        (
            f"`0x{frame.arbitration_id:03X}`",
            _place(signal),
            f"`{signal.name}`",
            f"{'int' if signal.signed else 'uint'}{signal.bits}",
            f"x {signal.scale:,}" if signal.scale > 1 else "",
            signal.unit,
            signal.meaning,
        )
        for frame in FRAMES
        for signal in frame.signals
    ]
    head = ("frame", "bytes", "signal", "type", "scale", "unit", "meaning")
    return _table(head, rows)


def mode_table() -> str:
    """Return the table of output modes."""
    rows = [
        (
            f"`{mode.name}`",
            str(mode.value),
            "publishes `control_cmd`" if mode.uses_dds else "nothing",
            "three frames" if mode.uses_can else "nothing",
        )
        for mode in OutputMode
    ]
    return _table(("mode", "number", "DDS", "CAN"), rows)


def target_table() -> str:
    """Return the table of targets."""
    rows = [
        (f"`{name}`", f"`{row.mode.name}`", f"`{row.can}`" if row.can else "none")
        for name, row in TARGET_OUTPUT.items()
    ]
    return _table(("target", "default mode", "default bus"), rows)


def backend_table() -> str:
    """Return the table of backends."""
    rows = [(f"`{row.name}`", f"`--can {row.example}`", row.meaning) for row in BACKENDS]
    return _table(("backend", "example", "what it is"), rows)


TABLES: dict[str, Callable[[], str]] = {
    "frames": frame_table,
    "modes": mode_table,
    "targets": target_table,
    "backends": backend_table,
}


def refresh(page: str) -> str:
    """Return a page of Markdown with each marked table made anew.

    A table stands between ``<!-- table: NAME -->`` and ``<!-- end -->``. Raises ConfigurationError
    for a name that no table has.
    """
    return _BLOCK.sub(lambda match: match[1] + _table_named(match[2]) + match[3], page)


def _table_named(name: str) -> str:
    if name not in TABLES:
        raise ConfigurationError(f"no table is named '{name}', expected {' or '.join(TABLES)}")
    return TABLES[name]()
