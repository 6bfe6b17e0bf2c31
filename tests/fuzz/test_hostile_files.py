# SPDX-License-Identifier: Apache-2.0
"""Files made to do harm, each for a reason: every reader refuses them, or reads what is there."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from safety_island.replay import recording
from tests.fuzz.readers import FINDINGS, READERS, Reader
from tests.fuzz.test_readers import told_of
from tests.replay.runs import arrays_of

BY_NAME = {reader.name: reader for reader in READERS}
TEXTS = [reader for reader in READERS if "recording" not in reader.name]

ANY = {
    "empty": b"",
    "blank": b"\n \n\n",
    "NUL bytes": b"\0" * 5000,
    "byte order mark alone": b"\xef\xbb\xbf",
    "UTF-16": "a: 1\nb: 2\n".encode("utf-16"),
    "Latin-1": b"CONFIG_LOG_LEVEL=\xe4\n",
    "half a character": b"a: \xe2\x82",
    "surrogates": b"a: \xed\xa0\x80\n",
    "control characters": b"\x1b]0;title\x07\x1b[2J\x9b2J\n",
    "line separators": "a\u2028b\u2029c\x85d\x0be\x0cf\x1cg".encode(),
    "carriage returns": b"a\rb\rc",
    "one line of 2 MB": b"a" * (2 << 20),
    "many lines": b"a\n" * (1 << 15),
    "square brackets": b"[" * 2000,
    "square brackets in pairs": b"[" * 2000 + b"]" * 2000,
    "curly brackets": b"{" * 2000,
    "curly brackets behind a key": b"topics: " + b"{" * 2000,
    "maps in a map": b"".join(b" " * i + b"a:\n" for i in range(600)),
    "lists in a list": b"- " * 2000,
    "keys of keys": b"? " * 2000,
    "tags of XML": b"<a>" * 20_000,
    "zip without members": b"PK\x05\x06" + b"\0" * 18,
    "digits": b"9" * 5000,
    "percent signs": b"%s%n%x" * 100,
}

VALUES = (
    *("9" * 5000, "-" + "9" * 5000, "0x" + "f" * 5000, "0b_", "0x_", "-_", "0o8", "1:99:99", "0_"),
    *("1e999", "-1e999", ".nan", "-.inf", "~", "''", "[]", "{}", "[[[]]]", "2001-99-99", "=", "<<"),
    *("!!int ''", "!!int a", "!!bool a", "!!float a", "!!binary a", "!!timestamp a", "!!set [a]"),
    *("!!python/object/apply:os.abort []", "!a b", "&a *a", "*b", "&a [*a]", "&a {<<: *a}"),
    *("'\\x1b[2J'", '"\\e[2J"', '"\\0"', '"\\ud800"', '"\\U0010FFFF"', "|\n  a", ">-\n  b"),
)


def put(tmp_path: Path, reader: Reader, data: bytes) -> str:
    """Write a file and return what is told of it."""
    path = tmp_path / f"file{reader.suffix}"
    path.write_bytes(data)
    return told_of(reader, path)


@pytest.mark.parametrize("reader", READERS, ids=lambda reader: reader.name)
def test_what_is_no_such_file_at_all(reader: Reader, tmp_path: Path) -> None:
    for data in ANY.values():
        put(tmp_path, reader, data)


@pytest.mark.parametrize("reader", TEXTS, ids=lambda reader: reader.name)
def test_a_device_that_never_ends(reader: Reader, tmp_path: Path) -> None:
    path = tmp_path / f"file{reader.suffix}"
    path.symlink_to("/dev/zero")
    if reader.name not in ("dotconfig", "dds-text", "idl", "kconfig"):  # read as text, not by name
        assert told_of(reader, path)


def places(texts: Iterable[bytes]) -> list[tuple[bytes, bytes]]:
    """What stands before and after the first value of each key of ``key: value`` files."""
    found: dict[bytes, tuple[bytes, bytes]] = {}
    for text in texts:
        lines = text.splitlines(keepends=True)
        for number, line in enumerate(lines):
            key, _, value = line.partition(b":")
            around = b"".join(lines[:number]) + key + b": ", b"\n" + b"".join(lines[number + 1 :])
            if value.strip():
                found.setdefault(key.strip(), around)
    return list(found.values())


@pytest.mark.parametrize("name", ["bridge", "parameters"])
@pytest.mark.parametrize("value", VALUES, ids=range(len(VALUES)))
def test_values_that_no_key_of_a_yaml_file_has(name: str, value: str, tmp_path: Path) -> None:
    """Some keys of the parameters; tests/params/test_mutations.py goes through all."""
    reader = BY_NAME[name]
    for before, after in places(reader.good())[:25]:
        put(tmp_path, reader, before + value.encode() + after)


@pytest.mark.parametrize("name", ["bridge", "parameters"])
def test_aliases_that_multiply(name: str, tmp_path: Path) -> None:
    levels = [f"l{i}: &l{i} [{', '.join([f'*l{i - 1}'] * 10)}]" for i in range(1, 12)]
    text = "\n".join(["l0: &l0 [a, b]", *levels, "topics: *l11", "from_domain: *l11", "name: *l11"])
    assert put(tmp_path, BY_NAME[name], text.encode())
    merged = "\n".join(
        ["l0: &l0 {a: b}", *(f"l{i}: &l{i} {{<<: [*l{i - 1}, *l{i - 1}]}}" for i in range(1, 40))]
    )
    assert put(tmp_path, BY_NAME[name], merged.encode())


@pytest.mark.parametrize("name", ["dds-file", "dds-text"])
def test_entities_that_multiply_or_read_files(name: str, tmp_path: Path) -> None:
    entities = "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 12))
    bomb = f'<!DOCTYPE a [<!ENTITY a0 "{"a" * 100}">{entities}]><a>&a11;</a>'
    assert "not XML" in put(tmp_path, BY_NAME[name], bomb.encode())
    (tmp_path / "secret").write_text("hidden")
    outside = f'<!DOCTYPE a [<!ENTITY b SYSTEM "file://{tmp_path}/secret">]><Peer Address="&b;"/>'
    told = put(tmp_path, BY_NAME[name], outside.encode())
    assert told and "hidden" not in told


NUMBERS = ("9" * 5000, "-" + "9" * 5000, "1e999", "nan", "0x" + "f" * 5000, "٣", "²", "")


@pytest.mark.parametrize("name", ["kconfig-fragment", "dotconfig"])
@pytest.mark.parametrize("value", NUMBERS, ids=range(len(NUMBERS)))
def test_numbers_that_no_symbol_has(name: str, value: str, tmp_path: Path) -> None:
    text = f"CONFIG_LOG_LEVEL={value}\nCONFIG_DDS_DOMAIN_ID={value}\n"
    assert put(tmp_path, BY_NAME[name], text.encode())


@pytest.mark.parametrize("stamp", ["9" * 400, "9" * 5000, "0", "4294967296", "1" + "0" * 308])
def test_stamps_that_no_clock_shows(stamp: str, tmp_path: Path) -> None:
    frame = "100#48E80100E05EF8FF"
    log = f"(1.0) can0 {frame}\n({stamp}.0) can0 {frame}\n(2.0) can0 {frame}\n"
    put(tmp_path, BY_NAME["can.log"], log.encode())
    for name in ("can.csv", "can.asc", "can.trc"):
        (good,) = BY_NAME[name].good()
        for part in (b"1.03", b"30.0", b"0.03", b"1.000000"):
            put(tmp_path, BY_NAME[name], good.replace(part, stamp.encode(), 1))


@pytest.mark.parametrize("number", ["1e999", "9" * 400, "9" * 5000, "nan", "-0", "1e-400"])
def test_numbers_that_no_signal_has(number: str, tmp_path: Path) -> None:
    (good,) = BY_NAME["dbc"].good()
    for part in ("32", "(0.000001", "[-2147.483648", "64", "8 Safety", "BO_ 256"):
        head = part.rstrip("0123456789.-")
        put(tmp_path, BY_NAME["dbc"], good.replace(part.encode(), f"{head}{number}".encode(), 1))


def npz(**members: bytes) -> bytes:
    """A recording of which some members are replaced by other bytes."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays_of(ticks=4).items():
            member = io.BytesIO()
            np.lib.format.write_array(member, np.asarray(array))
            archive.writestr(f"{name}.npy", members.get(name, member.getvalue()))
    return data.getvalue()


