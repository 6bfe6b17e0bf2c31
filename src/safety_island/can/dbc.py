# SPDX-License-Identifier: Apache-2.0
"""The DBC file, made from the table of frames."""

from __future__ import annotations

from decimal import Decimal

from safety_island.command.frames import FRAME_BYTES, FRAMES, Frame, Signal

SENDER = "SafetyIsland"
RECEIVER = "Vehicle"


def _number(value: Decimal) -> str:
    return f"{value:f}"


def signal_limits(signal: Signal) -> tuple[Decimal, Decimal]:
    """Return the lowest and the highest physical value."""
    return Decimal(signal.lowest) / signal.scale, Decimal(signal.highest) / signal.scale


def _signal_line(signal: Signal) -> str:
    sign = "-" if signal.signed else "+"
    factor = _number(Decimal(1) / signal.scale)
    low, high = map(_number, signal_limits(signal))
    return (
        f" SG_ {signal.name} : {signal.start_bit}|{signal.bits}@1{sign} ({factor},0) "
        f'[{low}|{high}] "{signal.unit}" {RECEIVER}'
    )


def _frame_lines(frame: Frame) -> list[str]:
    head = f"BO_ {frame.arbitration_id} {frame.name}: {FRAME_BYTES} {SENDER}"
    return [head, *(_signal_line(signal) for signal in frame.signals), ""]


def _comment_lines(frame: Frame) -> list[str]:
    about = [f'CM_ BO_ {frame.arbitration_id} "{frame.meaning}";']
    about += [f'CM_ SG_ {frame.arbitration_id} {s.name} "{s.meaning}";' for s in frame.signals]
    return about


def _choice_lines(frame: Frame) -> list[str]:
    lines = []
    for signal in frame.signals:
        if signal.choices:
            choices = " ".join(f'{number} "{name}"' for number, name in signal.choices)
            lines.append(f"VAL_ {frame.arbitration_id} {signal.name} {choices} ;")
    return lines


def dbc_text() -> str:
    """Return the content of ``config/can/safety_island.dbc``."""
    lines = ['VERSION ""', "", "NS_ :", "", "BS_:", "", f"BU_: {SENDER} {RECEIVER}", ""]
    for frame in FRAMES:
        lines += _frame_lines(frame)
    lines.append('CM_ "Command frames of the safety island; made by: island can dbc";')
    for frame in FRAMES:
        lines += _comment_lines(frame)
    for frame in FRAMES:
        lines += _choice_lines(frame)
    return "\n".join(lines) + "\n"
