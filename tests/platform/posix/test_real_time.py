# SPDX-License-Identifier: Apache-2.0
"""Real-time scheduling: what a process takes where it may, and what it says where it may not.

Each case runs in a process of its own: a fixed priority must not stay with the tests.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from safety_island.errors import ConfigurationError
from safety_island.platform.posix import real_time
from safety_island.platform.posix.real_time import GRANT, RealTime, parse_cpu

ROOT = Path(__file__).parents[3]
STRANGER = 65534  # no file of the tests is his
TAKE = """
import json, mmap, os, sys, threading, time
from safety_island.platform.posix.real_time import *
stop = threading.Event()
threading.Thread(target=stop.wait).start()
mode, cpu = sys.argv[1:]
found = took = None
try:
    found = take_real_time(mode, cpu, Priorities(50, 40))
except RealTimeError as error:
    took = str(error)
threads = {int(one): (os.sched_getscheduler(int(one)), os.sched_getparam(int(one)).sched_priority)
           for one in os.listdir("/proc/self/task")}
own = threads.pop(os.getpid())
status = dict(line.split(":\\t", 1) for line in open("/proc/self/status") if ":\\t" in line)
mmap.mmap(-1, 64 << 20)  # fails where all memory is locked under a small limit
print(json.dumps({"got": found and found.got, "missing": found and found.missing, "error": took,
    "text": str(found), "own": own, "others": sorted(set(threads.values())),
    "cpus": sorted(os.sched_getaffinity(0)), "locked_kb": int(status["VmLck"].split()[0]),
    "limits": [found is None, os.getuid()]}))
