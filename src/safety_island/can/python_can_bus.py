# SPDX-License-Identifier: Apache-2.0
"""Opens and closes a bus of python-can; its errors become one line."""

from __future__ import annotations

import importlib
import inspect
import logging
import os
import termios
from contextlib import suppress
from typing import Any

import can
from can.interfaces import BACKENDS as INTERFACES

from safety_island.can.bus_errors import reason_of
from safety_island.can.candump import LogEntry
from safety_island.can.spec import BusSpec
from safety_island.platform.interfaces import CanError, CanFrame

# The island tells an error in its own words; python-can's log would tell it once more.
logging.getLogger("can").addHandler(logging.NullHandler())

_NEEDS_CHANNEL = ("slcan", "socketcan")
_HINTS = {
    "slcan": "is the adapter plugged in, and may this user open it?",
    "socketcan": "'ip -details link show type can' lists the interfaces of this machine",
}


def check_spec(spec: BusSpec, example: str) -> None:
    """Raise ConfigurationError for a missing channel or an option that the driver lacks."""
    if spec.backend in _NEEDS_CHANNEL:
        spec.require_channel(example)
    if spec.options:
        spec.refuse_options(_option_names(spec) - {"self", "channel", "args", "kwargs"})


def _option_names(spec: BusSpec) -> set[str]:
    module, name = INTERFACES[spec.backend]
    try:
        driver = getattr(importlib.import_module(module), name)
    except Exception:  # a driver may raise anything while it looks for its library; open() tells
        return set(spec.options)
    constructors = (base.__init__ for base in driver.__mro__ if "__init__" in vars(base))
    return {key for make in constructors for key in inspect.signature(make).parameters}


def open_bus(spec: BusSpec, **defaults: Any) -> can.BusABC:
    """Return the open bus; ``defaults`` are options that the specification may override.

    Configuration files and variables of python-can are not read: what runs is what was said.
    Raises CanError.
    """
    channel = int(spec.channel) if spec.channel.isdigit() else spec.channel or None
    try:
        return can.Bus(
            channel=channel,
            interface=spec.backend,
            ignore_config=True,
            **{**defaults, **spec.options},
        )
    except Exception as error:  # each driver has exceptions of its own
        hint = _HINTS.get(spec.backend, "see the python-can documentation of this interface")
        raise CanError(f"CAN bus '{spec}' cannot be opened: {reason_of(error)}; {hint}") from error


def discard_output(bus: can.BusABC, spec: BusSpec) -> None:
    """Throw away what waits to be sent, as far as the driver and the serial line can."""
    with suppress(Exception):  # NotImplementedError for most, anything for a dead device
        bus.flush_tx_buffer()
    with suppress(Exception):
        descriptor = bus.fileno()
        if os.isatty(descriptor):
            termios.tcflush(descriptor, termios.TCOFLUSH)
            if spec.backend == "slcan":
                os.write(descriptor, b"\r")  # ends the line that was perhaps cut


def close_bus(bus: can.BusABC) -> None:
    """Close a bus, whatever state it is in."""
    with suppress(Exception):  # a device that is gone cannot be told goodbye
        bus.shutdown()


def next_entry(bus: can.BusABC, spec: BusSpec, wait_s: float) -> LogEntry | None:
    """Return the next frame of a bus, None when none comes in time. Raises CanError."""
    try:
        message = bus.recv(timeout=wait_s)
    except Exception as error:  # each driver has exceptions of its own
        raise CanError(f"CAN bus '{spec}' cannot be read: {reason_of(error)}") from error
    return entry_of(message) if message else None


def entry_of(message: can.Message) -> LogEntry:
    """Return a message of python-can as an entry of a log."""
    channel = "" if message.channel is None else str(message.channel)
    if message.is_error_frame:
        return LogEntry(message.timestamp, None, True, channel)
    if message.is_extended_id or message.is_remote_frame or message.is_fd:
        return LogEntry(message.timestamp, None, False, channel)
    frame = CanFrame(message.arbitration_id, bytes(message.data))
    return LogEntry(message.timestamp, frame, False, channel)
