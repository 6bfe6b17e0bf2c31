# SPDX-License-Identifier: Apache-2.0
"""Every key of the JSON lines that the long-running commands print: its type and its one meaning.

Within a command, a key means the same in each event. docs/json.md is made from this table, and a
test compares it with what the commands write.
"""

from __future__ import annotations

from dataclasses import dataclass

NUMBER, INTEGER, TEXT, BOOLEAN, OBJECT = "number", "integer", "text", "boolean", "object"
NUMBERS, TEXTS = "list of numbers", "list of texts"


@dataclass(frozen=True)
class Key:
    """``kind`` is the JSON type; ``may_be_null``: null where there is no value."""

    kind: str
    meaning: str
    may_be_null: bool = False


@dataclass(frozen=True)
class Event:
    """One kind of line: when it comes, its keys, and those that are not in each of them."""

    when: str
    keys: tuple[str, ...]
    sometimes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Lines:
    """The JSON lines of a command."""

    events: dict[str, Event]
    keys: dict[str, Key]


_VEHICLE_KEYS = {
    "acceleration": Key(NUMBER, "of the vehicle, m/s²"),
    "command_age_s": Key(NUMBER, "since the newest command, s", True),
    "commands": Key(INTEGER, "commands received so far"),
    "finished": Key(BOOLEAN, "the last stop was reached"),
    "gate": Key(TEXT, "state of the command gate: `waiting`, `driving`, `braking`"),
    "lap": Key(INTEGER, "laps driven so far"),
    "laps": Key(INTEGER, "laps driven"),
    "lateral_error": Key(NUMBER, "distance from the path now, m, left is +"),
    "left_most": Key(NUMBER, "largest distance to the left after the first 5 s, m"),
    "length": Key(NUMBER, "of the course, m"),
    "max_lateral_error": Key(NUMBER, "largest distance after the first 5 s, m"),
    "on_course": Key(BOOLEAN, "`max_lateral_error` stayed below 0.3 m"),
    "operation_mode": Key(TEXT, "`STOP` or `AUTONOMOUS`"),
    "reached_speed": Key(BOOLEAN, "`top_speed` is at least 95 % of `top_target`"),
    "refused_commands": Key(INTEGER, "commands that were no Control or not finite"),
    "right_most": Key(NUMBER, "largest distance to the right after the first 5 s, m, below zero"),
    "silences": Key(INTEGER, "times that commands stopped coming"),
    "slope": Key(NUMBER, "pitch of the road under the vehicle, rad, uphill is +"),
    "speed": Key(NUMBER, "of the vehicle, m/s"),
    "started": Key(NUMBER, "monotonic time of the first engaged moment, s", True),
    "station": Key(NUMBER, "distance along the course, m"),
    "steering": Key(NUMBER, "tyre angle of the vehicle, rad"),
    "stood_still_s": Key(NUMBER, "time that the process itself stood still, s"),
    "stop_errors": Key(NUMBERS, "distance of each stop from its place, m, beyond it is +"),
    "stop_station": Key(NUMBER, "station of the next stop, m"),
    "stopped_in_place": Key(BOOLEAN, "there was a stop, and each within 0.5 m of its place"),
    "target_speed": Key(NUMBER, "of the course, m/s"),
    "time_s": Key(NUMBER, "since the start of the drive, s"),
    "top_speed": Key(NUMBER, "highest speed, m/s"),
    "top_target": Key(NUMBER, "highest speed that the course asked for, m/s"),
    "x": Key(NUMBER, "of the vehicle, m"),
    "y": Key(NUMBER, "of the vehicle, m"),
    "yaw": Key(NUMBER, "of the vehicle, rad"),
}
_VEHICLE_SUMMARY = (
    "started", "lateral_error", "max_lateral_error", "left_most", "right_most", "top_speed",
    "top_target", "stop_errors", "on_course", "reached_speed", "stopped_in_place", "finished",
    "laps", "commands", "silences", "stood_still_s",
)  # fmt: skip

