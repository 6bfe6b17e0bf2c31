# SPDX-License-Identifier: Apache-2.0
"""``island can``: what a user sees."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
import time
from collections.abc import Generator
from pathlib import Path

import can
import pytest

from safety_island import __version__
from safety_island.can.candump import LogEntry, format_line
from safety_island.can.dbc import dbc_text
from safety_island.cli.main import main
from tests.can.peers import ROOT
from tests.can.rig import REFERENCE_LINES, triple

REFERENCE_LINE = (
    "--angle 0.125 --rate -0.5 --velocity 12.25 --acceleration -1.5 "
    "--mode DDS_AND_CAN --sequence 42 --stamp 12.345"
)
REFERENCE_ARGUMENTS = REFERENCE_LINE.split()
Capture = pytest.CaptureFixture[str]


def island(*arguments: str) -> int:
    return main(["can", *arguments])


def test_send_prints_the_reference_vector(capsys: Capture) -> None:
    assert island("send", *REFERENCE_ARGUMENTS, "--print") == 0
    assert capsys.readouterr().out.splitlines() == list(REFERENCE_LINES)


@pytest.mark.parametrize(
    ("arguments", "lines"),
    [
        ("", ["100#0000000000000000", "101#0000000000000000", "102#0108000000000000"]),
        ("--angle -1e-6", ["100#FFFFFFFF00000000", "101#" + 16 * "0", "102#0108000000000000"]),
        ("--rate 0", ["100#" + 16 * "0", "101#" + 16 * "0", "102#0109000000000000"]),
        (
            "--acceleration=-.001",
            ["100#" + 16 * "0", "101#00000000FFFFFFFF", "102#010A" + 12 * "0"],
        ),
        ("--jerk 1", ["100#" + 16 * "0", "101#" + 16 * "0", "102#010C000000000000"]),
        (
            "--sequence 65535 --stamp 4294967.296",
            ["100#" + 16 * "0", "101#" + 16 * "0", "102#0108FFFF00000000"],
        ),
        (
            "--stamp 1700000000.1239",
            ["100#" + 16 * "0", "101#" + 16 * "0", "102#010800007B68E5CF"],
        ),
        (
            "--angle 2147.483647 --rate -2147.483648",
            ["100#FFFFFF7F00000080", "101#" + 16 * "0", "102#0109000000000000"],
        ),
    ],
)
def test_send_print(arguments: str, lines: list[str], capsys: Capture) -> None:
    assert island("send", "--print", *arguments.split()) == 0
    assert capsys.readouterr().out.splitlines() == lines


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("--angle nan", "steering_tire_angle is nan, expected a finite number"),
        ("--velocity -inf", "velocity is -inf, expected a finite number"),
        ("--rate 2147.4836475", "expected -2147.483648 to 2147.483647 rad/s (int32 after scaling)"),
        ("--jerk nan", "jerk is nan"),
    ],
)
def test_send_rejects_before_a_frame_exists(arguments: str, message: str, capsys: Capture) -> None:
    assert island("send", "--print", *arguments.split()) == 1
    out, error = capsys.readouterr()
    assert out == ""
    assert message in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("--angle fast", "invalid float value: 'fast'"),
        ("--sequence 65536", "'65536' is not a whole number from 0 to 65535"),
        ("--sequence -1", "not a whole number"),
        ("--stamp -1", "'-1' is not a stamp in seconds"),
        ("--stamp nan", "is not a stamp"),
        ("--stamp noon", "'noon' is not a stamp"),
        ("--mode CAN", "invalid choice: 'CAN'"),
        ("--can mock --print", "not allowed with argument"),
        ("--can nothing:x", "unknown CAN backend 'nothing'"),
    ],
)
def test_send_arguments_that_are_wrong(arguments: str, message: str, capsys: Capture) -> None:
    assert island("send", *arguments.split()) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert message in error
    assert error.count("\n") == 1


def test_send_in_a_mode_without_can_sends_nothing(capsys: Capture) -> None:
    assert island("send", "--mode", "DDS_ONLY", "--print") == 0
    out, error = capsys.readouterr()
    assert (out, error) == ("", "island: output mode DDS_ONLY sends no CAN frame\n")


def test_send_on_a_bus(capsys: Capture) -> None:
    with can.Bus(interface="virtual", channel="cli", ignore_config=True) as bus:
        assert island("send", *REFERENCE_ARGUMENTS, "--can", "virtual:cli") == 0
        heard = [bus.recv(timeout=1) for _ in range(3)]
    frames = [(m.arbitration_id, bytes(m.data)) for m in heard if m]
    assert frames == list(triple())
    assert capsys.readouterr().out == "sent 3 frames on virtual:cli\n"


def test_send_on_a_bus_that_takes_no_more(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("safety_island.can.live.SEND_LIMIT_S", 0.01)
    options = {"interface": "virtual", "channel": "cli", "ignore_config": True}
    with can.Bus(rx_queue_size=2, **options):  # type: ignore[arg-type]
        assert island("send", "--can", "virtual:cli") == 1
    assert capsys.readouterr().err == (
        "island: error: CAN bus 'virtual:cli' did not take frame 0x102: timed out; "
        "2 of 3 frames were sent\n"
    )


@pytest.fixture
def log(tmp_path: Path) -> Path:
    lines = []
    for index, sequence in enumerate((41, 42, 45)):
        stamp_ns = (1_700_000_000_000 + 150 * index) * 1_000_000
        lines += [format_line(stamp_ns, "can0", frame) for frame in triple(sequence, stamp_ns)]
    path = tmp_path / "drive.log"
    path.write_text("".join(lines))
    return path


def test_monitor_decodes_a_log(log: Path, capsys: Capture) -> None:
    assert island("monitor", str(log)) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].startswith("1700000000.150000  #42  steering_tire_angle 0.125000 rad")
    assert len([line for line in lines if "  #" in line]) == 3
    text = "\n".join(lines[3:])
    assert "6.67 Hz" in text
    assert "1 gaps, 2 commands missing" in text


def test_monitor_summary(log: Path, capsys: Capture) -> None:
    assert island("monitor", str(log), "--summary") == 0
    assert "  #42" not in capsys.readouterr().out


def test_monitor_as_json(log: Path, capsys: Capture) -> None:
    assert island("monitor", str(log), "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert [command["sequence"] for command in found["decoded"]] == [41, 42, 45]
    assert found["latest"]["velocity"] == {"value": 12.25, "unit": "m/s", "defined": True}
    assert found["sequence"]["missing"] == 2
    assert found["log"] == str(log)
    assert island("monitor", str(log), "--json", "--summary") == 0
    assert "decoded" not in json.loads(capsys.readouterr().out)


def test_monitor_says_which_line_is_left_out(log: Path, capsys: Capture) -> None:
    log.write_text(log.read_text() + "what is this\n")
    assert island("monitor", str(log), "--json") == 0
    out, error = capsys.readouterr()
    note = f"{log}:10: found 'what is this'; 1 line is not of this log and left out"
    assert json.loads(out)["notes"] == [note]
    assert json.loads(out)["commands"]["count"] == 3
    assert error == f"island: {note}\n"


def test_monitor_reports_what_came_before_a_torn_line(log: Path, capsys: Capture) -> None:
    log.write_text(log.read_text()[:-9])
    assert island("monitor", str(log), "--json") == 0
    out, error = capsys.readouterr()
    assert json.loads(out)["commands"]["count"] == 2
    assert error.startswith(
        f"island: {log}:9: the last line is torn: '(1700000000.300000) can0 102#"
    )


def two_channels(log: Path) -> None:
    lines = log.read_text().splitlines(keepends=True)
    log.write_text("".join(line + line.replace("can0", "can1") for line in lines))


@pytest.mark.parametrize("form", [[], ["--json"], ["--summary"]])
def test_monitor_does_not_mix_the_commands_of_two_channels(
    form: list[str], log: Path, capsys: Capture
) -> None:
    two_channels(log)
    assert island("monitor", str(log), *form) == 2
    assert capsys.readouterr().err == (
        f"island: error: {log}: commands are on 2 channels, can0 (9 frames), can1 (9 frames); "
        "choose one with --channel\n"
    )


def test_monitor_takes_the_channel_that_was_chosen(log: Path, capsys: Capture) -> None:
    two_channels(log)
    assert island("monitor", str(log), "--json", "--channel", "can1") == 0
    assert json.loads(capsys.readouterr().out)["commands"]["count"] == 3
    assert island("monitor", str(log), "--channel", "can7") == 2
    assert capsys.readouterr().err == (
        f"island: error: {log}: no channel 'can7', found can0 (9 frames), can1 (9 frames)\n"
    )
    assert island("monitor", "--channel", "can7") == 2
    assert "a live bus is one channel" in capsys.readouterr().err


def test_another_channel_without_commands_is_just_other_frames(log: Path, capsys: Capture) -> None:
    log.write_text(log.read_text() + "(1700000000.310000) can1 555#00\n")
    assert island("monitor", str(log), "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["commands"]["count"], found["other_frames"]) == (3, 1)


@pytest.mark.parametrize("form", [[], ["--json"]])
def test_monitor_of_a_bus_that_falls_silent_alarms(form: list[str], capsys: Capture) -> None:
    """The bus is silent from its start on: the first frame never comes."""
    words = ("monitor", "--can", "virtual:quiet", "--duration", "0.7", *form)
    assert island(*words) == 1
    last = capsys.readouterr().out
    assert "LOST: no command has come for 0." in last
    assert "0 losses" not in last
    if form:
        assert json.loads(last.splitlines()[-1])["commands"]["losses"] == 1


def test_monitor_without_its_file(capsys: Capture) -> None:
    assert island("monitor", "/nowhere.log") == 2
    assert capsys.readouterr().err == (
        "island: error: /nowhere.log: cannot be read: No such file or directory\n"
    )


def test_monitor_reads_standard_input(log: Path) -> None:
    with log.open() as lines:
        found = subprocess.run(
            [sys.executable, "-m", "safety_island", "can", "monitor", "-"],
            stdin=lines,
            capture_output=True,
            text=True,
            check=True,
            env={"PYTHONPATH": str(ROOT / "src")},
        )
    assert "#45" in found.stdout


class Island(threading.Thread):
    """Sends commands on a virtual bus until it is told to stop."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.stop = threading.Event()

    def run(self) -> None:
        with can.Bus(interface="virtual", channel="live", ignore_config=True) as bus:
            for sequence in range(10_000):
                for frame in triple(sequence, time.time_ns()):
                    bus.send(
                        can.Message(
                            arbitration_id=frame.arbitration_id,
                            data=frame.data,
                            is_extended_id=False,
                        )
                    )
                if self.stop.wait(0.01):
                    return


