# SPDX-License-Identifier: Apache-2.0
"""To which publishers a route keeps."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safety_island.bridge.config_file import Keep
from safety_island.bridge.kept import Kept, keep
from safety_island.dds.discovery import RemoteEndpoint
from safety_island.dds.qos import Qos

FIRST = Keep(second="keep_first")
SILENT = Keep(second="silent")


def _endpoint(number: int) -> RemoteEndpoint:
    return RemoteEndpoint(bytes([number] * 16), b"", "/t", "p/msg/T", Qos(), number=number)


A, B, C = (_endpoint(number) for number in (1, 2, 3))
NAMES = {A.guid: "/a", B.guid: "/b/b", C.guid: "/a"}


def _keep(wish: Keep, found: list[RemoteEndpoint], *before: RemoteEndpoint) -> Kept:
    return keep(wish, found, Kept(before), lambda endpoint: NAMES[endpoint.guid])


def test_everybody_is_forwarded_unless_the_file_says_otherwise() -> None:
    assert _keep(Keep(), [A, B]) == Kept((A, B))


def test_the_first_is_kept_to_as_long_as_it_lives() -> None:
    assert _keep(FIRST, []) == Kept()
    assert _keep(FIRST, [A]) == Kept((A,))
    assert _keep(FIRST, [A, B]) == Kept((A,), (B,))
    assert _keep(FIRST, [A, B], B) == Kept((B,), (A,))
    assert _keep(FIRST, [A], B) == Kept((A,))


def test_one_that_left_and_came_back_is_not_the_first_any_more() -> None:
    back = replace(A, number=9)
    assert _keep(FIRST, [B, back], A) == Kept((B,), (back,))


def test_its_changed_qos_is_its_own_affair() -> None:
    changed = replace(B, qos=Qos(deadline_ns=5))
    assert _keep(FIRST, [A, changed], B) == Kept((changed,), (A,))


def test_a_second_publisher_is_silence_where_the_file_says_so() -> None:
    assert _keep(SILENT, [A], A) == Kept((A,))
    assert _keep(SILENT, [A, B], A) == Kept((), (A, B))
    assert _keep(SILENT, [B]) == Kept((B,))


@pytest.mark.parametrize("name", [B.guid.hex(), "/b/b"])
def test_one_that_is_named(name: str) -> None:
    assert _keep(Keep(name), [A, B]) == Kept((B,), (A,))
    assert _keep(Keep(name), [A]) == Kept((), (A,))
    assert _keep(Keep(name, "silent"), [A, B]) == Kept((), (A, B))


def test_of_several_with_the_name_the_first_or_all() -> None:
    assert _keep(Keep("/a"), [A, B, C]) == Kept((A, C), (B,))
    assert _keep(Keep("/a", "keep_first"), [A, B, C]) == Kept((A,), (B, C))
