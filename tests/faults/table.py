# SPDX-License-Identifier: Apache-2.0
"""Makes docs/faults.md from the tests of the campaign: python -m tests.faults.table."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "faults.md"
ROWS = (*range(1, 52), *range(67, 78), *range(81, 97))
"""Rows of the catalogue that this campaign covers."""
ELSEWHERE = (
    ROOT / "tests/can/test_fault_rows.py",
    ROOT / "tests/can/test_dbc.py",
    ROOT / "tests/cli/test_progress.py",
    ROOT / "tests/cli/test_run_start.py",
    ROOT / "tests/kernel/test_kernel.py",
    ROOT / "tests/kernel/test_cache.py",
    ROOT / "tests/dds/test_config.py",
    ROOT / "tests/live/test_behind_bridge.py",
    ROOT / "tests/live/test_real_time.py",
    ROOT / "tests/network/test_follow.py",
    ROOT / "tests/network/test_receive_filter.py",
    ROOT / "tests/platform/posix/test_real_time.py",
    ROOT / "tests/test_private_folder.py",
)

HEAD = """\
# Faults: what is survived, and the test that shows it

Made from the tests by `.venv/bin/python -m tests.faults.table`; a test fails when it is old.
`T` is the control period, `A` the age limit of an input (0.5 s, trajectory 0.9 s). Silent: nothing
on `control_cmd`, nothing on CAN; with `CAN_ONLY` a hold and a declared stop come before. Silence is
latched: it ends when the cause is gone and autonomous mode is left and engaged again.

The campaign runs on virtual time, at periods of 150 ms and 30 ms where both have a bound:

    ./island test tests/faults                      # all of it
    ./island test tests/faults -k row_09            # one row
    FAULTS_SEED=7 ./island test tests/faults        # other phases, losses and bits

What is decided, where another reaction could be expected:

- 4, 88: what all inputs fall behind by is the sender's clock, not a delay, unless it grew while
  nothing came. What one input falls behind the others by is delay.
- 7, 34, 81: a mode whose stamp or source time is older than that of the one in force, by the same
  writer, gives no autonomy; one that takes it away is accepted, once. Only where the other inputs
  show that the clock was set back does an older stamp engage. What its writer has said before, byte
  for byte, changes nothing. (It used to be that any older stamp counted:
  `src/safety_island/input_gate/latched.py` has the rule.)
- 35: a stamp from the far future may be that of a clock that was set. It is taken, and warned of
  (`CLOCK`, `CLOCK_STEP`).
- 37: after a sleep nobody knows where the vehicle is, so there is no ramp, with `CAN_ONLY` neither;
  after a process stood still there is.
- 39: no clock stops a solver. Its iterations are bounded, and a command that is older than
  `timeout_thr_sec` when it would be sent is not sent.
- 24, 25, 27 to 29: silence is latched in motion. While the vehicle stands, trajectories that come
  but cannot be followed end the output and latch nothing (row 92); a planner that sends nothing, or
  the same again, is latched as ever.
- 94: an island that drives goes on and raises the alarm, as with a second publisher: silence would
  leave the vehicle to the other node.
- 77: when autonomous mode is left the PID's integrator pauses; it is not reset, as in the firmware.

