# SPDX-License-Identifier: Apache-2.0
"""``island run`` as a process: refuses what cannot work, waits, reports, ends when told to."""

from __future__ import annotations

import json
import math
import re
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from safety_island.cli.main import main
from safety_island.cli.run_report import RunReport, sample_ages, tick_values
from safety_island.control.records import TRACE
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.transition import Life
from safety_island.messages.outputs import Control, encode_control
from safety_island.messages.wire import Time
from safety_island.node import Outcome, TickReport
from safety_island.node.input_set import NO_SUBJECT
from safety_island.node.inputs import INPUTS
from safety_island.node.outgoing import OutgoingControl
from safety_island.platform import load

RUN = (sys.executable, "-m", "safety_island", "run")
COMMAND = Control(Time(1, 2), Time(1, 2), 0.125, 0.25, 3.0, 0.5)


def tick(outcome: Outcome = Outcome.PUBLISHED, **values: Any) -> TickReport:
    published = outcome is Outcome.PUBLISHED
    report = TickReport(
        number=1,
        now=5.0,
        outcome=outcome,
        detail="" if published else "odometry",
        life=Life(State.ACTIVE if published else State.INIT, Reason.NONE),
        subject=NO_SUBJECT,
        lateness_s=0.001,
        skipped=0,
        tick_time_s=0.002,
        lateral_time_s=0.001,
        longitudinal_time_s=0.0005,
        ages_s=(0.1,) * (len(INPUTS) - 1) + (math.inf,),
        refused=0,
        outgoing=OutgoingControl(encode_control(COMMAND)) if published else None,
    )
    return report._replace(**values)


AGES = {"odometry": 0.1, "operation mode": math.inf}


def reporter() -> RunReport:
    platform = load("sim")
    node: Any = SimpleNamespace(clock=platform.clock, logger=platform.logger, inputs=())
    return RunReport(node, np.zeros(1, TRACE), lambda: 1.25, None)


def test_report_counts() -> None:
    report = reporter()
    report(tick(Outcome.WAITING_FOR_INPUT, skipped=2))
    assert report.first_control_s is None
    for time in (0.001, 0.004, 0.002):
        report(tick(tick_time_s=time, refused=1))
    summary = report.summary()
    assert summary["ticks"] == 4
    assert summary["published"] == 3
    assert summary["missed_ticks"] == 2
    assert summary["refused_samples"] == 3
    assert summary["first_control_s"] == 1.25
    times = summary["tick_times_s"]
    assert times["max"] == times["p99"] == 0.004
    assert 0.002 <= times["median"] <= 0.002 * 1.01


def test_values_of_a_tick() -> None:
    trace = np.zeros(1, TRACE)
    values = tick_values(tick(), trace, AGES)
    assert values["outcome"] == "PUBLISHED"
    assert values["steering_tire_angle"] == 0.125
    assert values["longitudinal_state"] == "DRIVE"
    assert values["ages_s"] == AGES
    waiting = tick_values(tick(Outcome.WAITING_FOR_INPUT), trace, AGES)
    assert waiting["detail"] == "odometry"
    assert "longitudinal_state" not in waiting


def test_ages_count_from_the_sending() -> None:
    sample = SimpleNamespace(source_timestamp_ns=10**9)
    inputs: Any = [SimpleNamespace(name="a", taken=sample), SimpleNamespace(name="b", taken=None)]
    assert sample_ages(inputs, 3 * 10**9) == {"a": 2.0, "b": math.inf}


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--domain", "233"], "'233' is not a DDS domain id"),
        (["--params", "nosuch"], "parameter set 'nosuch' is not shipped"),
        (["--params", "/nowhere.yaml"], "/nowhere.yaml: cannot be read"),
        (["--platform", "zephyr"], "invalid choice: 'zephyr'"),
    ],
)
def test_refused(
    arguments: list[str], text: str, capsys: pytest.CaptureFixture[str], domain_id: int
) -> None:
    assert main(["run", "--domain", str(domain_id), *arguments]) == 2
    errors = [line for line in capsys.readouterr().err.splitlines() if line.startswith("island:")]
    assert len(errors) == 1
    assert text in errors[0]


