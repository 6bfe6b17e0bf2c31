"""The status: its files agree with each other and with the code, its bytes with other codecs."""

from __future__ import annotations

import itertools
import math
import timeit
from enum import IntEnum
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import get_types_from_idl, get_types_from_msg

from safety_island.can.mode import OutputMode
from safety_island.control.status import ControllerLimit
from safety_island.gate.reason import SampleReason
from safety_island.gate.warning import InputWarning
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages import codec, registry
from safety_island.messages.arm import ARM, ArmResult
from safety_island.messages.errors import DecodeError, DecodeReason
from safety_island.messages.status import (
    INPUT_STATUS,
    NO_VALUE,
    SIZE,
    STATUS,
    StatusWriter,
    decode_status,
)
from safety_island.messages.status_fields import InputStatus, Status
from safety_island.messages.wire import Time
from safety_island.node.inputs import INPUTS
from tests.messages.oracle import OWN_MSG_FILES, cyclone_bytes, rosbags_bytes

PREFIXES: dict[str, list[tuple[str, Any]]] = {
    STATUS: [
        ("STATE", State),
        ("REASON", Reason),
        ("ARM", ArmResult),
        ("OUTPUT", OutputMode),
        ("LIMIT", ControllerLimit),
    ],
    INPUT_STATUS: [("REFUSED", SampleReason), ("WARNING", InputWarning)],
}


@pytest.fixture
def writer() -> StatusWriter:
    """A status with something in every kind of field."""
    made = StatusWriter()
    made.fields.stamp.sec[0], made.fields.stamp.nanosec[0] = -5, 999_999_999
    made.fields.tick[0], made.fields.arm_nonce[0] = 7, 2**64 - 1
    made.fields.lateral_error[0], made.fields.command_angle[0] = -0.125, 0.25
    made.fields.state[0], made.fields.solver_status[0] = State.SILENT, -7
    made.fields.armed[0] = np.bool_(True)
    made.inputs[1].refused[SampleReason.NOT_FINITE] += 3
    made.inputs[4].age[0] = np.float64(0.5)
    made.inputs[2].writer_guid[:] = bytes(range(16))
    return made


@pytest.mark.parametrize("name", [STATUS, INPUT_STATUS, ARM])
def test_the_msg_files_say_what_the_idl_files_say(name: str) -> None:
    short = name.rpartition("/")[2]
    said = get_types_from_msg((OWN_MSG_FILES / f"{short}.msg").read_text("utf-8"), name)[name]
    idl = OWN_MSG_FILES.parents[2] / "idl" / "safety_island_msgs" / "msg" / f"{short}.idl"
    lines = [
        line for line in idl.read_text("utf-8").splitlines() if not line.startswith(("//", "#"))
    ]
    assert get_types_from_idl("\n".join(lines))[name] == said


@pytest.mark.parametrize("name", PREFIXES)
def test_the_numbers_of_the_files_are_those_of_the_code(name: str) -> None:
    constants = dict(registry.struct_of(name).constants)
    for prefix, enum in PREFIXES[name]:
        found = {k: v for k, v in constants.items() if k.startswith(f"{prefix}_")}
        again = f"write {prefix}_ of {name} anew, in the .idl and in the .msg file"
        assert found == {f"{prefix}_{member.name}": int(member) for member in enum}, again
    assert constants["NO_VALUE"] == NO_VALUE


def test_every_refusal_has_its_place() -> None:
    places = {field.name: field.type for field in registry.struct_of(INPUT_STATUS).fields}
    assert places["refused"].size >= len(SampleReason)  # type: ignore[union-attr]
    assert len(StatusWriter().inputs) == len(INPUTS)


@pytest.mark.parametrize(("name", "values"), [(STATUS, Status), (INPUT_STATUS, InputStatus)])
def test_the_values_have_the_names_of_the_message(name: str, values: Any) -> None:
    assert list(values._fields) == [field.name for field in registry.struct_of(name).fields]


def test_bytes_equal_those_of_other_serializers(writer: StatusWriter) -> None:
    data = writer.encode()
    message = codec.decode(STATUS, data)
    assert codec.encode(STATUS, message) == data
    assert rosbags_bytes(STATUS, message) == data
    assert cyclone_bytes(STATUS, message) == data
    assert len(data) == SIZE < 1400  # one packet on a LAN


