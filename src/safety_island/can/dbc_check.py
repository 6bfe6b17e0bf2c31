# SPDX-License-Identifier: Apache-2.0
"""Checks a DBC file against the encoder: field by field, and by decoding what it encoded."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from typing import Any, cast

from safety_island.can.command import Command
from safety_island.can.dbc import signal_limits
from safety_island.can.decoder import decode_frame
from safety_island.can.encoder import Triple, encode
from safety_island.command.frames import FRAME_BYTES, FRAMES, Frame, Signal
from safety_island.command.mode import OutputMode
from safety_island.platform.interfaces import CanFrame

_SAMPLES = (
    Command(0.125, -0.5, 12.25, -1.5, 0.0, True, True, False),
    Command(-2147.483648, 2147.483647, -2147483.648, 2147483.647, 1.0, False, True, True),
    Command(1e-6, -1e-6, 1e-3, -1e-3, 0.0, True, False, False),
)
_STAMPS_NS = (12_345_000_000, 4_294_967_295_000_000, 1_000_000)


def check_dbc(text: str) -> list[str]:
    """Return every difference between a DBC file and the frames, each in one line.

    No difference, no line. A file that cantools refuses (overlapping signals, a signal outside its
    frame, wrong syntax) is one difference.
    """
    import cantools

    logging.getLogger("cantools").addHandler(logging.NullHandler())  # it logs what we return
    try:
        database: Any = cantools.database.load_string(text, database_format="dbc", strict=True)
    except Exception as error:  # cantools and its parser have many exceptions
        return [f"not a valid DBC file: {' '.join(str(error).split())}"]
    try:
        differences = [line for row in FRAMES for line in _frame_differences(database, row)]
        return differences or list(_round_trip_differences(database))
    except OverflowError as error:
        return [f"not a valid DBC file: {error}"]


def _frame_differences(database: Any, frame: Frame) -> Iterator[str]:
    where = f"0x{frame.arbitration_id:03X}"
    found = [m for m in database.messages if m.frame_id == frame.arbitration_id]
    if len(found) != 1:
        yield f"{where} {frame.name}: {len(found)} messages have this identifier, expected 1"
        return
    message = found[0]
    yield from _fields(
        where,
        ("name", message.name, frame.name),
        ("length", message.length, FRAME_BYTES),
        ("extended identifier", message.is_extended_frame, False),
    )
    signals = {signal.name: signal for signal in message.signals}
    for signal in frame.signals:
        if signal.name in signals:
            yield from _signal_differences(f"{where} {signal.name}", signals[signal.name], signal)
        else:
            yield f"{where} {signal.name}: is missing"
    for name in sorted(signals.keys() - {signal.name for signal in frame.signals}):
        yield f"{where} {name}: no signal of this name exists"


def _signal_differences(where: str, found: Any, signal: Signal) -> Iterator[str]:
    low, high = map(float, signal_limits(signal))
    choices = {number: str(name) for number, name in (found.choices or {}).items()}
    yield from _fields(
        where,
        ("start bit", found.start, signal.start_bit),
        ("length", found.length, signal.bits),
        ("byte order", found.byte_order, "little_endian"),
        ("signed", found.is_signed, signal.signed),
        ("factor", float(found.scale), 1 / signal.scale),
        ("offset", float(found.offset), 0.0),
        ("minimum", _float(found.minimum), low),
        ("maximum", _float(found.maximum), high),
        ("unit", found.unit or "", signal.unit),
        ("names of values", choices, dict(signal.choices)),
        ("multiplexing", found.is_multiplexer or bool(found.multiplexer_ids), False),
    )


def _float(value: Any) -> float | None:
    return None if value is None else float(value)


def _fields(where: str, *fields: tuple[str, object, object]) -> Iterator[str]:
    for name, found, expected in fields:
        if found != expected:
            yield f"{where}: {name} is {found}, expected {expected}"


def _round_trip_differences(database: Any) -> Iterator[str]:
    for number, (command, stamp_ns) in enumerate(zip(_SAMPLES, _STAMPS_NS, strict=True)):
        # The samples can be encoded: a test says so.
        frames = cast(Triple, encode(command, OutputMode.DDS_AND_CAN, 65535 - number, stamp_ns))
        for row, frame in zip(FRAMES, frames, strict=True):
            yield from _frame_round_trip(database, row, frame)


def _frame_round_trip(database: Any, row: Frame, frame: CanFrame) -> Iterator[str]:
    where = f"0x{row.arbitration_id:03X}"
    found = database.decode_message(frame.arbitration_id, frame.data, decode_choices=False)
    for name, value in decode_frame(row, frame.data).items():
        if abs(float(found[name]) - value) > 1e-9 * max(1.0, abs(value)):
            yield f"{where} {name}: decodes to {found[name]}, expected {value}"
    if database.encode_message(frame.arbitration_id, found) != frame.data:
        yield f"{where}: encodes other bytes than the encoder"
