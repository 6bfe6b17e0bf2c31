# SPDX-License-Identifier: Apache-2.0
"""What goes wrong in the island itself, and from when on it ends the output."""

from safety_island.kernel.kernel import kernel
from safety_island.life_cycle.overrun import forget_overrun
from safety_island.life_cycle.reason import Reason

NONE = int(Reason.NONE)
OVERRUN = int(Reason.OVERRUN)
CONTROLLER_FAULT = int(Reason.CONTROLLER_FAULT)
MPC_FAILED = int(Reason.MPC_FAILED)
OUTPUT_FAILED = int(Reason.OUTPUT_FAILED)


@kernel
def note(streak, failed, now):
    """Count failures in a row, and since when [s, monotonic]; a success ends the streak."""
    if not failed:
        streak.count = 0
        return
    if streak.count == 0:
        streak.since = now
    streak.count += 1


@kernel
def lasts_s(streak, now):
    """Time [s] since the first failure of a streak; 0 when there is none."""
    return now - streak.since if streak.count > 0 else 0.0


@kernel
def begin_tick(f):
    """Begin a tick: the one before has ended, in whatever way."""
    if not f.has_crashed:
        f.crashes = 0
    f.has_crashed = False


@kernel
def note_crash(p, f):
    """Note that the tick ended with an exception; True when too many did."""
    f.has_crashed = True
    f.crashes += 1
    return f.crashes >= p.fault_ticks


@kernel
def note_facts(f, facts, now):
    """Count what went wrong in this tick."""
    note(f.faults, facts.failed, now)
    note(f.unsolved, facts.unsolved, now)
    note(f.refusals, facts.refused != NONE, now)


@kernel
def failure(p, f, overrun, refused, now):
    """Reason why too much has gone wrong to send anything; NONE when it has not."""
    if overrun.over:
        return OVERRUN
    if max(f.faults.count, f.crashes) >= p.fault_ticks:
        return CONTROLLER_FAULT
    if 0.0 < p.mpc_failure_time < lasts_s(f.unsolved, now):
        return MPC_FAILED
    if f.refusals.count >= p.fault_ticks:
        return refused
    return OUTPUT_FAILED if f.outputs.count >= p.fault_ticks else NONE


@kernel
def forget_failures(f, overrun):
    """Begin anew; how the last tick ended is of now."""
    forget_overrun(overrun)
    f.faults.count = 0
    f.unsolved.count = 0
    f.refusals.count = 0
    f.outputs.count = 0
