"""Logs of candump and of python-can, and what is said of those that cannot be read."""

from __future__ import annotations

import io
from pathlib import Path

import can
import pytest

from safety_island.can.candump import format_line
from safety_island.can.log_reader import LogError, read_log
from safety_island.platform.interfaces import CanFrame
from tests.can.rig import triple

FRAMES = [*triple(1), CanFrame(0x555, b"abc"), *triple(2)]


def candump(path: Path) -> Path:
    lines = [format_line(10**9 + 10_000_000 * i, "can0", f) for i, f in enumerate(FRAMES)]
    path.write_text("".join(lines))
    return path


def written(path: Path) -> Path:
    """Let python-can write the frames in the format that the suffix names."""
    with can.Logger(path) as writer:
        for index, frame in enumerate(FRAMES):
            message = can.Message(
                timestamp=1.0 + index / 100,
                arbitration_id=frame.arbitration_id,
                data=frame.data,
                is_extended_id=False,
            )
            writer(message)
        writer(can.Message(timestamp=2.0, arbitration_id=0x12345, is_extended_id=True))
    return path


@pytest.mark.parametrize("name", ["drive.log", "drive", "drive.candump"])
def test_candump(tmp_path: Path, name: str) -> None:
    entries = list(read_log(str(candump(tmp_path / name))))
    assert [entry.frame for entry in entries] == FRAMES
    assert entries[1].time_s == 1.01


@pytest.mark.parametrize("suffix", [".asc", ".blf", ".csv", ".trc", ".log"])
def test_formats_of_python_can(tmp_path: Path, suffix: str) -> None:
    entries = list(read_log(str(written(tmp_path / f"drive{suffix}"))))
    assert [entry.frame for entry in entries] == [*FRAMES, None]
    spans = [entry.time_s - entries[0].time_s for entry in entries[:-1]]
    assert spans == pytest.approx([index / 100 for index in range(7)], abs=2e-3)


def test_standard_input(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = candump(tmp_path / "drive.log").read_text()
    monkeypatch.setattr("sys.stdin", io.StringIO(text))
    assert [entry.frame for entry in read_log("-")] == FRAMES
    monkeypatch.setattr("sys.stdin", io.StringIO("\nhello\n"))
    with pytest.raises(LogError, match=r"^standard input:2: found 'hello'"):
        list(read_log("-"))


def test_empty_lines_are_no_entries(tmp_path: Path) -> None:
    path = candump(tmp_path / "drive.log")
    path.write_text("\n" + path.read_text().replace("\n", "\n\n"))
    assert len(list(read_log(str(path)))) == len(FRAMES)


@pytest.mark.parametrize("name", ["none.log", "none.asc", "none.blf"])
def test_a_missing_file(tmp_path: Path, name: str) -> None:
    path = str(tmp_path / name)
    with pytest.raises(LogError, match=f"^{path}: cannot be read: No such file or directory$"):
        list(read_log(path))


def test_a_folder(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="Is a directory"):
        list(read_log(str(tmp_path)))


def test_a_garbled_line_is_named(tmp_path: Path) -> None:
    path = candump(tmp_path / "drive.log")
    lines = path.read_text().splitlines()
    lines[4] = lines[4][:-1]
    path.write_text("\n".join(lines))
    with pytest.raises(LogError, match=rf"^{path}:5: found '\(0000000001.04.*expected a line"):
        list(read_log(str(path)))


def test_a_long_line_is_shortened(tmp_path: Path) -> None:
    path = tmp_path / "drive.log"
    path.write_bytes(b"\xff" * 5000)
    with pytest.raises(LogError) as caught:
        list(read_log(str(path)))
    assert len(str(caught.value)) < 300 + len(str(path))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["empty.log", "empty.asc", "empty.trc"])
def test_a_log_without_a_frame(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_text("")
    with pytest.raises(LogError, match=r"holds no CAN frame"):
        list(read_log(str(path)))


@pytest.mark.parametrize("suffix", [".blf", ".csv"])
def test_garbage_in_other_formats(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"garbage{suffix}"
    path.write_bytes(b"this is no log at all\n" * 20)
    with pytest.raises(LogError, match=f"^{path}(:2)?: (cannot be read as|holds no CAN frame)"):
        list(read_log(str(path)))


def test_a_garbled_line_of_an_asc_log_is_named(tmp_path: Path) -> None:
    path = written(tmp_path / "drive.asc")
    lines = path.read_text().splitlines()
    place = next(i for i, line in enumerate(lines) if " 101 " in line)
    lines[place] = lines[place].replace(" DA ", " XX ")
    path.write_text("\n".join(lines))
    with pytest.raises(LogError, match=rf"^{path}:{place + 1}: cannot be read as ASC log"):
        list(read_log(str(path)))


def test_a_blf_log_that_was_cut(tmp_path: Path) -> None:
    path = written(tmp_path / "drive.blf")
    path.write_bytes(path.read_bytes()[:160])
    with pytest.raises(LogError, match=r"cannot be read as BLF log|holds no CAN frame"):
        list(read_log(str(path)))


def test_standard_input_that_is_no_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"\xff\xfe\n"), "utf-8"))
    with pytest.raises(LogError, match=r"^standard input:1: found '.*', expected a line of"):
        list(read_log("-"))


@pytest.mark.parametrize("suffix", [".log", ".asc", ".csv", ".trc"])
def test_a_line_without_an_end_is_not_read_to_its_end(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"drive{suffix}"
    path.symlink_to("/dev/zero")
    with pytest.raises(LogError, match=rf"^{path}:1: a line without an end, expected a CAN log$"):
        list(read_log(str(path)))
