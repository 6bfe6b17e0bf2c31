# SPDX-License-Identifier: Apache-2.0
"""The table of backends: what is imported when, names and options that do not exist."""

from __future__ import annotations

import subprocess
import sys
import time

import pytest

from safety_island.can.backends import BACKENDS, find_backend, new_link
from safety_island.can.link import DirectLink
from safety_island.can.mock import MockBus
from safety_island.can.spec import BusSpec, parse_spec
from safety_island.can.thread_link import ThreadLink
from safety_island.errors import ConfigurationError, IslandError
from tests.can.peers import ROOT

USE_MOCK = """
import sys
from safety_island.command.mode import OutputMode
from safety_island.can.spec import parse_spec
from safety_island.can.start import start_output
start_output(OutputMode.CAN_ONLY, parse_spec("mock"), 0.15, lambda: 0, None)
print(sorted({name.split(".")[0] for name in sys.modules} & {"can", "cantools", "serial"}))
"""


def test_the_mock_needs_no_driver() -> None:
    found = subprocess.run(
        [sys.executable, "-c", USE_MOCK],
        env={"PYTHONPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert found.stdout == "[]\n"


def test_the_room_imports_neither_controller_nor_node() -> None:
    for path in (ROOT / "src/safety_island/can").glob("*.py"):
        for room in ("control", "node", "dds", "cli", "bridge"):
            assert f"safety_island.{room}" not in path.read_text(), path


@pytest.mark.parametrize("backend", BACKENDS, ids=lambda backend: backend.name)
def test_each_row_names_a_device(backend: object) -> None:
    row = find_backend(backend.name)  # type: ignore[attr-defined]
    link = new_link(parse_spec(row.example), time.monotonic_ns)
    assert isinstance(link, ThreadLink if row.may_block else DirectLink)


def test_every_interface_of_python_can_is_a_row_that_may_block() -> None:
    row = find_backend("pcan")
    assert row.may_block
    assert isinstance(new_link(BusSpec("pcan", "PCAN_USBBUS1"), time.monotonic_ns), ThreadLink)


def test_an_unknown_backend_is_refused_with_the_list() -> None:
    with pytest.raises(ConfigurationError) as caught:
        find_backend("sockcan")
    text = str(caught.value)
    assert "unknown CAN backend 'sockcan', expected one of " in text
    assert "mock" in text
    assert "pcan" in text
    assert text.endswith("did you mean 'socketcan'?")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("socketcan", "channel is missing"),
        ("slcan", "channel is missing"),
        ("mock:x", "has no channel"),
        ("mock,x=1", "has no option 'x', it has none"),
        ("virtual,rx_queue=3", "did you mean 'rx_queue_size'"),
    ],
)
def test_specifications_that_a_backend_cannot_have(text: str, message: str) -> None:
    with pytest.raises(ConfigurationError, match=message):
        new_link(parse_spec(text), time.monotonic_ns)


@pytest.mark.parametrize(
    "text", ["slcan:/dev/none", "udp_multicast:nonsense!", "pcan:PCAN_USBBUS1"]
)
def test_a_bus_that_cannot_be_opened_is_one_line(text: str) -> None:
    link = new_link(parse_spec(text), time.monotonic_ns)
    with pytest.raises(IslandError) as caught:
        link.open()
    assert str(caught.value).startswith(f"CAN bus '{text}' cannot be opened: ")
    assert "\n" not in str(caught.value)
    link.close()


def test_options_reach_the_driver() -> None:
    link = new_link(parse_spec("virtual:sizes,rx_queue_size=1"), time.monotonic_ns)
    other = new_link(parse_spec("virtual:sizes,rx_queue_size=2"), time.monotonic_ns)
    for opened in (link, other):
        opened.open()
    from tests.can.rig import triple

    delivery = other.send(triple(), 0.01)
    assert (delivery.sent, delivery.result.name) == (1, "TIMED_OUT")
    link.close()
    other.close()


def test_the_mock_says_what_it_does_not_model() -> None:
    text = MockBus.__doc__ or ""
    assert "Not modelled: arbitration, bit rate" in text
