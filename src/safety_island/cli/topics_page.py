# SPDX-License-Identifier: Apache-2.0
"""Writes docs/topics.md from the table of topics: ``python -m safety_island.cli.topics_page``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from safety_island.control.input_check import (
    MAX_ACCELERATION,
    MAX_BACKTRACK,
    MAX_POSITION,
    MAX_SPEED,
    MAX_SQUARE_NORM,
    MAX_TURN,
    MIN_SQUARE_NORM,
    NEAR,
    STANDSTILL,
)
from safety_island.control.limits import MAX_POINTS
from safety_island.control.point_list import SAME_PLACE
from safety_island.control.release import RELEASES
from safety_island.control.trajectory_clean import MAX_YAW_OFF, REACH
from safety_island.dds.names import dds_topic_name
from safety_island.dds.topics import DEBUG, OWN, STEERING_OFFSET, TOPICS, TopicEntry, of_release
from safety_island.messages.registry import dds_type_name
from safety_island.params import load_set
from safety_island.params.schema import values_of

PAGE = "docs/topics.md"

INTRODUCTION = """\
# Topics

Generated from the one table in `src/safety_island/dds/topics.py`, which also makes the
publishers and subscriptions. To renew this page: `python -m safety_island.cli.topics_page`.

The island talks plain DDS and appears in `ros2 node list` as a node. On the wire a ROS topic
`/a/b` is the DDS topic `rt/a/b`, a ROS type `pkg/msg/Name` is the DDS type
`pkg::msg::dds_::Name_`, and a message is plain CDR (XCDR1, little endian).

All endpoints are reliable. The island takes the newest sample of each input at each tick and counts
what it passes over. The rates of the inputs are those of Autoware's planning simulator. An input
that is older than its limit ends the output; the limits are the parameters `gate.age_limit`, here
with their default values. The operation mode has none: its publisher must live.
"""

OWN_TOPICS = """\
## The island's own

Beyond what Autoware has, on the island's domain and not bridged. The [status](status.md) tells what
the island does and why: `island status` shows it. A request to arm asks it to leave SILENT, and the
status answers: `island arm` sends one. Both types stand as `.msg` files in
`src/safety_island/messages/msg`.
"""


NEWER = """\
## Names of newer releases

With the rules of a newer Autoware (`autoware_release`, see [parameters](parameters.md)) the island
uses that release's names. The offset of the steering sensor is an input of its own since 0.51: the
island subscribes to it when `steering_offset.enable_auto_steering_offset_removal` is true, no tick
waits for it, and a value that is not finite or beyond `steering_offset.input_limit` is refused.
"""

DEBUG_TOPICS = """\
## Debug topics

What Autoware's own tools and RViz look at, under the names of its standard launch, so that they
show the island as they show the original. `island run --debug-topics` publishes them; else none is
made, and a tick does nothing for them. They stay on the island's domain: point a tool at it
(`ROS_DOMAIN_ID=2 rviz2`), or name the topics in a [bridge file](../README.md).

Until 0.40 the types of `autoware_internal_debug_msgs` are those of `tier4_debug_msgs`. All messages
of a tick carry one stamp. They are published when the controllers have run, also when the guard or
the life cycle lets no command out; the diagnostics always.

| topic | what it holds |
| --- | --- |
| horizon | The MPC's commands, one each `time_step_ms`, before the steering offset is taken off, \
each with the one speed and acceleration. None when the MPC found no solution. |
| predicted trajectory | Where they lead, from the end of the input delay on, no longer than the \
reference. Times since 0.47, wheel angles since 0.48; empty when the MPC found no solution. |
| lateral diagnostic | 21 numbers in Autoware's order, since 0.53 27 (temporal mode; NaN in the \
spatial one). The duration of the solver alone is not measured: NaN. |
| longitudinal diagnostic | 34 numbers, since 0.41 37, since 0.53 43. A number keeps its old value \
where a tick does not set it, and is NaN before the first time, where Autoware's is uninitialised. |
| slope, steering offset | The slope in use and the offset in force [rad]. |
| diagnostics | `control_state` (an error in EMERGENCY only), `MPC_solve_checker`, and since 0.51 \
`cyclic_message_timeout` (an error when the trajectory is older than \
`cyclic_message_timeout_thr_sec`); each with `controller_node_exe: ` in front. |
"""

_NORMS = f"{MIN_SQUARE_NORM**0.5:g} to {MAX_SQUARE_NORM**0.5:g}"

BOUNDS = f"""\
## Bounds of the inputs

What is beyond them, or no number, is refused as `OUT_OF_RANGE`, `NOT_FINITE` or `BAD_QUATERNION`,
and leaves the controllers as they were ([status](status.md) counts by reason). They are wide: they
keep out what is no measurement, and the squares and sums of the rest finite.

