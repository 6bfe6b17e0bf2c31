# SPDX-License-Identifier: Apache-2.0
"""A start with too little memory to be had ends with one line, before a library can hang on it."""

from __future__ import annotations

import resource
import signal
import subprocess
import sys
from collections.abc import Sequence

import pytest

from safety_island.cli.memory_limit import MB, MemoryLimitError, Need, check_memory_limit
from safety_island.cli.table import COMMANDS, find

RUN = find("run")
assert RUN is not None and RUN.need is not None
NEED = RUN.need
LIMITS = {"RLIMIT_AS": resource.RLIMIT_AS, "RLIMIT_DATA": resource.RLIMIT_DATA}


def start(arguments: Sequence[str], limit: str, size_mb: int) -> subprocess.Popen[str]:
    """Start a command under a limit, set by a shell as a user would."""
    option = {"RLIMIT_AS": "-v", "RLIMIT_DATA": "-d"}[limit]
    shell = f'ulimit {option} {size_mb * 1024}; exec "$@"'
    return subprocess.Popen(
        ["bash", "-c", shell, "-", sys.executable, "-m", "safety_island", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.parametrize("size_mb", [200, 400, 500, 600, 700, 900, NEED.address_space - 1])
def test_too_little_address_space_is_one_line_and_exit_code_70(size_mb: int) -> None:
    with start(["run", "--duration", "1"], "RLIMIT_AS", size_mb) as process:
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err.count("\n")) == (70, "", 1)
    assert err.startswith(f"island: error: RLIMIT_AS is {size_mb} MB and 'island run' needs ")
    assert f"ulimit -v {NEED.address_space * 1024}" in err


def test_too_little_data_is_one_line_and_exit_code_70() -> None:
    with start(["run", "--duration", "1"], "RLIMIT_DATA", NEED.data - 1) as process:
        _, err = process.communicate(timeout=60)
    assert (process.returncode, err.count("\n")) == (70, 1)
    assert "RLIMIT_DATA" in err


def test_help_needs_no_memory() -> None:
    with start(["run", "--help"], "RLIMIT_AS", 200) as process:
        out, _ = process.communicate(timeout=60)
    assert process.returncode == 0 and "--duration" in out


@pytest.mark.live
@pytest.mark.parametrize(("limit", "size_mb"), list(zip(LIMITS, NEED[:2], strict=True)))
def test_what_is_asked_for_is_enough(domain_id: int, limit: str, size_mb: int) -> None:
    """And SIGTERM is answered."""
    arguments = ["run", "--domain", str(domain_id), "--interface", "lo", "--duration", "60"]
    with start(arguments, limit, size_mb) as process:
        assert process.stderr is not None
        said = ""
        while "is live" not in said:
            line = process.stderr.readline()
            assert line, f"it ended with {process.wait()}: {said}"
            said += line
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
    assert process.returncode == 0


def test_commands_that_load_much_say_how_much() -> None:
    known = {command.name for command in COMMANDS if command.need is not None}
    assert {"run", "bridge", "main-compute", "demo", "replay", "bench", "prepare"} <= known


def test_no_limit_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resource, "getrlimit", lambda number: (resource.RLIM_INFINITY, 0))
    check_memory_limit("run", NEED)


def test_a_limit_counts_that_is_in_force(monkeypatch: pytest.MonkeyPatch) -> None:
    """The soft one."""
    monkeypatch.setattr(resource, "getrlimit", lambda number: (99 * MB, resource.RLIM_INFINITY))
    check_memory_limit("run", Need(99, 99))
    check_memory_limit("run", None)
    check_memory_limit("run", Need(99, 99, kernels=True))
    with pytest.raises(MemoryLimitError, match="RLIMIT_AS is 99 MB and 'island run' needs 100 MB"):
        check_memory_limit("run", Need(100, 99))


def test_kernels_of_a_library_need_no_memory_for_a_compiler(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    need = Need(1000, 500, kernels=True)
    monkeypatch.setattr(resource, "getrlimit", lambda number: (800 * MB, 0))
    with pytest.raises(MemoryLimitError, match="needs 1000 MB"):
        check_memory_limit("run", need)
    monkeypatch.setenv("SAFETY_ISLAND_KERNELS", "library.so")
    check_memory_limit("run", need)
    monkeypatch.setattr(resource, "getrlimit", lambda number: (700 * MB, 0))
    with pytest.raises(MemoryLimitError, match="needs 750 MB"):
        check_memory_limit("run", need)
