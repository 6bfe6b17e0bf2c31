# SPDX-License-Identifier: Apache-2.0
"""Every pair of state and conditions against a table that was written on its own."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

import pytest

from safety_island.life_cycle.reason import EXPLANATIONS, Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.transition import Conditions, Life
from tests.life_cycle.kernels import next_life

TABLE = """
state  blocked disengaged barred  arm hold ramp path | next   reason     cause
# Latched: out of it only by an explicit act, and never while a cause stands.
SILENT some    -          -       -   -    -     -    | SILENT blocked    kept
SILENT none    OPERATOR   -       -   -    -     -    | READY  disengaged none
SILENT none    GONE       -       -   -    -     -    | SILENT disengaged kept
SILENT none    none       -       yes -    -     -    | ACTIVE none       none
SILENT none    none       cause   no  -    -     -    | SILENT cause      kept
SILENT none    none       -       no  -    -     -    | SILENT latched    kept
# An operator who takes over ends every state but the latched one.
-      some    OPERATOR   -       -   -    -     -    | INIT   blocked    none
-      none    OPERATOR   -       -   -    -     -    | READY  disengaged none
# Out of ACTIVE: silence, or with CAN_ONLY hold and stop.
ARMED  none    none       -       -   -    -     -    | ACTIVE none       none
ARMED  none    GONE       -       -   -    none  -    | READY  disengaged disengaged
ARMED  some    none       -       -   -    none  yes  | INIT   blocked    none
ARMED  some    -          -       -   -    none  -    | SILENT blocked    blocked
ARMED  -       -          -       -   no   -     -    | HOLD   lost       lost
ARMED  -       -          -       -   yes  -     -    | STOP   lost       lost
# HOLD ends with its cause, or in a stop.
HOLD   none    none       -       -   -    -     -    | ACTIVE none       none
HOLD   -       -          -       -   no   -     -    | HOLD   lost       kept
HOLD   -       -          -       -   yes  -     -    | STOP   lost       kept
# A stop that has begun is carried through; at rest, for want of a path, it latches nothing.
STOP   some    none       -       -   -    over  yes  | INIT   blocked    none
STOP   none    none       some    no  -    over  yes  | SILENT barred     barred
STOP   none    none       -       -   -    over  yes  | ACTIVE none       none
STOP   none    none       -       -   -    over  -    | SILENT latched    kept
STOP   none    none       -       -   -    -     -    | STOP   cause      kept
STOP   -       -          -       -   -    over  -    | SILENT lost       kept
STOP   -       -          -       -   -    -     -    | STOP   lost       kept
# Not armed: everything must be there, and a restart at speed needs an explicit act.
-      some    -          -       -   -    -     -    | INIT   blocked    none
-      none    GONE       -       -   -    -     -    | READY  disengaged none
-      none    none       some    no  -    -     -    | SILENT barred     barred
-      none    none       -       -   -    -     -    | ACTIVE none       none
"""
"""``ARMED``: ACTIVE, or READY with a cause, which was ACTIVE. ``ramp``: none (no such output),
over, or still going. ``path``: only a trajectory is lost, and the vehicle stood all the while.
``lost``: blocked, else disengaged. The first row that fits counts."""

GONE = Reason.MODE_WRITER_GONE
FALLS = (Reason.INPUT_STALE, Reason.OVERRUN, Reason.RESTARTED_WHILE_MOVING, GONE)
CAUSES = {
    State.READY: (Reason.NONE, GONE),
    State.HOLD: FALLS,
    State.STOP: FALLS,
    State.SILENT: FALLS,
}
DISENGAGED = (Reason.NONE, Reason.NOT_AUTONOMOUS, GONE)
BARS = (Reason.NONE, Reason.RESTARTED_WHILE_MOVING)
BOOLS = (False, True)
WHO = {"none": Reason.NONE, "OPERATOR": Reason.NOT_AUTONOMOUS, "GONE": GONE}
ROWS = [
    line.replace("|", " ").split()
    for line in TABLE.strip().splitlines()[1:]
    if not line.startswith("#")
]


def lives(state: State) -> list[Life]:
    """A state with each cause that it may carry; its reason is of no account."""
    causes = CAUSES.get(state, (Reason.NONE,))
    return [Life(state, reason, cause) for cause in causes for reason in (cause, Reason.LATCHED)]


def conditions(blocked: tuple[Reason, ...]) -> Iterator[Conditions]:
    rows: Iterator[Any] = product((Reason.NONE, *blocked), DISENGAGED, BARS, *[BOOLS] * 5)
    for values in rows:
        yield Conditions(*values)


EVERY = tuple(conditions((Reason.INPUT_STALE, Reason.OVERRUN)))
PAIRS = [(life, now) for state in State for life in lives(state) for now in EVERY]


def is_armed(life: Life) -> bool:
    """ACTIVE, or out of it without anybody who has let it off."""
    return life.state is State.ACTIVE or (life.state is State.READY and bool(life.cause))


def fits(row: list[str], life: Life, now: Conditions) -> bool:
    state, blocked, disengaged, barred, arm, hold, ramp, path = row[:8]
    words = {False: "no", True: "yes"}
    bars = {"some": now.barred != 0, "cause": now.barred == life.cause, "-": True}
    ramps = {"none": not now.has_ramp, "over": now.ramp_over, "-": True}
    return (
        state in ("-", life.state.name, "ARMED" if is_armed(life) else "-")
        and blocked in ("-", "some" if now.blocked else "none")
        and (disengaged == "-" or WHO[disengaged] == now.disengaged)
        and bars[barred]
        and arm in ("-", words[now.arm])
        and hold in ("-", words[now.hold_over])
        and ramps[ramp]
        and path in ("-", words[now.only_path])
    )


def expected(life: Life, now: Conditions) -> Life:
    row = next(row for row in ROWS if fits(row, life, now))
    words = {
        "none": Reason.NONE,
        "blocked": now.blocked,
        "disengaged": now.disengaged,
        "barred": now.barred,
        "latched": Reason.LATCHED,
        "lost": now.blocked or now.disengaged,
        "cause": life.cause,
        "kept": life.cause,
    }
    return Life(State[row[8]], words[row[9]], words[row[10]])


@pytest.mark.parametrize("state", State)
def test_every_pair_is_as_the_table_says(state: State) -> None:
    for life, now in PAIRS:
        if life.state is state:
            assert next_life(life, now) == expected(life, now), (life, now)


def test_every_row_of_the_table_is_needed() -> None:
    used = {next(i for i, row in enumerate(ROWS) if fits(row, *pair)) for pair in PAIRS}
    assert used == set(range(len(ROWS)))


def test_the_pairs_are_all_pairs() -> None:
    assert len(EVERY) == 3 * 3 * 2 * 2**5
    assert len(PAIRS) == len(EVERY) * 2 * (1 + 2 + 1 + 3 * 4)


def test_all_fields_keep_their_order() -> None:
    names = ("blocked", "disengaged", "barred", "arm", "has_ramp", "hold_over", "ramp_over")
    assert Conditions._fields == (*names, "only_path")
    assert Conditions._field_defaults == {"only_path": False}
    assert Life(State.INIT, Reason.STALLED).cause is Reason.NONE
    assert set(EXPLANATIONS) == set(Reason)
