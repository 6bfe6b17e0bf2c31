# SPDX-License-Identifier: Apache-2.0
"""The DBC file: current, what cantools makes of it, and every mutation of it is found (row 70)."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cantools
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety_island.can.command import Command
from safety_island.can.dbc import dbc_text
from safety_island.can.dbc_check import check_dbc
from safety_island.can.encoder import Rejection, encode
from safety_island.command.frames import FRAMES, LATERAL, LONGITUDINAL
from safety_island.command.mode import OutputMode
from tests.can.rig import triple

FILE = Path(__file__).parents[2] / "config/can/safety_island.dbc"
DATABASE: Any = cantools.database.load_string(dbc_text(), "dbc")
INT32 = st.integers(-(2**31), 2**31 - 1)


def test_the_committed_file_is_current() -> None:
    """When this fails: island can dbc --output config/can/safety_island.dbc."""
    assert FILE.read_text() == dbc_text()


def test_it_agrees_with_the_encoder() -> None:
    assert check_dbc(dbc_text()) == []


@given(st.tuples(INT32, INT32, INT32, INT32), st.integers(0, 65535), st.integers(0, 2**32 - 1))
def test_cantools_reads_what_the_encoder_wrote(
    raw: tuple[int, int, int, int], sequence: int, timestamp_ms: int
) -> None:
    signals = LATERAL.signals + LONGITUDINAL.signals
    angle, rate, velocity, acceleration = (
        number / signal.scale for number, signal in zip(raw, signals, strict=True)
    )
    command = Command(angle, rate, velocity, acceleration, is_defined_acceleration=True)
    frames = encode(command, OutputMode.DDS_AND_CAN, sequence, timestamp_ms * 1_000_000)
    assert not isinstance(frames, Rejection)
    found: dict[str, Any] = {}
    for frame in frames:
        decoded = DATABASE.decode_message(frame.arbitration_id, frame.data, scaling=False)
        found |= decoded
        assert DATABASE.encode_message(frame.arbitration_id, decoded, scaling=False) == frame.data
    assert [found[signal.name] for signal in signals] == list(raw)
    assert (found["sequence"], found["timestamp"]) == (sequence, timestamp_ms)
    assert found["mode"] == "DDS_AND_CAN"
    assert [found[f"{n}_defined"] for n in ("steering_rate", "acceleration", "jerk")] == [0, 1, 0]


def test_cantools_scales_as_the_contract_says() -> None:
    found: dict[str, Any] = {}
    for frame in triple():
        found |= DATABASE.decode_message(frame.arbitration_id, frame.data)
    values = [found[signal.name] for frame in FRAMES[:2] for signal in frame.signals]
    assert values == pytest.approx([0.125, -0.5, 12.25, -1.5], abs=1e-12)


SIGNAL_LINE = re.compile(
    r'^( SG_ \w+ : )(\d+)\|(\d+)@(\d)([+-]) \(([\d.]+),(\d+)\) \[(.+)\|(.+)\] "(.*)" (\w+)$',
    re.MULTILINE,
)
FIELDS = ("start", "length", "order", "sign", "factor", "offset", "low", "high", "unit")
CHANGES: dict[str, Callable[[str], str]] = {
    "start": lambda old: str(int(old) + 1),
    "length": lambda old: str(int(old) - 1),
    "order": lambda old: "0",
    "sign": lambda old: "+" if old == "-" else "-",
    "factor": lambda old: "0.01",
    "offset": lambda old: "1",
    "low": lambda old: "-7",
    "high": lambda old: "7",
    "unit": lambda old: "furlong",
}
SIGNAL_LINES = list(SIGNAL_LINE.finditer(dbc_text()))


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("number", range(len(SIGNAL_LINES)))
def test_row_70_every_changed_field_of_a_signal_is_found(number: int, field: str) -> None:
    text, match = dbc_text(), SIGNAL_LINES[number]
    group = FIELDS.index(field) + 2
    changed = CHANGES[field](match[group])
    assert changed != match[group]
    mutant = text[: match.start(group)] + changed + text[match.end(group) :]
    assert check_dbc(mutant), f"{field} of {match[0]}"


@pytest.mark.parametrize("number", range(len(SIGNAL_LINES)))
def test_row_70_a_missing_or_renamed_signal_is_found(number: int) -> None:
    text, match = dbc_text(), SIGNAL_LINES[number]
    name = match[1].split()[1]
    without = text.replace(match[0] + "\n", "")
    without = re.sub(rf"^(CM_ SG_|VAL_) \d+ {name} .*\n", "", without, flags=re.MULTILINE)
    assert any(f"{name}: is missing" in line for line in check_dbc(without))
    renamed = re.sub(rf"\b{name}\b", f"{name}_2", text)
    assert any(f"{name}_2: no signal of this name" in line for line in check_dbc(renamed))


@pytest.mark.parametrize(
    ("old", "new", "difference"),
    [
        ("BO_ 256 ", "BO_ 512 ", "0x100 LATERAL_COMMAND: 0 messages"),
        ("BO_ 256 LATERAL_COMMAND", "BO_ 256 SIDEWAYS", "name is SIDEWAYS"),
        ("LATERAL_COMMAND: 8", "LATERAL_COMMAND: 9", "length is 9, expected 8"),
        ("BO_ 256 ", "BO_ 2147483904 ", "0x100: extended identifier is True"),
        ('1 "CAN_ONLY"', '1 "CAN"', "names of values"),
        (" SG_ sequence :", " SG_ sequence M :", "multiplexing is True"),
        ("BO_ 257", "BOX_ 257", "not a valid DBC file"),
    ],
)
def test_row_70_other_changes_are_found(old: str, new: str, difference: str) -> None:
    text = dbc_text()
    assert old in text
    found = check_dbc(text.replace(old, new))
    assert any(difference in line for line in found), found


def test_row_70_what_only_the_round_trip_shows_is_found() -> None:
    """A signal that is a float by an attribute of its own, with every other field unchanged."""
    found = check_dbc(dbc_text() + "SIG_VALTYPE_ 256 steering_tire_angle : 1;\n")
    assert any("0x100 steering_tire_angle: decodes to" in line for line in found), found


def test_row_70_overlapping_signals_are_found() -> None:
    mutant = dbc_text().replace("rotation_rate : 32|32", "rotation_rate : 16|32")
    (difference,) = check_dbc(mutant)
    assert "overlapping" in difference


def test_row_70_the_same_identifier_twice_is_found() -> None:
    extra = "BO_ 256 COPY: 8 SafetyIsland\n\nCM_ "
    assert check_dbc(dbc_text().replace("CM_ ", extra, 1))


def test_other_messages_are_no_difference() -> None:
    extra = 'BO_ 1365 OTHER: 8 Vehicle\n SG_ speed : 0|8@1+ (1,0) [0|255] "" SafetyIsland\n\nCM_ '
    assert check_dbc(dbc_text().replace("CM_ ", extra, 1)) == []


def test_text_that_is_no_dbc() -> None:
    (difference,) = check_dbc("hello")
    assert difference.startswith("not a valid DBC file: ")
    assert "\n" not in difference
