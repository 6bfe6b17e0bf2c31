# SPDX-License-Identifier: Apache-2.0
"""The CAN backends: a row for each, its module imported when it is chosen."""

from __future__ import annotations

import importlib
from typing import Protocol, cast

from safety_island.can.bus import BusDevice, BusLink, MonotonicNs
from safety_island.can.link import DirectLink
from safety_island.can.spec import Backend, BusSpec
from safety_island.can.thread_link import ThreadLink
from safety_island.errors import ConfigurationError
from safety_island.words import did_you_mean

_PYTHON_CAN = "safety_island.can.python_can"

BACKENDS = (
    Backend("mock", "safety_island.can.mock", False, "mock", "Records frames in memory."),
    Backend(
        "socketcan",
        _PYTHON_CAN,
        False,
        "socketcan:can0",
        "A CAN interface of the Linux kernel (also `vcan0`).",
        kernel_queue=True,
    ),
    Backend(
        "slcan",
        _PYTHON_CAN,
        True,
        "slcan:/dev/ttyACM0,bitrate=500000",
        "A serial adapter that speaks the Lawicel protocol.",
        silent_reads=4,  # the adapter's answers to three frames, and then nothing
    ),
    Backend("virtual", _PYTHON_CAN, False, "virtual:bench", "A bus inside one process, for tests."),
    Backend(
        "udp_multicast",
        _PYTHON_CAN,
        False,
        "udp_multicast:239.74.163.2",
        "A bus between processes or machines over UDP.",
        echoes=True,
    ),
)
"""The backends with properties of their own; every other name of python-can is a row as well."""


class BackendModule(Protocol):
    """What the module of a backend offers."""

    def new_device(self, spec: BusSpec, backend: Backend, clock: MonotonicNs) -> BusDevice:
        """Return the device, not yet open. Raises ConfigurationError."""


def find_backend(name: str) -> Backend:
    """Return the row of a backend. Raises ConfigurationError for an unknown name."""
    for backend in BACKENDS:
        if backend.name == name:
            return backend
    from can import VALID_INTERFACES

    if name in VALID_INTERFACES:
        return Backend(name, _PYTHON_CAN, True, f"{name}:CHANNEL", "Through python-can.")
    names = sorted({*VALID_INTERFACES, *(backend.name for backend in BACKENDS)})
    hint = did_you_mean(name, names)
    raise ConfigurationError(
        f"unknown CAN backend '{name}', expected one of {', '.join(names)}{hint}"
    )


def new_link(spec: BusSpec, clock: MonotonicNs) -> BusLink:
    """Return the way to the bus that a specification names, not yet open.

    ``clock``: monotonic [ns], for the budgets. Raises ConfigurationError.
    """
    backend = find_backend(spec.backend)
    module = cast(BackendModule, importlib.import_module(backend.module))
    device = module.new_device(spec, backend, clock)
    return ThreadLink(device, clock) if backend.may_block else DirectLink(device, clock)
