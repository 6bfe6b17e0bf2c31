# SPDX-License-Identifier: Apache-2.0
"""The status: its files agree with each other and with the code, its bytes with other codecs."""

from __future__ import annotations

import struct
from enum import IntEnum
from typing import Any

import pytest
from rosbags.typesys import get_types_from_idl, get_types_from_msg

from safety_island.command.mode import OutputMode
from safety_island.control.status import ControllerLimit
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.warning import InputWarning
from safety_island.kernel.cdr import DecodeReason
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages import codec, registry
from safety_island.messages.arm import ARM, ArmResult
from safety_island.messages.errors import DecodeError
from safety_island.messages.status import (
    INPUT_STATUS,
    NO_VALUE,
    SIZE,
    STATUS,
    STATUS_RECORD,
    decode_status,
    encode_status,
)
from safety_island.messages.status_fields import InputStatus, Status
from safety_island.messages.wire import Time
from safety_island.node.inputs import INPUTS
from tests.messages.oracle import OWN_MSG_FILES, cyclone_bytes, rosbags_bytes
from tests.messages.samples import status_bytes, status_of_nothing

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


def known() -> Status:
    """Return a status with something in every kind of field."""
    status = status_of_nothing()
    rows = list(status.inputs)
    counts = [0] * 32
    counts[SampleReason.NOT_FINITE] = 3
    rows[1] = rows[1]._replace(refused=tuple(counts))
    rows[2] = rows[2]._replace(writer_guid=bytes(range(16)))
    rows[4] = rows[4]._replace(age=0.5, other_writers=255)
    return status._replace(
        stamp=Time(-5, 999_999_999),
        tick=7,
        arm_nonce=2**64 - 1,
        lateral_error=-0.125,
        command_angle=0.25,
        state=int(State.SILENT),
        solver_status=-7,
        armed=True,
        inputs=tuple(rows),
    )


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
    assert STATUS_RECORD["inputs"].shape == (len(INPUTS),)


@pytest.mark.parametrize(("name", "values"), [(STATUS, Status), (INPUT_STATUS, InputStatus)])
def test_the_values_have_the_names_of_the_message(name: str, values: Any) -> None:
    assert list(values._fields) == [field.name for field in registry.struct_of(name).fields]


def test_bytes_equal_those_of_other_serializers() -> None:
    data = encode_status(known())
    message = codec.decode(STATUS, data)
    assert codec.encode(STATUS, message) == data
    assert rosbags_bytes(STATUS, message) == data
    assert cyclone_bytes(STATUS, message) == data
    assert len(data) == SIZE < 1400  # one packet on a LAN


def test_what_was_written_is_read() -> None:
    assert repr(decode_status(encode_status(known()))) == repr(known())
    assert encode_status(decode_status(status_bytes())) == status_bytes()


@pytest.mark.parametrize("wrong", [{"tick": -1}, {"state": 256}, {"overruns": 2**32}])
def test_what_does_not_fit_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(struct.error):
        encode_status(known()._replace(**wrong))


def test_either_byte_order_and_padding_are_read() -> None:
    data = encode_status(known())
    big = rosbags_bytes(STATUS, codec.decode(STATUS, data), little_endian=False)
    assert repr(decode_status(big)) == repr(decode_status(data + bytes(3)))
    with pytest.raises(DecodeError) as refused:
        decode_status(data + bytes(4))
    assert refused.value.reason is DecodeReason.TRAILING


def test_numbers_of_a_newer_island_are_read() -> None:
    assert decode_status(encode_status(known()._replace(reason=200))).reason == 200


def test_enumerations_have_no_value_at_the_place_of_none() -> None:
    enums: list[type[IntEnum]] = [State, Reason, SampleReason]
    assert all(max(enum) < NO_VALUE for enum in enums)
