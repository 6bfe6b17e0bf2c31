# SPDX-License-Identifier: Apache-2.0
"""Every reader of a file that somebody else wrote: its good files, and how it is asked to read."""

from __future__ import annotations

import contextlib
import io
import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import can
import numpy as np

from safety_island.bridge.config_file import read_bridge_file
from safety_island.bridge.routes import plan_routes
from safety_island.can.dbc import dbc_text
from safety_island.cli.main import main
from safety_island.dds import domain
from safety_island.dds.config import URI, DdsConfig
from safety_island.errors import IslandError
from safety_island.messages.idl import parse_idl
from safety_island.params.sets import FILES, sources_of
from safety_island.sim.own_path import read_course
from safety_island.targets.kconfig.configuration import symbols_of
from safety_island.targets.kconfig.places import Places
from safety_island.targets.kconfig.resolve import resolve
from safety_island.targets.kconfig.symbols import load_kconfig
from tests.can.rig import triple
from tests.fuzz.mutations import Change, mutated, mutated_member
from tests.replay.runs import arrays_of

ROOT = Path(__file__).parents[2]
FINDINGS = Path(__file__).with_name("findings")
"""A folder for each reader: files that broke it once."""

Read = Callable[[Path], str]


class FaultError(AssertionError):
    """A reader did not end as it should."""


@dataclass(frozen=True)
class Reader:
    """``read`` returns what a user is told of a file that is refused, nothing of one that is not.

    ``good`` gives files that are read without a complaint; ``suffix`` names the kind of file.
    """

    name: str
    suffix: str
    good: Callable[[], list[bytes]]
    read: Read
    cases: int = 300
    change: Change = mutated


def command(*words: str) -> Read:
    """A command of the island with the file as its last word."""

    def read(path: Path) -> str:
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = main([*words, str(path)])
        lines = err.getvalue().splitlines()
        notes = [line for line in lines if line.startswith(("note: ", "island: /"))]
        told = [line for line in lines if line not in notes]
        if code not in (0, 1, 2) or any(not line.startswith("island: error: ") for line in told):
            raise FaultError(f"exit code {code}: {err.getvalue()[-2000:]}")
        if (code == 0) == bool(told) and not (code == 1 and out.getvalue().strip()):
            raise FaultError(f"exit code {code} with {err.getvalue()!r}")
        return "\n".join(told)

    return read


def call(function: Callable[[Path], object]) -> Read:
    """A function; what it raises is one of ours."""

    def read(path: Path) -> str:
        try:
            function(path)
        except IslandError as error:
            return str(error) or "an error without a word"
        return ""

    return read


def _bridge(path: Path) -> None:
    plan_routes([read_bridge_file(str(path))])


def _fragment(path: Path) -> None:
    resolve("posix", [path])


def _kconfig(path: Path) -> None:
    load_kconfig(path)


def _dotconfig(path: Path) -> None:
    symbols_of(path.read_bytes().decode("utf-8", "replace"))


def _dds_file(path: Path) -> None:
    with mock.patch.dict(os.environ, {URI: f"file://{path}"}):
        domain._effective_xml(1, DdsConfig())


def _dds_text(path: Path) -> None:
    data = path.read_bytes().replace(b"\0", b"0")  # no environment holds a NUL
    with mock.patch.dict(os.environ, {URI: os.fsdecode(data)}):
        domain._effective_xml(1, DdsConfig())


def _idl(path: Path) -> None:
    parse_idl(path.read_bytes().decode("utf-8", "replace"), str(path))


def _contents(*paths: Path) -> Callable[[], list[bytes]]:
    return lambda: [path.read_bytes() for path in paths]


_FULL_BRIDGE = b"""\
name: other
mode: compress
from_domain: 1
to_domain: 2
topics:
  /a: &common
    type: std_msgs/msg/String
    remap: ~/b
    qos: {reliability: best_effort, depth: 3, deadline: auto, lifespan: 1000000}
  'b':
    type: std_msgs/msg/String
    bidirectional: true
    from_domain: 3
    qos:
      history: keep_all
      durability: transient_local
      liveliness: manual_by_topic
      liveliness_lease_duration: -1
"""


