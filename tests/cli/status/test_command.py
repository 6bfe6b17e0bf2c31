# SPDX-License-Identifier: Apache-2.0
"""``island status`` against a sender of statuses, over DDS on loopback."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys

import pytest

from safety_island import __version__
from safety_island.cli.main import main
from safety_island.dds.config import URI, DdsConfig
from safety_island.dds.participant import Participant
from safety_island.dds.topics import STATUS
from safety_island.life_cycle.reason import Reason
from tests.status.samples import NOT_FINITE, ODOMETRY, STALE, FakeIsland, sample

Capture = pytest.CaptureFixture[str]
LONG = ["--timeout", "20"]
"""Ends early: what is waited for comes."""


@pytest.fixture(autouse=True)
def _no_configuration_of_the_user(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(URI, raising=False)


def words(domain_id: int, *more: str) -> list[str]:
    return ["status", "--domain", str(domain_id), *more]


def test_why_when_all_is_well(domain_id: int, capsys: Capture) -> None:
    with FakeIsland(domain_id, sample()):
        assert main(words(domain_id, "--why", *LONG)) == 0
    assert capsys.readouterr().out.startswith("All is well: the island is ACTIVE")


def test_why_when_nothing_is_published(domain_id: int, capsys: Capture) -> None:
    with FakeIsland(domain_id, sample({ODOMETRY: NOT_FINITE}, **STALE)):
        assert main(words(domain_id, "--why", *LONG)) == 1
        assert main(words(domain_id, "--why", "--json", *LONG)) == 1
    sentence, line = capsys.readouterr().out.splitlines()
    assert sentence.startswith("Nothing is being published: odometry is older than its limit")
    expected = {"event": "why", "flows": False, "free": False, "held_by": [], "why": sentence}
    assert json.loads(line) == {"version": __version__, **expected}


def test_once_as_a_line_and_as_json(domain_id: int, capsys: Capture) -> None:
    with FakeIsland(domain_id, sample()):
        assert main(words(domain_id, "--once", *LONG)) == 0
        assert main(words(domain_id, "--once", "--json", *LONG)) == 0
    line, text = capsys.readouterr().out.splitlines()
    assert line.startswith("ACTIVE  tick ")
    values = json.loads(text)
    assert (values["event"], values["state"], values["commands"]) == ("status", "ACTIVE", 1230)
    assert values["version"] == __version__


def test_json_streams_every_status_until_it_is_told_to_stop(domain_id: int) -> None:
    with FakeIsland(domain_id, sample()):
        command = [sys.executable, "-m", "safety_island", *words(domain_id, "--json")]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            ticks = [json.loads(process.stdout.readline())["tick"] for _ in range(20)]
            process.send_signal(signal.SIGINT)
            process.stdout.read()
    assert process.returncode == 0
    assert ticks == list(range(ticks[0], ticks[0] + 20))


def test_duration_ends_it(domain_id: int, capsys: Capture) -> None:
    with FakeIsland(domain_id, sample(reason=Reason.NONE)):
        assert main(words(domain_id, "--once", *LONG)) == 0
        assert main(words(domain_id, "--duration", "3")) == 0
    assert capsys.readouterr().out.count("ACTIVE") >= 2


@pytest.mark.parametrize("more", [["--why"], ["--once"], ["--duration", "0.05"]])
def test_no_island_is_one_line(domain_id: int, capsys: Capture, more: list[str]) -> None:
    assert main(words(domain_id, *more, "--timeout", "0.05")) == 1
    assert capsys.readouterr().err == (
        f"island: error: no status came within 0.05 s on {STATUS.name} (domain {domain_id},"
        " interface lo); start 'island run', or name its --domain and --interface here"
        " ('island env' prints the DDS settings that meet an island)\n"
    )


@pytest.mark.parametrize("more", [[], ["--json"]])
def test_who_waits_longer_is_told_once_that_there_is_none(
    domain_id: int, capsys: Capture, more: list[str]
) -> None:
    assert main(words(domain_id, *more, "--timeout", "0.05", "--duration", "0.5")) == 1
    told, ended = capsys.readouterr().err.splitlines()
    assert told.startswith("island: no status came within 0.05 s")
    assert ended.startswith("island: error: no status came within 0.5 s")


def test_an_island_that_stands_still_is_told_apart(domain_id: int, capsys: Capture) -> None:
    with Participant(domain_id, DdsConfig(interface="lo"), "safety_island") as island:
        publisher = island.publisher(STATUS.name, STATUS.type_name, STATUS.qos)
        assert publisher.matched() == 0
        assert main(words(domain_id, "--why", "--timeout", "3")) == 1
    assert "though its publisher is there: the island stands still" in capsys.readouterr().err


def test_another_type_on_the_topic_is_named(domain_id: int, capsys: Capture) -> None:
    with Participant(domain_id, DdsConfig(interface="lo"), "safety_island") as island:
        island.publisher(STATUS.name, "std_msgs/msg/Header", STATUS.qos)
        assert main(words(domain_id, "--why", "--timeout", "3")) == 1
    assert "std_msgs/msg/Header" in capsys.readouterr().err


def test_a_status_that_cannot_be_read(
    domain_id: int, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    status = sample()
    monkeypatch.setattr("safety_island.messages.status.SIZE", 2000)
    with FakeIsland(domain_id, status):
        assert main(words(domain_id, "--why", *LONG)) == 1
    error = capsys.readouterr().err
    assert "cannot be read" in error and "use the version of the island here" in error


def test_one_kind_at_a_time(capsys: Capture) -> None:
    assert main(["status", "--why", "--once"]) == 2
    assert "not allowed with" in capsys.readouterr().err


def test_a_closed_reader_ends_it_quietly(domain_id: int) -> None:
    with FakeIsland(domain_id, sample()):
        command = [sys.executable, "-m", "safety_island", *words(domain_id, "--json")]
        reading, writing = os.pipe()
        with subprocess.Popen(command, stdout=writing, stderr=subprocess.PIPE) as process:
            os.close(writing)
            os.read(reading, 1)
            os.close(reading)
            _, error = process.communicate(timeout=60)
    assert process.returncode == 128 + signal.SIGPIPE
    assert error == b""
