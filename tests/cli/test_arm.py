# SPDX-License-Identifier: Apache-2.0
"""``island arm`` against something that answers in place of an island, over DDS on loopback."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safety_island.cli.main import main
from safety_island.dds.config import URI
from safety_island.dds.topics import ARM, STATUS
from safety_island.life_cycle.state import State
from safety_island.messages.arm import ArmResult
from safety_island.messages.status_fields import Status
from tests.status.samples import STALE, FakeIsland, sample

Capture = pytest.CaptureFixture[str]


@pytest.fixture(autouse=True)
def _no_configuration_of_the_user(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(URI, raising=False)


def answer(result: ArmResult) -> Callable[[Status], Status]:
    def give(status: Status) -> Status:
        if result is ArmResult.ARMED:
            status = status._replace(state=State.ACTIVE, published=True, reason=0)
        return status._replace(arm_result=result)

    return give


@pytest.mark.parametrize(
    ("result", "code", "said"),
    [
        (ArmResult.ARMED, 0, "armed: All is well: the island is ACTIVE"),
        (ArmResult.NOT_NEEDED, 0, "not needed: Nothing is being published: odometry is older"),
        (ArmResult.REFUSED, 1, "refused: Nothing is being published: odometry is older"),
    ],
)
def test_the_answer_is_told(
    domain_id: int, capsys: Capture, result: ArmResult, code: int, said: str
) -> None:
    with FakeIsland(domain_id, sample(**STALE), answer(result)) as island:
        assert main(["arm", "--domain", str(domain_id), "--timeout", "20"]) == code
    assert capsys.readouterr().out.startswith(said)
    (nonce,) = island.requests
    assert nonce != 0


def test_each_request_has_its_own_nonce(domain_id: int) -> None:
    with FakeIsland(domain_id, sample(), answer(ArmResult.NOT_NEEDED)) as island:
        for _ in range(2):
            assert main(["arm", "--domain", str(domain_id), "--timeout", "20"]) == 0
    assert len(set(island.requests)) == 2


def test_no_island_is_one_line(domain_id: int, capsys: Capture) -> None:
    assert main(["arm", "--domain", str(domain_id), "--timeout", "0.05"]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert f"no status came within 0.05 s on {STATUS.name} (domain {domain_id}" in error


def test_an_island_that_does_not_answer(domain_id: int, capsys: Capture) -> None:
    with FakeIsland(domain_id, sample()):
        assert main(["arm", "--domain", str(domain_id), "--timeout", "2"]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "none in 2 s answers the request" in error


def test_an_island_that_does_not_listen(domain_id: int, capsys: Capture) -> None:
    with FakeIsland(domain_id, sample(), listens=False):
        assert main(["arm", "--domain", str(domain_id), "--timeout", "2"]) == 1
    assert f"nobody listens on {ARM.name}" in capsys.readouterr().err
