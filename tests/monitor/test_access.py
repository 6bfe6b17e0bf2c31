# SPDX-License-Identifier: Apache-2.0
"""Foreign names, foreign pages and wrong tokens are refused."""

from __future__ import annotations

import pytest

from safety_island.monitor.access import holds, is_loopback, is_own_host, is_own_origin


@pytest.mark.parametrize("address", ["127.0.0.1", "127.8.8.8", "::1", "localhost"])
def test_loopback_is_this_machine(address: str) -> None:
    assert is_loopback(address)


@pytest.mark.parametrize("address", ["0.0.0.0", "::", "192.168.1.4", "example.org", ""])
def test_all_else_is_not(address: str) -> None:
    assert not is_loopback(address)


@pytest.mark.parametrize("host", ["127.0.0.1:8140", "localhost:8140", "[::1]:8140"])
def test_own_names(host: str) -> None:
    assert is_own_host(host, 8140, loopback=True)


@pytest.mark.parametrize(
    "host",
    (
        "attacker.example:8140",
        "localhost.attacker.example:8140",
        "127.0.0.1:81",
        "127.0.0.1",
        "192.168.1.4:8140",
        "127.0.0.1:x",
        "[::1:8140",
        "",
        None,
    ),
)
def test_a_name_that_was_made_to_point_here_is_refused(host: str | None) -> None:
    assert not is_own_host(host, 8140, loopback=True)


def test_bound_elsewhere_an_address_will_do_but_no_name() -> None:
    assert is_own_host("192.168.1.4:8140", 8140, loopback=False)
    assert not is_own_host("attacker.example:8140", 8140, loopback=False)
    assert not is_own_host("192.168.1.4:81", 8140, loopback=False)


def test_a_web_socket_comes_from_our_own_page() -> None:
    assert is_own_origin("http://127.0.0.1:8140", "127.0.0.1:8140")
    assert is_own_origin(None, "127.0.0.1:8140")
    for origin in ("http://attacker.example", "https://127.0.0.1:8140", "null", ""):
        assert not is_own_origin(origin, "127.0.0.1:8140")


def test_token() -> None:
    assert holds("abc", "abc")
    for given in ("abd", "", None, 7, ["abc"]):
        assert not holds(given, "abc")
    assert not holds("", ""), "without a token nobody has it"
