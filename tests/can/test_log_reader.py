# SPDX-License-Identifier: Apache-2.0
"""Logs of candump and of python-can, and what is said of those that cannot be read."""

from __future__ import annotations

import bz2
import gzip
import io
import lzma
from collections.abc import Callable
from pathlib import Path

import can
import pytest

from safety_island.can.candump import format_line
from safety_island.can.log_reader import LogError, LogNotes, read_log
from safety_island.platform.interfaces import CanFrame
from tests.can.rig import triple

FRAMES = [*triple(1), CanFrame(0x555, b"abc"), *triple(2)]
SUFFIXES = (".asc", ".blf", ".csv", ".trc", ".log")


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


def frames(path: Path, notes: LogNotes | None = None) -> list[CanFrame | None]:
    return [entry.frame for entry in read_log(str(path), notes)]


def noted(path: Path) -> tuple[list[CanFrame | None], list[str]]:
    """The frames of a log, and what is said of it without its name."""
    notes = LogNotes("LOG")
    return frames(path, notes), notes.sentences()


@pytest.mark.parametrize("name", ["drive.log", "drive", "drive.candump"])
def test_candump(tmp_path: Path, name: str) -> None:
    entries = list(read_log(str(candump(tmp_path / name))))
    assert [entry.frame for entry in entries] == FRAMES
    assert entries[1].time_s == 1.01
    assert {entry.channel for entry in entries} == {"can0"}


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_formats_of_python_can(tmp_path: Path, suffix: str) -> None:
    entries = list(read_log(str(written(tmp_path / f"drive{suffix}"))))
    assert [entry.frame for entry in entries] == [*FRAMES, None]
    spans = [entry.time_s - entries[0].time_s for entry in entries[:-1]]
    assert spans == pytest.approx([index / 100 for index in range(7)], abs=2e-3)


def feed(monkeypatch: pytest.MonkeyPatch, data: bytes) -> None:
    stream = io.BufferedReader(io.BytesIO(data))
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(stream))


@pytest.mark.parametrize("pack", [bytes, gzip.compress])
def test_standard_input(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, pack: Callable[[bytes], bytes]
) -> None:
    feed(monkeypatch, pack(candump(tmp_path / "drive.log").read_bytes()))
    assert [entry.frame for entry in read_log("-")] == FRAMES


def test_standard_input_that_is_no_log(monkeypatch: pytest.MonkeyPatch) -> None:
    feed(monkeypatch, b"\nhello\n")
    with pytest.raises(LogError, match=r"^standard input:2: found 'hello', expected a line"):
        list(read_log("-"))
    feed(monkeypatch, b"\xff\xfe\xfd\n")
    with pytest.raises(LogError, match=r"^standard input:1: found '"):
        list(read_log("-"))


def test_empty_lines_are_no_entries(tmp_path: Path) -> None:
    path = candump(tmp_path / "drive.log")
    path.write_text("\n" + path.read_text().replace("\n", "\n\n"))
    assert noted(path) == (FRAMES, [])


PACKERS: dict[str, Callable[[bytes], bytes]] = {
    ".gz": gzip.compress,
    ".bz2": bz2.compress,
    ".xz": lzma.compress,
}


@pytest.mark.parametrize("packed", PACKERS)
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_packed_log_is_read(tmp_path: Path, suffix: str, packed: str) -> None:
    plain = written(tmp_path / f"drive{suffix}")
    path = tmp_path / f"drive{suffix}{packed}"
    path.write_bytes(PACKERS[packed](plain.read_bytes()))
    assert noted(path) == ([*FRAMES, None], [])


@pytest.mark.parametrize("suffix", [".asc", ".blf", ".trc", ".log"])
def test_a_log_is_known_by_its_content(tmp_path: Path, suffix: str) -> None:
    path = written(tmp_path / f"drive{suffix}").rename(tmp_path / "upload.dat")
    assert noted(path) == ([*FRAMES, None], [])


@pytest.mark.parametrize("keep", [0.5, 0.9])
def test_a_packed_log_that_was_cut_is_reported_as_far_as_it_goes(
    tmp_path: Path, keep: float
) -> None:
    lines = [
        format_line(10**9 + 123_456_789 * i, "can0", f)
        for i in range(3000)
        for f in triple(i, stamp_ns=i * 7_919_113_337)
    ]
    data = gzip.compress("".join(lines).encode())
    path = tmp_path / "drive.log.gz"
    path.write_bytes(data[: int(len(data) * keep)])
    found, notes = noted(path)
    assert len(found) > 1000
    assert any(note.startswith("LOG: cut or damaged, the rest is lost: ") for note in notes)


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (b"", "is empty"),
        (b"PK\x03\x04 and more", "packed as ZIP; unpack it first"),
        (b"\x28\xb5\x2f\xfd and more", "packed by zstd; unpack it first"),
        (b"MDF     4.10", "MDF .MF4. log; convert it"),
        (b"\x1f\x8b", "cut or damaged"),
        (gzip.compress(b"", mtime=0)[:12], "cut or damaged"),
        (b"\x1f\x8b and no more of it", "cannot be read: "),
        (gzip.compress(b"\xff\x00\xfe" * 9, mtime=0), "found '.*, expected a line of 'candump"),
    ],
)
@pytest.mark.parametrize("suffix", [".log.gz", ".blf", ""])
def test_what_is_no_log_is_told_in_words(
    tmp_path: Path, data: bytes, told: str, suffix: str
) -> None:
    path = tmp_path / f"x{suffix}"
    path.write_bytes(data)
    with pytest.raises(LogError, match=told if suffix != ".blf" else None) as caught:
        list(read_log(str(path)))
    text = str(caught.value)
    assert text.startswith(str(path))
    assert text.isascii() and text.isprintable()


