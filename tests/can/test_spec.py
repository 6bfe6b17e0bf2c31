# SPDX-License-Identifier: Apache-2.0
"""What ``--can`` takes."""

from __future__ import annotations

import pytest

from safety_island.can.spec import BusSpec, parse_spec
from safety_island.errors import ConfigurationError


@pytest.mark.parametrize(
    ("text", "spec"),
    [
        ("mock", BusSpec("mock")),
        ("socketcan:can0", BusSpec("socketcan", "can0")),
        ("virtual", BusSpec("virtual")),
        (
            "slcan:/dev/ttyACM0@115200,bitrate=500000,rtscts=true,sleep_after_open=0.5",
            BusSpec(
                "slcan",
                "/dev/ttyACM0@115200",
                {"bitrate": 500000, "rtscts": True, "sleep_after_open": 0.5},
            ),
        ),
        ("udp_multicast:ff15::1,port=4000", BusSpec("udp_multicast", "ff15::1", {"port": 4000})),
        ("pcan:PCAN_USBBUS1,name=a=b", BusSpec("pcan", "PCAN_USBBUS1", {"name": "a=b"})),
    ],
)
def test_what_is_read(text: str, spec: BusSpec) -> None:
    assert parse_spec(text) == spec
    assert parse_spec(str(spec)) == spec


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"--can '': expected BACKEND\[:CHANNEL\]"),
        (":can0", "expected BACKEND"),
        ("slcan:x,bitrate", "found 'bitrate', expected KEY=VALUE"),
        ("slcan:x,=1", "found '=1', expected KEY=VALUE"),
        ("slcan:x,", "found '', expected KEY=VALUE"),
    ],
)
def test_what_is_refused(text: str, message: str) -> None:
    with pytest.raises(ConfigurationError, match=message) as caught:
        parse_spec(text)
    assert caught.value.exit_code == 2


def test_channels_and_options_that_a_backend_lacks() -> None:
    with pytest.raises(ConfigurationError, match="backend 'mock' has no channel, found 'x'"):
        BusSpec("mock", "x").refuse_channel()
    with pytest.raises(
        ConfigurationError, match=r"channel is missing, expected .* 'socketcan:can0"
    ):
        BusSpec("socketcan").require_channel("socketcan:can0")
    spec = BusSpec("slcan", "x", {"bitrat": 1})
    with pytest.raises(ConfigurationError, match=r"it has none$"):
        spec.refuse_options(())
    with pytest.raises(ConfigurationError, match="did you mean 'bitrate'"):
        spec.refuse_options({"bitrate", "timeout"})
    spec.refuse_options({"bitrat"})