| fields | bound | unit | source |
| --- | --- | --- | --- |
| positions (x, y, z) | {MAX_POSITION:.0f} | m | a UTM northing stays below it |
| speeds | {MAX_SPEED:g} | m/s | no road vehicle of series reaches it |
| accelerations | {MAX_ACCELERATION:g} | m/s² | ten times what tyres can do |
| angles of tyres, turn rates | {MAX_TURN:g} | rad, rad/s | sixteen turns; no vehicle does |
| norm of an orientation | {_NORMS} | 1 | rounding leaves far less |
| points of a trajectory | {MAX_POINTS} at most | 1 | the memory of the island |
| length to and fro | {MAX_BACKTRACK:g} | m | rounding of a planner's points |
| speeds of both signs | {STANDSTILL:g} | m/s | below it, a point has no direction |
| operation mode | 0 to 255 | 1 | one byte on the wire |

## What is cleaned

Planners send trajectories whose points have flaws that the path has not. These are put right before
the controllers see them; a trajectory without them is not touched, not in one bit.

| flaw | bound | what is done |
| --- | --- | --- |
| points on top of each other | {SAME_PLACE:g} m in x and y | one is left, with the slowest speed |
| a point beside the one before, not ahead of it | {NEAR:g} m | dropped; its speed stays if slower |
| an orientation against the path before and behind | {MAX_YAW_OFF:g} rad | that of the path, \
`YAW_REPLACED` |
| stop points all at the place where the vehicle stands | {REACH:g} m | a path there, speed zero |

The path's direction is that over {REACH:g} m, so noise of some millimetres does not count. When
half of the orientations or more contradict the path, or it turns by more than a right angle in one
point, none is replaced. Points at one place are refused (`COINCIDENT_POINTS`) while the vehicle
moves or is elsewhere, or when they are no stop points.
"""


def render() -> str:
    """Return the page."""
    names = "\n".join(
        f"| `{entry.name}` | `{dds_topic_name(entry.name)}` | `{dds_type_name(entry.type_name)}` |"
        for entry in (*TOPICS, *OWN)
    )
    return (
        f"{INTRODUCTION}\n{_table(TOPICS)}\n\n"
        f"{OWN_TOPICS}\n{_table(OWN)}\n\n"
        f"{NEWER}\n{_newer_names()}\n\n"
        f"{DEBUG_TOPICS}\n{_debug_names()}\n\n"
        f"{BOUNDS}\n"
        "## As DDS tools show them\n\n"
        f"| ROS topic | DDS topic | DDS type |\n| --- | --- | --- |\n{names}\n"
    )


def _newer_names() -> str:
    """Return the table of topics that a release named anew, and of the one that it added."""
    rows = ["| since | topic and type | instead of |", "| --- | --- | --- |"]
    for entry in TOPICS:
        for since, name, kind in entry.newer:
            rows.append(
                f"| {since} | `{name}`<br>`{kind}` | `{entry.name}`<br>`{entry.type_name}` |"
            )
    offset = STEERING_OFFSET
    rows.append(f"| 0.51 | `{offset.name}`<br>`{offset.type_name}` | new |")
    return "\n".join(rows)


def _debug_names() -> str:
    """Return the table of the debug topics, as the newest release has them."""
    rows = ["| topic | type |", "| --- | --- |"]
    for entry in of_release(DEBUG, RELEASES[-1]):
        rows.append(f"| `{entry.name}` | `{entry.type_name}` |")
    return "\n".join(rows)


def _table(entries: Sequence[TopicEntry]) -> str:
    head = ["direction", "topic and type", "durability", "rate", "age limit", "bridged (domains)"]
    rows = [head, ["---"] * len(head), *(_row(entry) for entry in entries)]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _row(entry: TopicEntry) -> list[str]:
    return [
        entry.direction.value,
        f"`{entry.name}`<br>`{entry.type_name}`",
        entry.qos.durability.replace("_", " "),
        _rate(entry.rate_hz),
        _age(entry.age_limit),
        "no" if entry.bridged is None else f"{entry.bridged[0]} → {entry.bridged[1]}",
    ]


def _age(parameter: str) -> str:
    """The default value; the parameter is named after the input."""
    return f"{values_of(load_set('default'))[parameter]:g} s" if parameter else "none"


def _rate(rate_hz: float | None) -> str:
    if rate_hz is None:
        return "on change"
    return f"{rate_hz:g} Hz" if rate_hz else "every tick"


def main(arguments: Sequence[str]) -> None:
    """Write the page to the path given, or to where it belongs below the working directory."""
    path = Path(arguments[0] if arguments else PAGE)
    path.write_text(render(), "utf-8")
    print(f"wrote {path}")


if __name__ == "__main__":
    main(sys.argv[1:])