stop.set()
"""


def may_take_it() -> bool:
    """Whether the tests themselves have the right; asked in a process of its own."""
    code = "import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(50))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=False)
    return done.returncode == 0


needs_right = pytest.mark.skipif(not may_take_it(), reason="needs the right to SCHED_FIFO")
needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="becomes another user, as only root may")


def take(mode: str, cpu: str, *before: str) -> dict[str, Any]:
    """Run the script, behind a command that changes its rights."""
    done = subprocess.run(
        [*before, sys.executable, "-c", TAKE, mode, cpu],
        env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    if before and "failed to set the" in done.stderr:
        pytest.skip("this sandbox cannot raise a limit")
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def powerless(rtprio: int = 0, memlock: str = "65536") -> list[str]:
    """A command that runs another one as a user without rights, under two limits."""
    limits = ["prlimit", f"--rtprio={rtprio}:{rtprio}", f"--memlock={memlock}:{memlock}"]
    return [*limits, "setpriv", "--inh-caps=-all", "--ambient-caps=-all", "--bounding-set=-all"]


@needs_right
def test_the_control_thread_comes_before_the_others_which_come_before_ordinary_work() -> None:
    found = take("auto", "any")
    assert found["own"] == [os.SCHED_FIFO, 50]
    assert found["others"] == [[os.SCHED_FIFO, 40]]
    assert "SCHED_FIFO priority 50 (other threads 40)" in found["got"]


@needs_right
def test_the_control_thread_alone_is_put_on_one_core() -> None:
    allowed = sorted(os.sched_getaffinity(0))
    assert take("auto", "any")["cpus"] == allowed
    assert take("auto", "auto")["cpus"] == [allowed[-1]]
    assert take("auto", str(allowed[0]))["cpus"] == [allowed[0]]


def test_off_changes_nothing() -> None:
    found = take("off", "auto")
    assert (found["own"], found["locked_kb"]) == ([os.SCHED_OTHER, 0], 0)
    assert found["cpus"] == sorted(os.sched_getaffinity(0)) and found["text"] == "None"


@needs_root
def test_row_95_without_rights_it_goes_on_and_says_what_is_missing_and_how_to_get_it() -> None:
    found = take("auto", "auto", *powerless())
    assert found["got"] == []
    missing = ["SCHED_FIFO priority 50", "locked memory (RLIMIT_MEMLOCK is 64 kB)"]
    assert found["missing"] == missing
    text = f"real time: nothing; missing: {', '.join(missing)} (allow it: {GRANT})"
    assert found["text"] == text
    assert found["locked_kb"] == 0


@needs_root
def test_at_ordinary_priority_it_is_pinned_only_where_that_is_asked_for() -> None:
    """It could not leave a core that others keep busy."""
    allowed = sorted(os.sched_getaffinity(0))
    assert take("auto", "auto", *powerless())["cpus"] == allowed
    assert take("auto", str(allowed[0]), *powerless())["cpus"] == [allowed[0]]


@needs_root
def test_require_without_rights_is_an_error() -> None:
    found = take("require", "any", *powerless())
    assert found["error"].startswith("--realtime require: real time: nothing; missing: SCHED_FIFO")


@needs_root
def test_a_limit_of_the_priority_is_kept_and_told() -> None:
    found = take("auto", "any", *powerless(rtprio=10))
    assert (found["own"], found["others"]) == ([os.SCHED_FIFO, 10], [[os.SCHED_FIFO, 9]])
    assert "priority 50 (RLIMIT_RTPRIO is 10)" in found["missing"]


@needs_root
@pytest.mark.parametrize("memlock", ["65536", str(256 << 20)])
def test_under_a_limit_memory_is_not_locked_so_that_later_allocations_work(memlock: str) -> None:
    """The script allocates 64 MB afterwards."""
    found = take("auto", "any", *powerless(memlock=memlock))
    assert found["locked_kb"] == 0 and any("RLIMIT_MEMLOCK" in one for one in found["missing"])


@needs_root
@pytest.mark.parametrize("before", [[], powerless(memlock="unlimited")], ids=["root", "limit"])
def test_without_a_limit_memory_is_locked_and_later_allocations_too(before: list[str]) -> None:
    found = take("auto", "any", *before)
    if not before and any("locked memory" in one for one in found["missing"]):
        pytest.skip("this root may not lock memory")
    assert found["locked_kb"] > 64 << 10 and "locked memory" in found["got"]


def test_nothing_missing_is_told_without_advice() -> None:
    assert str(RealTime(["core 1"])) == "real time: core 1"


def test_isolated_cores_come_first(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    isolated = tmp_path / "isolated"
    chosen: list[set[int]] = []
    monkeypatch.setattr(real_time, "_ISOLATED", isolated)
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: set(range(8)))
    monkeypatch.setattr(os, "sched_setaffinity", lambda pid, cores: chosen.append(cores))
    for text in ("", "\n", "2,5-6\n", "99\n"):
        isolated.write_text(text)
        for rank in (0, 1):
            real_time._pin("auto", rank, RealTime())
    isolated.unlink()
    real_time._pin("auto", 0, RealTime())
    assert chosen == [{7}, {6}, {7}, {6}, {6}, {5}, {7}, {6}, {7}]


def test_the_only_core_is_left_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: {3})
    result = RealTime()
    real_time._pin("auto", 1, result)
    assert (result.got, result.missing) == (["core 3, the only one"], [])


@pytest.mark.parametrize("text", ["auto", "any"])
def test_words_for_a_core(text: str) -> None:
    assert parse_cpu(text) == text


@pytest.mark.parametrize("text", ["4096", "-1", "one", "", "\u0661"])
def test_a_core_that_is_not_there_is_told(text: str) -> None:
    with pytest.raises(ConfigurationError, match="is not a core that this process may use"):
        parse_cpu(text)


def test_the_bridge_never_comes_before_the_island() -> None:
    assert real_time.BRIDGE.control < real_time.ISLAND.others < real_time.ISLAND.control


def test_the_present_limits_are_not_lowered() -> None:
    before = [resource.getrlimit(n) for n in (resource.RLIMIT_RTPRIO, resource.RLIMIT_MEMLOCK)]
    code = (
        "import resource as r; from safety_island.platform.posix.real_time import *;"
        "take_real_time('auto', 'any', ISLAND);"
        "print(r.getrlimit(r.RLIMIT_RTPRIO)[1], r.getrlimit(r.RLIMIT_MEMLOCK)[1])"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert [int(word) for word in done.stdout.split()] == [hard for _, hard in before]
