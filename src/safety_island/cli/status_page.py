# SPDX-License-Identifier: Apache-2.0
"""Writes docs/status.md from the code: ``python -m safety_island.cli.status_page``."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from enum import Enum
from pathlib import Path
from typing import Any

from safety_island.cli.status.docs import member_docs, message_fields
from safety_island.control.status import ControllerLimit
from safety_island.input_gate.reason import EXPLANATIONS as SAMPLE_REASONS
from safety_island.input_gate.warning import EXPLANATIONS as WARNINGS
from safety_island.life_cycle.reason import EXPLANATIONS as REASONS
from safety_island.life_cycle.state import State
from safety_island.messages.arm import ARM, ArmResult
from safety_island.messages.status import INPUT_STATUS, STATUS
from safety_island.status.holds import EXPLANATIONS as HOLDS
from safety_island.status.holds import MPC_EXPLANATIONS
from safety_island.status.names import GUARD_LIMITS

PAGE = "docs/status.md"
INTRODUCTION = """\
# Status

Generated from the code. To renew this page: `python -m safety_island.cli.status_page`.

Every tick the island says on `/safety_island/status` what it does and why. `island status` shows
it, `island status --json` streams it, `island status --why` says why nothing is being published,
what holds a vehicle whose commands are sent, or that all is well: that only when the vehicle is
free to drive. It looks for about a second: at the island, for what comes and goes from tick to
tick, and at the domain, for the publishers of an input that does not come. There may be none, or
one whose type or QoS does not match, or one that sends nothing; samples that come and are refused
have a reason of their own. `island status --why --json` has the same text as `why`, with `flows`
(commands are published), `free` (nothing holds the vehicle) and `held_by` (names of the table
below); each line of `island status --json` has `held_by` as well.
"""
STATES = "What the island lets out."
REASON = "Why the island is in its state, and the cause that is latched (`latched_cause`)."
REFUSED = "Why a sample of an input was refused; `refused` counts them, each reason at its number."
WARNING = "What is wrong with an input without ending the output."
LIMITS = "What bounded or held a command in the controllers (`controller_limits`)."
GUARD = "What bounded a command in the guard (`guard_limits`), which clamped or refused it."
ANSWERS = "What `island arm` is answered (`arm_result`)."
HELD = "What keeps a vehicle in ACTIVE from driving freely (`held_by`)."
MPC = "Why the MPC did or did not give a steering angle (`mpc_status`)."
FIELDS = """\
## Messages

In the order of the wire. Each has a fixed size, and its little-endian body is a C struct without
padding. The `.msg` and `.idl` files are in `src/safety_island/messages`.
"""


def render() -> str:
    """Return the page."""
    sections = [
        _section("States", STATES, _plain_table(State)),
        _section("Reasons", REASON, _explained_table("reason", REASONS)),
        _section("Refused samples", REFUSED, _explained_table("reason", SAMPLE_REASONS)),
        _section("Warnings", WARNING, _explained_table("warning", WARNINGS)),
        _section("Limits of the controllers", LIMITS, _plain_table(ControllerLimit)),
    ]
    if GUARD_LIMITS:
        sections.append(
            _section("Limits of the guard", GUARD, _explained_table("limit", GUARD_LIMITS))
        )
    sections += [
        _section("What holds the vehicle", HELD, _held_table()),
        _section("Answers to a request to arm", ANSWERS, _plain_table(ArmResult)),
        _section("States of the MPC", MPC, _explained_table("state", MPC_EXPLANATIONS)),
    ]
    messages = [f"### `{name}`\n\n{_fields(name)}\n" for name in (STATUS, INPUT_STATUS, ARM)]
    return "\n".join([INTRODUCTION, *sections, FIELDS, *messages])


def _section(title: str, text: str, table: str) -> str:
    return f"## {title}\n\n{text}\n\n{table}\n"


def _plain_table(enum: type[Enum]) -> str:
    docs = member_docs(enum)
    rows = ([str(item.value), f"`{item.name}`", _cell(docs[item.name])] for item in enum)
    return _table(["number", "name", "meaning"], rows)


def _explained_table(what: str, table: Mapping[Any, tuple[str, str]]) -> str:
    rows = (
        [str(int(item)), f"`{item.name}`", _cell(meaning), _cell(action)]
        for item, (meaning, action) in table.items()
    )
    return _table(["number", what, "meaning", "what to do"], rows)


def _held_table() -> str:
    rows = (
        [f"`{hold}`", *(_cell(_FIELD.sub(_field_name, text)) for text in explanation)]
        for hold, explanation in HOLDS.items()
    )
    return _table(["name", "meaning", "what to do"], rows)


_FIELD = re.compile(r"\{(\w+)[^}]*\}")


def _field_name(found: re.Match[str]) -> str:
    return f"*{found[1].replace('_', ' ')}*"


def _fields(type_name: str) -> str:
    rows = (
        [f"`{field.name}`", f"`{field.type}`", field.unit, _cell(field.meaning)]
        for field in message_fields(type_name)
    )
    return _table(["field", "type", "unit", "meaning"], rows)


def _cell(text: str) -> str:
    words = " ".join(text.split()).replace("``", "`").replace("{subject}", "*an input*")
    return words.replace("|", "\\|")


def _table(head: list[str], rows: Iterable[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def main(arguments: Sequence[str]) -> None:
    """Write the page to the path given, or to where it belongs below the working directory."""
    path = Path(arguments[0] if arguments else PAGE)
    path.write_text(render(), "utf-8")
    print(f"wrote {path}")


if __name__ == "__main__":
    main(sys.argv[1:])