def _bridge_files() -> list[bytes]:
    return [(ROOT / "demo/bridge/bridge-config.yaml").read_bytes(), _FULL_BRIDGE]


def _parameter_files() -> list[bytes]:
    return [source.text.encode() for source in sources_of("default")][: len(FILES)]


def _dds_files() -> list[bytes]:
    own = b"""<?xml version="1.0"?>
<CycloneDDS xmlns="https://cdds.io/config"><Domain Id="any"><General><Interfaces>
<NetworkInterface name="lo" multicast="false"/></Interfaces></General><Discovery><Peers>
<Peer Address="127.0.0.1:7410"/></Peers></Discovery></Domain></CycloneDDS>"""
    return [own, DdsConfig(loopback_only=True, peers=("127.0.0.1",)).xml(1).encode()]


def _log(suffix: str) -> Callable[[], list[bytes]]:
    def good() -> list[bytes]:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"drive{suffix}"
            with can.Logger(path) as writer:
                for index, frame in enumerate(f for number in range(4) for f in triple(number)):
                    stamp, identifier = 1.0 + index / 100, frame.arbitration_id
                    writer(can.Message(stamp, identifier, is_extended_id=False, data=frame.data))
            return [path.read_bytes()]

    return good


def _recordings() -> list[bytes]:
    found = []
    for save in (np.savez, np.savez_compressed):
        data = io.BytesIO()
        save(data, **arrays_of(ticks=4))
        found.append(data.getvalue())
    return found


def _paths() -> list[bytes]:
    rows = [f"{0.7 * i},{0.01 * i * i},{i % 9 + 1}" for i in range(40)]
    return ["\n".join(["x,y,v", *rows]).encode(), b"0,0,0,3\n20,1,0,4\n40,1,0,0\n"]


def _yaml_paths() -> list[bytes]:
    return [b"x: [0, 9.5, 20]\ny: [0, 0.25, 1]\nyaw: [0, 0.05, 0.1]\nv: [3, 0, 4]\n"]


READERS = (
    Reader("bridge", ".yaml", _bridge_files, call(_bridge)),
    Reader("path", ".csv", _paths, call(read_course)),
    Reader("path-yaml", ".yaml", _yaml_paths, call(read_course)),
    Reader("parameters", ".yaml", _parameter_files, command("params", "check")),
    Reader(
        "kconfig-fragment",
        ".conf",
        _contents(*sorted((ROOT / "config").rglob("*.conf"))),
        call(_fragment),
        60,
    ),
    Reader("kconfig", "", _contents(Places().kconfig), call(_kconfig), 25),
    Reader(
        "dotconfig", ".config", lambda: [resolve("posix").dotconfig().encode()], call(_dotconfig)
    ),
    Reader("dds-file", ".xml", _dds_files, call(_dds_file)),
    Reader("dds-text", "", _dds_files, call(_dds_text)),
    *(Reader(f"can{s}", s, _log(s), command("can", "monitor", "--json")) for s in (".log", ".asc")),
    *(Reader(f"can{s}", s, _log(s), command("can", "monitor")) for s in (".blf", ".csv", ".trc")),
    Reader("dbc", ".dbc", lambda: [dbc_text().encode()], command("can", "dbc", "--check"), 60),
    Reader("tables", ".md", _contents(ROOT / "docs/can.md"), command("can", "tables", "--update")),
    Reader("recording-bytes", ".npz", _recordings, command("replay"), 100),
    Reader("recording", ".npz", _recordings, command("replay"), 300, mutated_member),
    Reader(
        "idl",
        ".idl",
        _contents(*sorted((ROOT / "src/safety_island/messages/idl").rglob("*.idl"))),
        call(_idl),
    ),
)