def npy(header: str, data: bytes = b"") -> bytes:
    """An array as a file, with a head of one's own."""
    text = header.encode() + b"\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + data


HEADS = {
    "more than there is": "{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000, 15)}",
    "negative": "{'descr': '<f8', 'fortran_order': False, 'shape': (-1, 15)}",
    "overflow": "{'descr': '<f8', 'fortran_order': False, 'shape': (4294967296, 4294967296)}",
    "no size": "{'descr': '<U0', 'fortran_order': False, 'shape': (1000000000000,)}",
    "objects": "{'descr': '|O', 'fortran_order': False, 'shape': (1,)}",
    "brackets": "(" * 2000,
    "open": "{'descr': '<f8', 'shape': (",
    "code": "__import__('os').abort()",
    "escape": "{'descr': '\\d', 'fortran_order': False, 'shape': (1,)}",
    "structure": "{'descr': [('a', '<f8'), ('a', '<f8')], 'fortran_order': False, 'shape': (1,)}",
    "long": "{'descr': '<f8', 'fortran_order': False, 'shape': (1L,), }",
    "many dimensions": f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({'1, ' * 100})}}",
    "dates": "{'descr': '<M8[ns]', 'fortran_order': False, 'shape': (1,)}",
}


@pytest.mark.parametrize("head", HEADS)
def test_heads_of_arrays_that_lie(head: str, tmp_path: Path) -> None:
    for name in ("state", "deliver_mask", "output_cols", "params_json"):
        data = npz(**{name: npy(HEADS[head], b"\xff" * 64)})
        assert put(tmp_path, BY_NAME["recording"], data)