@pytest.mark.live
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_ends_in_order_when_told_to(domain_id: int, number: signal.Signals) -> None:
    command = [*RUN, "--domain", str(domain_id), "--period", "0.03", "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert json.loads(process.stdout.readline())["outcome"] == "WAITING_FOR_INPUT"
        process.send_signal(number)
        rest, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    summary = json.loads(rest.splitlines()[-1])
    assert summary["event"] == "summary"
    assert summary["published"] == 0


@pytest.mark.live
def test_ends_after_its_duration_and_says_what_it_waits_for(domain_id: int) -> None:
    command = [*RUN, "--domain", str(domain_id), "--duration", "0.5"]
    process = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert (process.returncode, process.stdout) == (0, "")
    names = ", ".join(f"{spec.name} data" for spec in INPUTS)
    (line,) = [line for line in process.stderr.splitlines() if "Waiting for" in line]
    assert line.endswith(f" Waiting for {names} on domain {domain_id} (lo)")
    assert re.search(r" \d+ ticks, 0 commands", process.stderr)


def test_virtual_drive_is_the_same_every_time() -> None:
    command = [*RUN, "--platform", "sim", "--duration", "15", "--json"]
    runs = [subprocess.run(command, capture_output=True, text=True, timeout=300) for _ in range(2)]
    assert [run.returncode for run in runs] == [0, 0]
    ticks = [_ticks(run.stdout) for run in runs]
    assert ticks[0] == ticks[1]
    assert len(ticks[0]) == 100
    assert {tick["outcome"] for tick in ticks[0]} == {"PUBLISHED"}
    assert "virtual drive of" in runs[0].stderr


def test_debug_topics_change_nothing_else() -> None:
    command = [*RUN, "--platform", "sim", "--duration", "3", "--json"]
    plain, observed = (
        subprocess.run([*command, *more], capture_output=True, text=True, timeout=300)
        for more in ((), ("--debug-topics",))
    )
    assert (plain.returncode, observed.returncode) == (0, 0)
    assert _ticks(plain.stdout) == _ticks(observed.stdout)
    assert "an observer failed" not in observed.stderr


def _ticks(text: str) -> list[dict[str, Any]]:
    events = [json.loads(line) for line in text.splitlines()]
    return [event for event in events if event["event"] == "tick"]


def summary_of(*words: str) -> dict[str, Any]:
    """Drive in virtual time; return what the vehicle's summary says."""
    done = subprocess.run(
        [*RUN, "--platform", "sim", "--json", *words], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    events = [json.loads(line) for line in done.stdout.splitlines()]
    vehicle: dict[str, Any] = next(event for event in events if event["event"] == "vehicle")
    assert vehicle["finished"] and vehicle["on_course"] and vehicle["stopped_in_place"]
    return vehicle


def test_virtual_time_drives_the_course_that_is_named() -> None:
    assert len(summary_of("--course", "stop-and-go")["stop_errors"]) > 1


def test_virtual_time_drives_a_path_of_the_users_own(tmp_path: Path) -> None:
    rows = [f"{x},{0.002 * x * x},{4.0 if x < 40 else 6.0}" for x in range(0, 81, 4)]
    (tmp_path / "path.csv").write_text("\n".join(["x,y,v", *rows]))
    vehicle = summary_of("--path", str(tmp_path / "path.csv"))
    assert 5.7 < vehicle["top_speed"] < 6.5


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--platform", "sim", "--path", "none.csv"], "none.csv: cannot be read"),
        (
            ["--platform", "sim", "--course", "nosuch"],
            "unknown course 'nosuch'; there are: s-curve",
        ),
        (["--course", "slalom"], "--course: --platform posix drives"),
    ],
)
def test_a_course_that_cannot_be_is_one_line(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", *words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert told in line
