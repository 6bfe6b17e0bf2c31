# SPDX-License-Identifier: Apache-2.0
"""Loading: what is no libddsc, and what is one of an unknown kind, is told in one line."""

from __future__ import annotations

import ctypes as ct
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from safety_island.dds.errors import DdsError
from safety_island.dds.library import loading
from safety_island.dds.library.envelope import Envelope
from safety_island.dds.library.functions import PROTOTYPES
from safety_island.dds.library.loading import Library, choose, loaded
from safety_island.errors import ConfigurationError, IslandError


def test_the_package_of_the_wheel_is_never_imported() -> None:
    code = (
        "import sys\n"
        "from safety_island.dds.participant import Participant\n"
        "from safety_island.dds.library.loading import loaded\n"
        "loaded()\n"
        "print([name for name in sys.modules if name.startswith('cyclonedds')])"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (ran.stdout, ran.returncode) == ("[]\n", 0), ran.stderr


def test_a_file_that_is_no_library(tmp_path: Path) -> None:
    path = tmp_path / "libddsc.so"
    path.write_text("nothing")
    with pytest.raises(ConfigurationError, match=r"libddsc\.so cannot be loaded: ") as refused:
        Library(path)
    assert "\n" not in str(refused.value)


def test_a_library_of_ros_2_that_needs_its_setup_file() -> None:
    path = Path("/opt/ros/jazzy/lib/libddsc.so")
    with pytest.raises(ConfigurationError, match=r"source the setup file of this ROS 2 first$"):
        Library(path)


def test_a_library_of_something_else() -> None:
    libc = next(Path("/").glob("lib/*-linux-gnu/libc.so.6"))
    with pytest.raises(ConfigurationError, match=r"is no libddsc of CycloneDDS 0\.10 or 11: it"):
        Library(libc)


def test_a_function_that_is_not_in_the_table_is_none() -> None:
    assert loaded().dds_delete is loaded().dds_delete
    with pytest.raises(AttributeError, match="dds_unheard_of"):
        _ = loaded().dds_unheard_of


def test_all_functions_of_the_table_are_there_and_bind() -> None:
    assert all(getattr(loaded(), name) for name in PROTOTYPES)


def test_the_same_library_may_be_chosen_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loading, "_chosen", None)
    path = loaded().path
    choose(path)
    choose(path.parent)


def test_another_library_than_the_one_in_use_is_refused(tmp_path: Path) -> None:
    other = tmp_path / "libddsc.so"
    other.write_bytes(b"")
    loaded()
    with pytest.raises(DdsError, match=r"is in use already, .*libddsc\.so was asked for"):
        choose(other)


class Fake:
    """A library of release 0.10 that keeps serialized samples in some other way."""

    _name = "libddsc.so"

    def __init__(self, size: int, first: bytes) -> None:
        self.ddsi_sertype_v0 = self.ddsi_serdata_ops_cdr_nokey = ct.CFUNCTYPE(None)(lambda: None)
        self.ddsi_serdata_size = lambda _: size
        self._first = first

    def ddsi_serdata_to_ser(self, _memory: Any, _start: Any, size: Any, found: Any) -> None:
        ct.memmove(found, self._first, size.value)


@pytest.mark.parametrize(
    ("size", "first"),
    [(4, b"\x6c\0\0\0"), (60, b"\xff\xff\0\0"), (60, b"\x38\0\0\0"), (300, b"\x6c\0\0\0")],
)
def test_samples_of_another_kind_are_refused(size: int, first: bytes) -> None:
    fake: Any = Fake(size, first)
    with pytest.raises(IslandError, match=r"libddsc\.so: how this libddsc keeps .* is unknown"):
        Envelope(fake)