@pytest.mark.parametrize("form", [[], ["--json"]])
def test_monitor_watches_a_live_bus(form: list[str], capsys: Capture) -> None:
    sender = Island()
    sender.start()
    # A busy machine may keep the sender for some of its own periods.
    found = island("monitor", "--can", "virtual:live", "--duration", "1", "--period", "1", *form)
    sender.stop.set()
    sender.join()
    assert found == 0
    out = capsys.readouterr().out
    if form:
        lines = [json.loads(line) for line in out.splitlines()]
        first, state = lines[0], lines[-1]
        assert first["version"] == __version__
        assert state["commands"]["count"] > 1
        assert state["commands"]["age_s"] < 60
        assert abs(state["latest"]["lag_ms"]) < 60_000
    else:
        assert "steering_tire_angle 0.125000 rad" in out
        assert "complete commands" in out


def test_monitor_ends_with_its_findings_when_it_is_interrupted(
    capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(spec: object) -> Generator[LogEntry | None, None, None]:
        for frame in triple():
            yield LogEntry(12.345, frame)
        raise KeyboardInterrupt

    monkeypatch.setattr("safety_island.can.live.watch", interrupted)
    assert island("monitor", "--can", "virtual:x") == 0
    assert "#42" in capsys.readouterr().out


@pytest.mark.parametrize("form", [[], ["--json"]])
def test_monitor_shows_the_state_each_second(
    form: list[str], capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("safety_island.cli.can_monitor._REFRESH_NS", 0)
    arguments = ("monitor", "--can", "virtual:quiet", "--duration", "0.25", *form)
    assert island(*arguments) == 0
    shown = capsys.readouterr().out.splitlines()
    assert len([line for line in shown if "null" in line or "no command yet" in line]) >= 2


def test_monitor_on_a_terminal_renews_its_picture(
    capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    assert island("monitor", "--can", "virtual:quiet", "--duration", "0.01") == 0
    assert "no command yet" in capsys.readouterr().out


def test_monitor_of_a_bus_that_fails(capsys: Capture) -> None:
    assert island("monitor", "--can", "socketcan:can0", "--duration", "0.1") == 1
    assert "'socketcan:can0' cannot be opened" in capsys.readouterr().err


def test_monitor_of_a_quiet_bus(capsys: Capture) -> None:
    assert island("monitor", "--can", "virtual:quiet", "--duration", "0.01") == 0
    assert capsys.readouterr().out.startswith("no command yet\n")


def test_monitor_cannot_listen_to_the_mock(capsys: Capture) -> None:
    assert island("monitor", "--can", "mock") == 2
    assert "the mock bus has nobody to listen to" in capsys.readouterr().err


def test_dbc(tmp_path: Path, capsys: Capture) -> None:
    assert island("dbc") == 0
    assert capsys.readouterr().out == dbc_text()
    path = str(tmp_path / "island.dbc")
    assert island("dbc", "--output", path) == 0
    assert island("dbc", "--check", path) == 0
    assert capsys.readouterr().out == f"{path}: agrees with the encoder\n"
    Path(path).write_text(dbc_text().replace("(0.001,0)", "(0.01,0)", 1))
    assert island("dbc", "--check", path) == 1
    assert capsys.readouterr().out == (f"{path}: 0x101 velocity: factor is 0.01, expected 0.001\n")
    assert island("dbc", "--check", "/nowhere.dbc") == 2
    assert island("dbc", "--output", "/nowhere/x.dbc") == 2
    assert capsys.readouterr().err.count("\n") == 2


def test_tables(tmp_path: Path, capsys: Capture) -> None:
    assert island("tables") == 0
    assert "| `DDS_AND_CAN` | 2 |" in capsys.readouterr().out
    page = tmp_path / "page.md"
    page.write_text("<!-- table: modes -->\n<!-- end -->\n")
    assert island("tables", "--update", str(page)) == 0
    assert "| `CAN_ONLY` | 1 |" in page.read_text()


@pytest.mark.parametrize("arguments", [[], ["listen"], ["monitor", "--period", "7"]])
def test_arguments_that_are_wrong(arguments: list[str], capsys: Capture) -> None:
    assert island(*arguments) == 2
    assert capsys.readouterr().err.count("\n") == 1