| row | fault | reaction | bound | tests |
|---|---|---|---|---|
"""

FAULTS: dict[int, tuple[str, str, str]] = {
    1: ("random loss, 1 to 20 %", "goes on, a low rate is warned of", "-"),
    2: ("one topic lost", "silent; CAN_ONLY: hold, stop, silent", "A + T + 20 ms"),
    3: ("all topics lost", "silent, reason PARTITION", "A + T + 20 ms"),
    4: ("delay", "warned of; beyond A refused as DELAYED, silent", "A + T + 20 ms"),
    5: ("jitter and bursts", "the newest counts, the rest is counted", "1 tick"),
    6: ("duplicates", "no bit of a command changes; no sign of life", "0"),
    7: ("reordering", "older ones dropped and counted", "0"),
    8: ("backlog after a stall", "the newest counts; a stalled island begins anew", "1 tick"),
    9: ("frozen odometry, fresh stamps", "refused as FROZEN, silent", "A + T + 45 ms"),
    10: ("frozen stamp", "refused, silent", "A + T + 20 ms"),
    11: ("dead planner", "silent, memory flat", "0.9 s + T + 80 ms"),
    12: (
        "operation mode silent; its writer gone",
        "stays; READY, still armed (CAN_ONLY: hold, stop, silent)",
        "1 tick, lease 1 s",
    ),
    13: ("any order of starts", "READY with the full set only", "1 tick"),
    14: ("truncated bytes", "refused", "0"),
    15: ("flipped bits", "refused, or finite and in range", "0"),
    16: ("length 2^32 - 1", "refused, no memory", "0"),
    17: ("fragment missing", "the sample is a lost one", "A + T + 20 ms"),
    18: ("another type on the topic", "no match, logged", "discovery"),
    19: ("other encapsulation", "big endian read, others refused", "0"),
    20: ("NaN or Inf in a used field", "refused, no trace left", "1 tick"),
    21: ("huge or subnormal number", "refused; the zero that it is", "1 tick"),
    22: ("no unit quaternion", "refused beyond 1 %", "1 tick"),
    23: ("foreign frame", "refused", "1 tick"),
    24: ("empty trajectory", "no command", "1 tick"),
    25: ("one or two points", "the old path until A, then silent", "A + T + 20 ms"),
    26: ("up to a million points", "refused, the tick in time", "T"),
    27: ("coincident points", "one is left; no bit of a command changes", "1 tick"),
    28: ("points in both directions, loops, reverse", "refused; driven; driven", "1 tick"),
    29: ("path out of reach", "steering held and braking, then silent", "0.5 s + 2 T"),
    30: ("path that jumps", "steering within its rate", "rate limit"),
    31: ("speed zero, signs mixed", "brakes; refused", "1 tick"),
    32: ("wall clock back 1 h", "no missed tick, nothing stale; warned of", "0"),
    33: ("wall clock forward 1 h", "no missed tick, nothing stale; warned of", "0"),
    34: ("skewed sender", "no bit of a command changes; warned of", "0"),
    35: ("stamp that is no time", "refused", "1 tick"),
    36: ("wrap of counters and stamps on CAN", "accepted by the receiver", "0"),
    37: ("sleep of the machine", "begins anew, not armed in motion", "1 tick"),
    38: ("infeasible problem", "steering held, told", "1 tick"),
    39: ("iteration limit, slow solver", "held, then silent; STALE", "0.5 s + 2 T"),
    40: ("solution NaN or Inf", "discarded", "1 tick"),
    41: ("singular problem", "held, then silent", "0.5 s + 2 T"),
    42: ("wrong solution", "discarded", "1 tick"),
    43: ("one overrun", "skipped, counted", "T"),
    44: ("repeated overruns", "degraded after 3 ticks, silent after 3 more", "3 + 3 ticks"),
    45: ("starved of the processor", "as 44; recovers", "3 + 3 ticks"),
    46: ("hog of the interpreter", "goes on", "-"),
    47: ("garbage collector", "never in a tick", "-"),
    48: ("growth of memory", "none", "-"),
    49: ("no memory", "the process ends, exit code 70", "T"),
    50: ("no descriptors", "other outputs go on; silent without any", "3 ticks"),
    51: (
        "exception anywhere",
        "no command that tick, silent after 3 (CAN_ONLY: hold, stop, silent)",
        "3 ticks",
    ),
    67: ("unknown, missing or misspelt key", "exit code 2, file and line", "start"),
    68: ("value out of range, NaN, wrong type", "exit code 2, file and line", "start"),
    69: ("values that do not fit together", "exit code 2, file and line", "start"),
    70: ("changed DBC file", "refused", "start"),
    71: ("second island", "the newcomer does not arm", "discovery, 1 s"),
    72: ("second publisher of an input", "first kept and told, or silent", "1 tick"),
    73: ("publisher that flaps", "silent", "1 s"),
    74: ("participant that crashed", "READY, then silent", "A + T + 20 ms"),
    75: ("restart of the bridge", "nothing old counts; its clock may be another", "A"),
    76: ("loop of bridges", "exit code 2, file and line", "start"),
    77: ("mode that toggles", "followed, no output jumps", "1 tick"),
    81: ("latched history delivered again", "the newest by its writer stays in force", "0"),
    82: ("second publisher that floods", "the owner is heard, no cost to a tick", "1 tick"),
    83: ("publisher of weaker QoS joins behind the bridge", "those who were heard are heard", "0"),
    84: ("publisher gone behind the bridge", "as on the island's own domain", "lease 1 s"),
    85: (
        "command from before a silence",
        "no late reader receives it, on either domain",
        "lease 1 s",
    ),
    86: ("rogue command behind the island", "not forwarded, alarm", "1 sample"),
    87: ("sender's clock set by less than the limit", "goes on; no delay is remembered", "0"),
    88: ("sender's clock at rate 0.5 to 2", "goes on; warned of (CLOCK_RATE)", "-"),
    89: ("datagram from another host", "not received", "0"),
    90: (
        "lock that is held, files and links of another user",
        "own folder, one line; never another's file",
        "start",
    ),
    91: (
        "told to end, or the planned end, with CAN alone",
        "hold, declared stop, then exit code 0; a lost reader of its output ends nothing",
        "the ramp",
    ),
    92: (
        "points on top of each other and noise, at rest",
        "cleaned, goes on; never latched at rest",
        "1 tick",
    ),
    93: ("point beside another, its yaw wrong", "replaced, warned of; no swing", "1 tick"),
    94: (
        "second CAN master while the island does not drive",
        "alarm, silent, does not arm until a second without its frames",
        "1 tick",
    ),
    95: (
        "hogs of every core at 30 ms",
        "no tick missed where real-time rights are granted; said at the start where not",
        "T",
    ),
    96: ("interface down, made again, address new", "said; found again", "3 s"),
}


def by_row() -> dict[int, list[str]]:
    """Return row -> its tests, each as a path and a name."""
    found: dict[int, list[str]] = defaultdict(list)
    for path in (*sorted(Path(__file__).parent.glob("test_*.py")), *ELSEWHERE):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_row_"):
                for row in re.findall(r"row_(\d\d)", node.name):
                    found[int(row)].append(f"{path.relative_to(ROOT)}::{node.name}")
    return found


def page() -> str:
    """Return the page."""
    tests = by_row()
    lines = []
    for row in ROWS:
        names = "<br>".join(f"`{name.removeprefix('tests/')}`" for name in tests[row])
        fault, reaction, bound = FAULTS[row]
        lines.append(f"| {row} | {fault} | {reaction} | {bound} | {names} |\n")
    return HEAD + "".join(lines)


if __name__ == "__main__":
    PAGE.write_text(page())
