# SPDX-License-Identifier: Apache-2.0
"""What the monitor found, as text and as plain values for JSON."""

from __future__ import annotations

from typing import Any

from safety_island.can.decoder import Decoded
from safety_island.can.monitor import Arrivals, BusMonitor, Seen
from safety_island.command.frames import FRAMES, LATERAL, LONGITUDINAL, STATUS, Signal

_VALUES = LATERAL.signals + LONGITUDINAL.signals
_FLAGS = {
    "steering_tire_rotation_rate": "is_defined_steering_tire_rotation_rate",
    "acceleration": "is_defined_acceleration",
}
_TIMESTAMP_UNIT = next(signal.unit for signal in STATUS.signals if signal.name == "timestamp")


def _is_defined(signal: Signal, decoded: Decoded) -> bool:
    flag = _FLAGS.get(signal.name)
    return flag is None or bool(getattr(decoded.command, flag))


def _value(signal: Signal, decoded: Decoded) -> float:
    return float(getattr(decoded.command, signal.name))


def command_text(seen: Seen) -> str:
    """Return one command in one line, with units; a value that is not defined says so."""
    parts = [f"{seen.time_s:.6f}", f"#{seen.decoded.sequence}"]
    for signal in _VALUES:
        if _is_defined(signal, seen.decoded):
            digits = len(str(signal.scale)) - 1
            shown = f"{_value(signal, seen.decoded):.{digits}f} {signal.unit}"
        else:
            shown = "undefined"
        parts.append(f"{signal.name} {shown}")
    parts.append(f"{seen.decoded.mode.name} stamp {seen.decoded.timestamp_ms} {_TIMESTAMP_UNIT}")
    return "  ".join(parts)


def command_values(seen: Seen) -> dict[str, Any]:
    """Return one command as plain values."""
    decoded = seen.decoded
    values: dict[str, Any] = {
        "time_s": seen.time_s,
        "sequence": decoded.sequence,
        "mode": decoded.mode.name,
        "timestamp_ms": decoded.timestamp_ms,
        "lag_ms": seen.lag_ms,
        "is_defined_jerk": decoded.command.is_defined_jerk,
    }
    for signal in _VALUES:
        values[signal.name] = {
            "value": _value(signal, decoded),
            "unit": signal.unit,
            "defined": _is_defined(signal, decoded),
        }
    return values


def _arrivals_values(arrivals: Arrivals, now_s: float) -> dict[str, Any]:
    return {
        "count": arrivals.count,
        "rate_hz": arrivals.rate_hz,
        "longest_gap_s": arrivals.longest_gap_s,
        "age_s": arrivals.age_s(now_s),
    }


def summary_values(monitor: BusMonitor, now_s: float) -> dict[str, Any]:
    """Return everything that was found as plain values; ``now_s`` is what ages count from."""
    sequence = monitor.sequence
    return {
        "frames": {
            f"0x{row.arbitration_id:03X}": {"name": row.name}
            | _arrivals_values(monitor.frames[row.arbitration_id], now_s)
            for row in FRAMES
        },
        "commands": _arrivals_values(monitor.commands, now_s)
        | {
            "losses": monitor.losses.count(now_s),
            "link": str(monitor.losses.link(now_s)),
            "period_s": monitor.losses.period_s,
        },
        "alarm": monitor.alarm(now_s) or None,
        "sequence": {
            "gaps": sequence.gaps,
            "missing": sequence.missing,
            "repeated": sequence.repeated,
            "backward": sequence.backward,
        },
        "incomplete": {str(fault): count for fault, count in sorted(monitor.faults.items())},
        "other_frames": monitor.other_frames,
        "error_frames": monitor.error_frames,
        "latest": command_values(monitor.latest) if monitor.latest else None,
    }


def _arrivals_text(arrivals: Arrivals, now_s: float) -> str:
    rate, age = arrivals.rate_hz, arrivals.age_s(now_s)
    return "  ".join(
        (
            f"{arrivals.count:>8}",
            f"{rate:8.2f} Hz" if rate is not None else f"{'-':>8} Hz",
            f"longest gap {arrivals.longest_gap_s:7.3f} s",
            f"age {age:7.3f} s" if age is not None else "age       - s",
        )
    )


def summary_lines(monitor: BusMonitor, now_s: float) -> list[str]:
    """Return everything that was found as lines of text; ``now_s`` is what ages count from."""
    lines = [
        f"0x{row.arbitration_id:03X} {row.name:<20} "
        f"{_arrivals_text(monitor.frames[row.arbitration_id], now_s)}"
        for row in FRAMES
    ]
    lines.append(f"{'complete commands':<26} {_arrivals_text(monitor.commands, now_s)}")
    s = monitor.sequence
    lines.append(
        f"sequence: {s.gaps} gaps, {s.missing} commands missing, {s.repeated} repeated, "
        f"{s.backward} backward; {monitor.losses.count(now_s)} losses of three periods"
    )
    if monitor.faults:
        found = (f"{count} {fault.replace('_', ' ')}" for fault, count in monitor.faults.items())
        lines.append(f"not complete: {', '.join(found)}")
    lines.append(f"other frames: {monitor.other_frames}, error frames: {monitor.error_frames}")
    if alarm := monitor.alarm(now_s):
        lines.append(alarm)
    return lines