class Trap:
    """Unpickled, it would leave a file behind."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple[object, ...]:
        return Path.touch, (self.path,)


def test_no_pickle_is_opened(tmp_path: Path) -> None:
    data, trap = io.BytesIO(), tmp_path / "opened"
    np.save(data, np.array([Trap(trap)], dtype=object), allow_pickle=True)
    for name in ("state", "params_json"):
        assert "pickle" in put(tmp_path, BY_NAME["recording"], npz(**{name: data.getvalue()}))
    assert not trap.exists()


def test_an_archive_that_unpacks_to_more_than_memory_should_hold(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recording, "MAX_BYTES", 1 << 20)
    bomb = npz(state=npy(HEADS["more than there is"], b"\0" * (8 << 20)))
    assert len(bomb) < 1 << 18
    assert "expected at most 1048576" in put(tmp_path, BY_NAME["recording"], bomb)


def test_an_archive_with_the_same_member_twice_or_a_method_that_is_unknown(tmp_path: Path) -> None:
    data = npz()
    put(tmp_path, BY_NAME["recording"], data.replace(b"output_cols.npy", b"deliver_mas.npy"))
    head = data.index(b"PK\x01\x02")
    unknown = data[: head + 10] + b"\x63\x00" + data[head + 12 :]
    assert "compression method" in put(tmp_path, BY_NAME["recording"], unknown)


def test_findings_belong_to_a_reader() -> None:
    assert {path.name for path in FINDINGS.iterdir()} <= set(BY_NAME)
