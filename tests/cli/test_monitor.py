# SPDX-License-Identifier: Apache-2.0
"""``island monitor`` as a person starts it."""

from __future__ import annotations

import json
import re
import signal
import socket
import subprocess
import sys
import urllib.request

import pytest

from safety_island.cli.json_keys import MONITOR
from safety_island.cli.main import main
from tests.cli.test_json_page import check

MONITOR_COMMAND = (sys.executable, "-m", "safety_island", "monitor")


@pytest.mark.parametrize("port", ["0", "65536", "http", "-1", "8140.5"])
def test_a_port_that_is_none(port: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["monitor", f"--port={port}"]) == 2
    assert f"'{port}' is not a port: a whole number, 1 to 65535" in capsys.readouterr().err


@pytest.mark.parametrize("address", ["", "localhost", "1.2.3", "a\u2028b", "eth0"])
def test_an_address_that_is_none(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["monitor", f"--bind={address}"]) == 2
    assert "is not an IP address, for example 127.0.0.1" in capsys.readouterr().err


@pytest.mark.live
def test_a_port_in_use_is_said_and_the_next_one_serves(domain_id: int) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        taken = other.getsockname()[1]
        command = [*MONITOR_COMMAND, "--domain", str(domain_id), "--port", str(taken)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            said = process.stdout.readline()
            found = re.fullmatch(rf"port {taken} is in use; taking (\d+)\n", said)
            assert found is not None, said
            said = process.stdout.readline()
            assert f"the page: http://127.0.0.1:{found[1]}/ " in said
            with urllib.request.urlopen(f"http://127.0.0.1:{found[1]}/", timeout=20) as page:
                assert page.read().startswith(b"<!doctype html>")
            process.send_signal(signal.SIGINT)
            assert process.wait(30) == 0


@pytest.mark.live
def test_events_are_those_of_the_table_and_the_end_of_the_input_ends_it(domain_id: int) -> None:
    command = [*MONITOR_COMMAND, "--domain", str(domain_id), "--console", "--json"]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdin is not None
        event = json.loads(process.stdout.readline())
        assert event.pop("version")
        assert "#" in event["address"], "what acts needs a token"
        check(MONITOR, event.pop("event"), event)
        process.stdin.close()
        assert process.wait(30) == 0


@pytest.mark.live
def test_an_address_of_another_machine_is_one_line(domain_id: int) -> None:
    command = [*MONITOR_COMMAND, "--domain", str(domain_id), "--bind", "203.0.113.7"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "--bind: 203.0.113.7 port 8140 cannot be used" in done.stderr
