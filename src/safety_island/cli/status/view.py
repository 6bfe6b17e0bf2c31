# SPDX-License-Identifier: Apache-2.0
"""The live view of a status in a terminal."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from safety_island.cli.status import text
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.warning import InputWarning
from safety_island.life_cycle.state import State
from safety_island.messages.status_fields import InputStatus, Status
from safety_island.status.names import flags_of, input_name, name_of
from safety_island.status.why import is_free, why
from safety_island.words import in_words

WIDTH = 96
SILENT_AFTER_S = 1.0
"""Time without a status after which the view says so."""
_STYLES = {State.READY: "bold green", State.ACTIVE: "bold green", State.INIT: "bold yellow"}
_FIGURES = {
    "command": text.command,
    "output": text.output,
    "mode": text.mode,
    "controller": text.controller,
    "errors": text.errors,
    "limits": text.limits,
    "guard": text.guard,
    "tick": text.tick,
    "time grid": text.punctuality,
}


def draw(status: Status | None, age_s: float, title: str) -> RenderableType:
    """Return the whole view; ``age_s`` is the time [s] since the status came."""
    if status is None:
        waiting = Text(f"no status came so far ({age_s:.0f} s)", style="yellow")
        return Panel(waiting, title=title, width=WIDTH)
    body = Group(_head(status, age_s), Text(), _inputs(status), Text(), _figures(status))
    return Panel(body, title=title, width=WIDTH)


def _head(status: Status, age_s: float) -> Text:
    style = _STYLES.get(State(status.state), "bold red") if status.state in list(State) else "bold"
    head = Text.assemble((name_of(State, status.state), style), "  ")
    if status.degraded:
        head.append("degraded  ", style="bold yellow")
    if age_s > SILENT_AFTER_S:
        return head.append(f"no status for {age_s:.1f} s: what stands here is old", "bold red")
    return head.append(why(status), style="" if is_free([status]) else "yellow")


def _inputs(status: Status) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for name in ("input", "age", "limit", "delay", "accepted", "superseded", "refused"):
        table.add_column(name, justify="left" if name in ("input", "refused") else "right")
    for place, item in enumerate(status.inputs):
        table.add_row(
            Text(input_name(place) or "", style="bold"),
            Text(text.duration(item.age), style="red" if item.age > item.age_limit else ""),
            text.duration(item.age_limit),
            text.duration(item.transport_delay),
            str(item.accepted),
            str(item.superseded),
            _notes(item),
        )
    return table


def _notes(item: InputStatus) -> Text:
    """Refusals by reason, then warnings."""
    refused = [
        f"{count} {name_of(SampleReason, reason).lower().replace('_', ' ')}"
        for reason, count in enumerate(item.refused)
        if count
    ]
    notes = Text(", ".join(refused), style="red" if item.refused_in_a_row else "")
    warnings = in_words(", ".join(flags_of(InputWarning, item.warnings)))
    if warnings:
        notes.append(f"{'; ' if refused else ''}warning: {warnings}", style="yellow")
    return notes


def _figures(status: Status) -> Table:
    table = Table.grid(padding=(0, 2))
    table.add_column(style="bold", no_wrap=True)
    table.add_column()
    for name, figure in _FIGURES.items():
        table.add_row(name, figure(status))
    table.add_row("memory", f"{status.memory / 2**20:.0f} MiB")
    return table