def test_a_torn_last_line_is_told_and_what_came_before_is_read(tmp_path: Path) -> None:
    path = candump(tmp_path / "drive.log")
    text = path.read_text()
    for length in range(len(text) - 42, len(text) - 1):
        path.write_text(text[:length])
        found, notes = noted(path)
        assert found == FRAMES[:-1], text[:length]
        assert len(notes) == (not text[:length].endswith("\n"))
        assert all(note.startswith("LOG:7: the last line is torn: '(") for note in notes)


@pytest.mark.parametrize("suffix", [".asc", ".csv", ".trc"])
def test_a_torn_last_line_of_other_formats(tmp_path: Path, suffix: str) -> None:
    path = written(tmp_path / f"drive{suffix}")
    lines = path.read_text().splitlines()
    last = max(i for i, line in enumerate(lines) if "102" in line)
    path.write_text("\n".join([*lines[:last], lines[last][:-4]]))
    found, notes = noted(path)
    assert found == FRAMES[:-1]
    assert [note.startswith(f"LOG:{last + 1}: the last line is torn: ") for note in notes] == [True]


@pytest.mark.parametrize("bom", ["utf-8-sig", "utf-16"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_a_log_from_windows(tmp_path: Path, bom: str, end: str) -> None:
    path = candump(tmp_path / "drive.log")
    path.write_bytes(path.read_text().replace("\n", end).encode(bom))
    assert noted(path) == (FRAMES, [])


def test_lines_of_other_programs_are_counted_and_the_first_is_named(tmp_path: Path) -> None:
    path = candump(tmp_path / "drive.log")
    lines = path.read_text().splitlines(keepends=True)
    lines.insert(3, "interface = can0, family = 29\n")
    lines.insert(6, "[  12.3] \xfcber can0: bus-off\n")
    path.write_text("".join(lines))
    assert noted(path) == (
        FRAMES,
        ["LOG:4: found 'interface = can0, family = 29'; 2 lines are not of this log and left out"],
    )


@pytest.mark.parametrize("stamp", ["1700000000.123456", "000.000000", "2023-11-14 22:13:20.123456"])
@pytest.mark.parametrize("direction", ["", "  RX - - ", "  TX B E "])
def test_lines_of_candump_on_a_screen(tmp_path: Path, stamp: str, direction: str) -> None:
    path = tmp_path / "drive.txt"
    path.write_text(
        f" ({stamp})  can0{direction}  100   [8]  48 E8 01 00 E0 5E F8 FF   'H....^..'\n"
        f" ({stamp})  can0{direction}  123  [03]  11 22 33\n"
        f" ({stamp})  can0{direction}  123   [8]  remote request\n"
        f" ({stamp})  can0{direction}  20000004   [8]  00 04 00 00 00 00 00 00   ERRORFRAME\n"
        f" ({stamp})  can0{direction}  0E0014F2   [0]\n"
    )
    entries = list(read_log(str(path)))
    assert [entry.frame for entry in entries] == [triple()[0], None, None, None, None]
    assert [entry.is_error for entry in entries] == [False, False, False, True, False]


@pytest.mark.parametrize("line", ["123##1112233", "123#R8", "123#R8_C", "0E0014F2#", "20000004#00"])
@pytest.mark.parametrize("direction", ["", " R", " T"])
def test_other_frames_of_candump(tmp_path: Path, line: str, direction: str) -> None:
    path = tmp_path / "drive.log"
    path.write_text(f"(1700000000.000000) can0 {line}{direction}\n")
    assert noted(path) == ([None], [])


ASC_FRAMES = """\
   0.100000 1  100             Rx   d 8 48 E8 01 00 E0 5E F8 FF
   0.000200 1  101             Rx   d 8 DA 2F 00 00 24 FA FF FF
   0.000200 1  102             Tx   d 8 02 0B 2A 00 39 30 00 00
"""


@pytest.mark.parametrize(
    "head",
    [
        "date Die Nov 14 22:13:20.000 2023\nbase hex  timestamps relative\n",
        "date Thu Sep 2 09:37:49 am 2021\nbase hex  timestamps relative\ninternal events logged\n"
        "// version 9.0.0\nBegin Triggerblock Thu Sep 2 09:37:49 am 2021\n"
        "   0.000000 Start of measurement\n",
    ],
)
def test_asc_times_relative_to_the_line_before(tmp_path: Path, head: str) -> None:
    path = tmp_path / "drive.asc"
    path.write_text(head + ASC_FRAMES)
    entries = list(read_log(str(path)))
    assert [entry.frame for entry in entries] == list(triple())
    assert [entry.time_s for entry in entries] == pytest.approx([0.1, 0.1002, 0.1004])
    assert {entry.channel for entry in entries} == {"1"}


def test_a_garbled_line_of_an_asc_log_is_left_out(tmp_path: Path) -> None:
    path = written(tmp_path / "drive.asc")
    lines = path.read_text().splitlines(keepends=True)
    place = next(i for i, line in enumerate(lines) if " 101 " in line)
    lines[place] = lines[place].replace(" DA ", " XX ")
    path.write_text("".join(lines))
    found, notes = noted(path)
    assert found == [FRAMES[0], *FRAMES[2:], None]
    assert len(notes) == 1 and notes[0].startswith(f"LOG:{place + 1}: found '")


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
    lines = path.read_text().splitlines(keepends=True)
    lines[4] = lines[4][:-2] + "\n"
    path.write_text("".join(lines))
    found, (note,) = noted(path)
    assert found == [*FRAMES[:4], *FRAMES[5:]]
    assert note.startswith("LOG:5: found '(0000000001.04")
    assert note.endswith("; 1 line is not of this log and left out")


def test_a_long_line_is_shortened(tmp_path: Path) -> None:
    path = tmp_path / "drive.log"
    path.write_bytes(b"\xff" * 5000)
    with pytest.raises(LogError) as caught:
        list(read_log(str(path)))
    assert len(str(caught.value)) < 500 + len(str(path))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["empty.log", "empty.asc", "empty.trc", "empty.blf"])
def test_a_log_without_a_frame(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_text("")
    with pytest.raises(LogError, match=f"^{path}: is empty"):
        list(read_log(str(path)))
    path.write_text("\n\n")
    with pytest.raises(LogError, match=r"holds no CAN frame|cannot be read as BLF"):
        list(read_log(str(path)))


@pytest.mark.parametrize("suffix", [".blf", ".csv"])
def test_garbage_in_other_formats(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"garbage{suffix}"
    path.write_bytes(b"this is no log at all\n" * 20)
    with pytest.raises(LogError, match=f"^{path}(:2)?: (cannot be read as BLF|found 'this is no)"):
        list(read_log(str(path)))


def test_a_blf_log_without_frames(tmp_path: Path) -> None:
    path = tmp_path / "drive.blf"
    can.BLFWriter(path).stop()
    with pytest.raises(LogError, match="holds no CAN frame"):
        list(read_log(str(path)))


def long_blf(path: Path) -> bytes:
    """A log of several containers."""
    with can.BLFWriter(path, compression_level=0) as writer:
        for number in range(9000):
            frame = triple(number)[number % 3]
            writer(can.Message(timestamp=1.0 + number / 100, arbitration_id=frame.arbitration_id,
                               data=frame.data, is_extended_id=False))  # fmt: skip
    return path.read_bytes()


def test_a_blf_log_that_was_cut_is_reported_as_far_as_it_goes(tmp_path: Path) -> None:
    path = tmp_path / "drive.blf"
    data = long_blf(path)
    assert len(frames(path)) == 9000
    for length in (len(data) // 2, len(data) - 8, len(data) - 100):
        path.write_bytes(data[:length])
        found, (note,) = noted(path)
        assert len(found) > 2000
        assert note.startswith("LOG: cut or damaged, the rest is lost: ")
    for length in (1, 4, 100, 144, 160):
        path.write_bytes(data[:length])
        with pytest.raises(LogError, match=r"cannot be read as BLF log|holds no CAN|found '"):
            list(read_log(str(path)))


def test_a_blf_log_with_damaged_bytes_does_no_harm(tmp_path: Path) -> None:
    path = written(tmp_path / "drive.blf")
    data = path.read_bytes()
    for place in range(len(data)):
        path.write_bytes(data[:place] + bytes([data[place] ^ 0x55]) + data[place + 1 :])
        notes = LogNotes("LOG")
        try:
            list(read_log(str(path), notes))
        except LogError as error:
            assert str(error).isascii()
        assert all(text.isascii() and text.isprintable() for text in notes.sentences())


def test_standard_input_that_is_no_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "sys.stdin", io.TextIOWrapper(io.BufferedReader(io.BytesIO(b"\xff\xfe\n")), "utf-8")
    )
    with pytest.raises(LogError, match=r"^standard input:1: found '.*', expected a line of"):
        list(read_log("-"))


@pytest.mark.parametrize("suffix", [".log", ".asc", ".csv", ".trc"])
def test_a_line_without_an_end_is_not_read_to_its_end(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"drive{suffix}"
    path.symlink_to("/dev/zero")
    with pytest.raises(LogError, match=rf"^{path}:1: a line without an end, expected a CAN log$"):
        list(read_log(str(path)))