def test_what_was_written_is_read(writer: StatusWriter) -> None:
    found = decode_status(writer.encode())
    assert (found.stamp, found.tick, found.arm_nonce) == (Time(-5, 999_999_999), 7, 2**64 - 1)
    assert (found.lateral_error, found.command_angle) == (-0.125, 0.25)
    assert (found.state, found.solver_status) == (State.SILENT, -7)
    assert (found.armed, found.engaged) == (True, False)
    assert found.inputs[1].refused[SampleReason.NOT_FINITE] == 3
    assert sum(map(sum, (item.refused for item in found.inputs))) == 3
    assert found.inputs[4].age == 0.5
    assert found.inputs[2].writer_guid == bytes(range(16))


def test_what_has_no_value_says_so(writer: StatusWriter) -> None:
    found = decode_status(StatusWriter().encode())
    assert {found.subject, found.mpc_status, found.guard_verdict} == {NO_VALUE}
    assert math.isnan(found.lateral_error) and math.isnan(found.command_velocity)
    assert {item.age for item in found.inputs} == {math.inf}


def test_either_byte_order_and_padding_are_read(writer: StatusWriter) -> None:
    data = writer.encode()
    big = rosbags_bytes(STATUS, codec.decode(STATUS, data), little_endian=False)
    assert repr(decode_status(big)) == repr(decode_status(data + bytes(3)))
    with pytest.raises(DecodeError) as refused:
        decode_status(data + bytes(4))
    assert refused.value.reason is DecodeReason.TRAILING


def test_numbers_of_a_newer_island_are_read(writer: StatusWriter) -> None:
    writer.fields.reason[0] = 200
    assert decode_status(writer.encode()).reason == 200


def test_a_value_is_copied_and_not_shared(writer: StatusWriter) -> None:
    before = writer.encode()
    writer.fields.tick[0] += 1
    assert decode_status(before).tick + 1 == decode_status(writer.encode()).tick == 8
    assert writer.record["tick"][0] == 8


def test_the_inputs_are_written_at_once(writer: StatusWriter) -> None:
    counts = [np.arange(i, i + 32, dtype=np.uint32) for i in range(len(INPUTS))]
    rows = [
        (counts[i].tobytes(), bytes([i] * 16), i, 2, 3, 4, 0.5 + i, math.inf, 0.25, 7, 8, 9)
        for i in range(len(INPUTS))
    ]
    writer.pack_inputs()(*itertools.chain.from_iterable(rows))
    found = decode_status(writer.encode())
    assert found.inputs == tuple(
        InputStatus(tuple(counts[i].tolist()), *rows[i][1:]) for i in range(len(INPUTS))
    )
    assert (found.tick, found.state) == (7, State.SILENT)


def test_neighbours_are_written_at_once(writer: StatusWriter) -> None:
    writer.pack("tick", "commands", "memory", "lateral_error")(2**64 - 1, 5, 6, -0.5)
    writer.pack("arm_result", "other_control_writers", "degraded")(1, 2, True)
    found = decode_status(writer.encode())
    assert (found.tick, found.commands, found.memory) == (2**64 - 1, 5, 6)
    assert (found.lateral_error, found.yaw_error != found.yaw_error) == (-0.5, True)
    assert (found.arm_result, found.other_control_writers, found.degraded) == (1, 2, True)


def test_only_neighbours_are_written_at_once(writer: StatusWriter) -> None:
    with pytest.raises(ValueError, match="tick, memory: not neighbours in the message"):
        writer.pack("tick", "memory")
    with pytest.raises(KeyError):
        writer.pack("tock")


def test_a_status_is_cheap(writer: StatusWriter) -> None:
    assert min(timeit.repeat(writer.encode, number=1000, repeat=5)) / 1000 < 5e-6


def test_enumerations_have_no_value_at_the_place_of_none() -> None:
    enums: list[type[IntEnum]] = [State, Reason, SampleReason]
    assert all(max(enum) < NO_VALUE for enum in enums)