RUN = Lines(
    {
        "tick": Event(
            "every control period",
            (
                "number",
                "outcome",
                "detail",
                "state",
                "reason",
                "subject",
                "guard",
                "guard_limits",
                "lateness_s",
                "skipped",
                "tick_s",
                "ages_s",
                "refused",
            ),
            (
                "steering_tire_angle",
                "steering_tire_rotation_rate",
                "velocity",
                "acceleration",
                "longitudinal_state",
                "mpc_status",
                "lateral_error",
                "stop_dist",
                "can",
            ),
        ),
        "first_control": Event("once, after the tick that sent the first command", ("after_s",)),
        "vehicle": Event("with `--platform sim`, at the end", _VEHICLE_SUMMARY),
        "summary": Event(
            "at the end",
            (
                "can_counts",
                "ticks",
                "published",
                "missed_ticks",
                "refused_samples",
                "first_control_s",
                "max_lateness_s",
                "tick_times_s",
            ),
        ),
    },
    {name: _VEHICLE_KEYS[name] for name in _VEHICLE_SUMMARY}
    | {
        "acceleration": Key(NUMBER, "commanded, m/s²"),
        "after_s": Key(NUMBER, "from the start of the process to the first command, s"),
        "ages_s": Key(OBJECT, "age of each input by name, s; null: none came"),
        "can": Key(OBJECT, "frames of this tick, decoded as `island can monitor` does", True),
        "can_counts": Key(OBJECT, "output mode, commands and failures on CAN; null without", True),
        "detail": Key(TEXT, "of `outcome`: the input that is missing, what failed; or empty"),
        "guard": Key(
            TEXT, "what the guard did with the command of the tick, see docs/guard.md", True
        ),
        "guard_limits": Key(TEXTS, "limits of the guard that acted on it"),
        "first_control_s": Key(NUMBER, "as `after_s`; null: no command was sent", True),
        "lateness_s": Key(NUMBER, "from when the tick was due to its start, s"),
        "lateral_error": Key(NUMBER, "distance from the path, m"),
        "longitudinal_state": Key(TEXT, "`DRIVE`, `STOPPING`, `STOPPED`, `EMERGENCY`"),
        "max_lateness_s": Key(NUMBER, "largest `lateness_s`, s"),
        "missed_ticks": Key(INTEGER, "sum of `skipped`"),
        "mpc_status": Key(TEXT, "what the MPC came to, see docs/status.md"),
        "number": Key(INTEGER, "of the tick, from 1"),
        "outcome": Key(TEXT, "what the tick came to: `PUBLISHED`, `WAITING_FOR_INPUT`, ..."),
        "published": Key(INTEGER, "ticks that sent a command"),
        "reason": Key(TEXT, "of `state`, see docs/status.md"),
        "refused": Key(INTEGER, "samples that this tick refused"),
        "refused_samples": Key(INTEGER, "sum of `refused`"),
        "subject": Key(TEXT, "input that `reason` is about", True),
        "skipped": Key(INTEGER, "ticks that were missed since the one before"),
        "state": Key(TEXT, "of the life cycle, see docs/status.md"),
        "steering_tire_angle": Key(NUMBER, "commanded, rad"),
        "steering_tire_rotation_rate": Key(NUMBER, "commanded, rad/s"),
        "stop_dist": Key(NUMBER, "distance to the stop point, m"),
        "tick_s": Key(NUMBER, "time that the tick took, s"),
        "tick_times_s": Key(OBJECT, "`median`, `p99` and `max` of `tick_s`; null: no command"),
        "ticks": Key(INTEGER, "ticks that ran"),
        "velocity": Key(NUMBER, "commanded, m/s"),
    },
)

MAIN_COMPUTE = Lines(
    {
        "status": Event(
            "ten times a second",
            (
                "time_s",
                "station",
                "length",
                "lap",
                "stop_station",
                "x",
                "y",
                "yaw",
                "speed",
                "target_speed",
                "acceleration",
                "steering",
                "lateral_error",
                "slope",
                "max_lateral_error",
                "gate",
                "operation_mode",
                "command_age_s",
                "commands",
            ),
        ),
        "summary": Event("at the end", (*_VEHICLE_SUMMARY, "refused_commands")),
    },
    _VEHICLE_KEYS,
)

_COUNTS = ("forwarded", "bytes", "superseded", "foreign", "refused", "failed")
BRIDGE = Lines(
    {
        "counts": Event("once a second, and at the end", (*_COUNTS, "routes_open", "routes")),
        "alarm": Event(
            "when a second publisher of a topic that keeps to one comes or goes",
            ("topic", "from", "to", "kept", "others"),
        ),
        "route": Event(
            "at the end, for each route", ("topic", "from", "to", "out", "open", *_COUNTS)
        ),
    },
    {
        "bytes": Key(INTEGER, "forwarded, in bytes"),
        "failed": Key(INTEGER, "messages that could not be published"),
        "foreign": Key(INTEGER, "messages of publishers that are not forwarded"),
        "forwarded": Key(INTEGER, "messages forwarded"),
        "from": Key(INTEGER, "domain that is read"),
        "kept": Key(TEXTS, "publishers that are forwarded, by GUID"),
        "open": Key(BOOLEAN, "the route forwards"),
        "others": Key(TEXTS, "publishers that are not forwarded, by GUID"),
        "out": Key(TEXT, "topic that is written"),
        "refused": Key(INTEGER, "messages that could not be compressed or restored"),
        "routes": Key(INTEGER, "routes of the files"),
        "routes_open": Key(INTEGER, "routes that forward"),
        "superseded": Key(INTEGER, "messages dropped for newer ones of the same publisher"),
        "to": Key(INTEGER, "domain that is written"),
        "topic": Key(TEXT, "topic that is read"),
    },
)

WHY = Lines(
    {"why": Event("once, with `--why`", ("flows", "free", "held_by", "why"))},
    {
        "flows": Key(BOOLEAN, "commands are sent"),
        "free": Key(BOOLEAN, "the vehicle is free to drive: all is well"),
        "held_by": Key(TEXTS, "what holds the vehicle although commands are sent"),
        "why": Key(TEXT, "the answer in words"),
    },
)

MONITOR = Lines(
    {
        "address": Event("once, when the page is served", ("address", "port")),
        "press": Event("a button of the page, with `--console`", ("key",)),
    },
    {
        "address": Key(TEXT, "of the page, with the token where one is needed"),
        "port": Key(INTEGER, "that is served on"),
        "key": Key(TEXT, "name of the button"),
    },
)

COMMANDS = {
    "island run --json": RUN,
    "island main-compute --json": MAIN_COMPUTE,
    "island bridge --json": BRIDGE,
    "island status --why --json": WHY,
    "island monitor --json": MONITOR,
}
