# SPDX-License-Identifier: Apache-2.0
"""Network and time before anything else; a failure ends the start in one line."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from ipaddress import IPv4Interface
from pathlib import Path

import pytest

from safety_island.cli.main import main
from safety_island.cli.run_settings import RunSettings
from safety_island.cli.run_start import bring_up, thread_stacks
from safety_island.dds.config import DdsConfig
from safety_island.platform import LogConfig, load
from safety_island.platform.sim import SimPlatform
from safety_island.platform.sim import make as make_sim
from safety_island.targets.kconfig.configuration import InterfaceConfiguration
from tests.cli.test_run_settings import settings
from tests.platform.posix.test_sntp import CHRONYD, chrony, reply, server


def virtual(**changes: object) -> tuple[SimPlatform, RunSettings]:
    values = {**vars(settings()), "dds": DdsConfig(interface="sim0"), **changes}
    return make_sim(LogConfig()), RunSettings(**values)


def test_row_96_the_address_is_waited_for_and_told() -> None:
    platform, chosen = virtual()
    platform.network.addresses["sim0"] = None
    due_ns = platform.clock.monotonic_ns() + 4_000_000_000
    platform.clock.call_at(
        due_ns, lambda: platform.network.addresses.__setitem__("sim0", "10.0.0.7")
    )
    assert bring_up(platform, chosen).interface == "sim0"
    assert 0 <= platform.clock.monotonic_ns() - due_ns <= 10_000_000
    waiting, there = platform.logger.lines
    assert "waiting at most 10 s for an IPv4 address of interface 'sim0'" in waiting
    assert "'sim0' has the IPv4 address 10.0.0.7" in there


def test_dds_goes_to_the_vlan() -> None:
    item = InterfaceConfiguration("sim0", 7, IPv4Interface("192.0.2.5/24"), None)
    platform, chosen = virtual(interfaces=(item,))
    assert bring_up(platform, chosen).interface == "sim0.7"
    assert platform.network.address("sim0.7") == "192.0.2.5"


def test_threads_get_the_stack_that_is_configured() -> None:
    before = threading.stack_size()
    with thread_stacks(524288):
        assert threading.stack_size() == 524288
    assert threading.stack_size() == before


def test_no_address_ends_the_start(capsys: pytest.CaptureFixture[str], domain_id: int) -> None:
    words = ["run", "--domain", str(domain_id), "-D", "DDS_NETWORK_INTERFACE=nowhere0"]
    assert main([*words, "-D", "NET_DHCPV4_INITIAL_DELAY_MAX=0"]) == 1
    (error,) = [line for line in capsys.readouterr().err.splitlines() if "island: error" in line]
    assert "interface 'nowhere0' has no IPv4 address after 0 s (there is no such interface" in error


@pytest.mark.live
def test_a_mistyped_interface_is_told_at_once_and_waited_for_up_to_the_limit(
    domain_id: int,
) -> None:
    """A VPN's may come later, also when it is named by hand; who mistyped it can end the wait."""
    words = ["--domain", str(domain_id), "--interface", "lo0"]
    words += ["-D", "NET_DHCPV4_INITIAL_DELAY_MAX=1"]
    command = [sys.executable, "-m", "safety_island", "run", *words]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        waiting = next(line for line in process.stderr if "waiting at most 1 s" in line)
        *_, error = process.stderr
    for line in (waiting, error):
        assert "interface 'lo0'" in line and "this machine has " in line
        assert "did you mean 'lo'?" in line
    assert error.startswith("island: error: interface 'lo0' has no IPv4 address after 1 s")
    assert process.returncode == 1


def test_a_lying_time_server_ends_the_start(
    capsys: pytest.CaptureFixture[str], domain_id: int
) -> None:
    with server(lambda data: [reply(data, stratum=16)]) as name:
        assert main(["run", "--domain", str(domain_id), "--sntp", name]) == 1
    (error,) = [line for line in capsys.readouterr().err.splitlines() if "island: error" in line]
    assert f"no time from SNTP server '{name}': the server has stratum 16" in error


def test_sntp_moves_the_stamps_and_no_timer() -> None:
    platform = load("posix")
    values = {**vars(settings("-D", "ENABLE_SNTP=y")), "dds": DdsConfig(interface="lo")}
    timer = platform.new_timer(0.01)
    with server(lambda data: [reply(data, shift_s=1e6)]) as name:
        bring_up(platform, RunSettings(**{**values, "sntp_server": name}))
    assert abs(platform.clock.now() - time.time() - 1e6) < 10.0
    tick = timer.wait()
    assert tick is not None
    assert tick.skipped < 1000
    timer.close()
    platform.logger.close()


@pytest.mark.live
def test_a_stop_ends_the_wait_for_an_address(domain_id: int) -> None:
    words = ["--domain", str(domain_id), "-D", "DDS_NETWORK_INTERFACE=nowhere0"]
    words += ["-D", "NET_DHCPV4_INITIAL_DELAY_MAX=3600"]
    command = [sys.executable, "-m", "safety_island", "run", *words]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        next(line for line in process.stderr if "waiting at most 3600 s" in line)
        process.terminate()
        assert process.wait(60) == 0


@pytest.mark.live
@pytest.mark.skipif(CHRONYD is None, reason="chrony is not installed")
def test_the_island_takes_its_time_from_chrony(domain_id: int, tmp_path: Path) -> None:
    with chrony(tmp_path, "local stratum 8") as name:
        words = ["--domain", str(domain_id), "--duration", "0.3"]
        words += ["-D", "ENABLE_SNTP=y", "-D", f"SNTP_SERVER={name}"]
        command = [sys.executable, "-m", "safety_island", "run", *words]
        done = subprocess.run(command, capture_output=True, text=True, timeout=110)
    assert done.returncode == 0, done.stderr
    assert f"wall clock set by SNTP server '{name}' (stratum 8)" in done.stderr
    assert "safety_island is live" in done.stderr
