# SPDX-License-Identifier: Apache-2.0
"""Runs the tests of a room against a mutant, in a fork of a process that is warm already."""

from __future__ import annotations

import contextlib
import gc
import importlib
import importlib.util
import io
import os
import resource
import signal
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.machinery import ModuleSpec, SourceFileLoader
from pathlib import Path
from types import CodeType
from typing import Any

import pytest
from hypothesis import Phase, settings

from safety_island.kernel import kernel
from tests.mutation.mutants import Mutant

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src"

_MEMORY = 8 << 30
"""Bytes of address space; a mutant that takes memory without end does not take the machine's."""

_PATIENCE = 20
"""Seconds of waiting that a mutant has for each second of processor time."""

WARM = ("safety_island.control.follower", "safety_island.params", "tests.conftest")
"""Slow to import; what they import of the rooms below is forgotten again."""

ABOVE = (
    *("input_gate", "life_cycle", "guard", "command", "core", "can", "params", "bridge", "node"),
    *("sim", "replay", "cli", "bench"),
)
"""Rooms that are mutated or import one that is; a fork imports them anew."""

OPTIONS = (
    *("-x", "-q", "-p", "no:cacheprovider"),
    *("-p", "pytest_timeout", "-p", "_hypothesis_pytestplugin"),  # and no other plugin
    *("-W", "ignore::pytest.PytestAssertRewriteWarning"),  # plugins are imported before the fork
)


@dataclass(frozen=True)
class Room:
    """Sources that are mutated, and the tests that must notice."""

    name: str
    sources: tuple[str, ...]
    tests: tuple[str, ...]

    def files(self) -> list[Path]:
        """Return every source file."""
        paths = [SOURCE / "safety_island" / name for name in self.sources]
        found = [sorted(path.rglob("*.py")) if path.is_dir() else [path] for path in paths]
        return [file for files in found for file in files]

    def paths_of_tests(self) -> list[str]:
        """Return the test files but those that take seconds each: recorded runs, live drives."""
        return [
            str(file)
            for path in (ROOT / name for name in self.tests)
            for file in (sorted(path.rglob("test_*.py")) if path.is_dir() else [path])
            if file.name not in SLOW
        ]


SLOW = ("test_golden.py", "test_live.py", "test_acceptance.py")
"""Files of tests that take seconds each; what they alone hold is not held by a room's own tests."""

PAGE = "tests/params/test_document.py"
"""The page of the parameters, which holds the units and ranges of a room's own."""

ROOMS = (
    Room("input_gate", ("input_gate",), ("tests/input_gate", PAGE)),
    Room("life_cycle", ("life_cycle",), ("tests/life_cycle", PAGE)),
    Room("guard", ("guard", "core/guard.py"), ("tests/guard", "tests/core", PAGE)),
    Room("command", ("command", "can/encoder.py"), ("tests/command", "tests/can/test_encoder.py")),
    Room("node", ("node",), ("tests/node",)),
    Room("bridge", ("bridge",), ("tests/bridge",)),
)
"""The safety code, then what decides around it; a room's tests may use DDS on loopback."""


class _Mutated(SourceFileLoader):
    """Finds one module, with a tree in place of its source."""

    def __init__(self, path: Path, tree: Any) -> None:
        parts = path.relative_to(SOURCE).with_suffix("").parts
        self.is_init = parts[-1] == "__init__"
        super().__init__(".".join(parts[:-1] if self.is_init else parts), str(path))
        self.tree = tree

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        if name != self.name:
            return None
        places = [str(Path(self.path).parent)] if self.is_init else None
        return importlib.util.spec_from_file_location(
            name, self.path, loader=self, submodule_search_locations=places
        )

    def get_code(self, fullname: str) -> CodeType:
        code: CodeType = compile(self.tree, self.path, "exec")
        return code


def warm_up() -> None:
    """Import what every fork needs; property tests try less, and the same each time."""
    for name in WARM:
        importlib.import_module(name)
    settings.register_profile(
        "mutate",
        max_examples=30,
        derandomize=True,
        database=None,
        deadline=None,
        phases=(Phase.explicit, Phase.generate),  # that it fails is enough: no shrinking
    )
    settings.load_profile("mutate")
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    with contextlib.redirect_stdout(io.StringIO()):
        pytest.main([*OPTIONS, "--collect-only", *ROOMS[-1].paths_of_tests()])
    gc.collect()
    gc.freeze()  # pytest collects garbage at its end, which is not to walk all that is here


def start(room: Room, mutant: Mutant | None, limit_s: int) -> int:
    """Fork a process that tests a mutant (None: the source as it is); return its id.

    It ends with 0 when every test passes, by SIGXCPU when they take too much processor time and by
    SIGALRM when they wait for what does not come: a machine that is busy kills no mutant.
    """
    pid = os.fork()
    if pid:
        return pid
    resource.setrlimit(resource.RLIMIT_CPU, (limit_s, limit_s))
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    signal.alarm(_PATIENCE * limit_s)
    status = 1
    try:
        _silence()
        kernel.JIT = False  # compiled code is that of the file, which no mutant changes
        if mutant is not None:
            finder: Any = _Mutated(ROOT / mutant.file, mutant.tree)
            sys.meta_path.insert(0, finder)
        _forget_rooms()
        status = _first_failure(_likeliest_first(room, mutant))
    finally:
        os._exit(status)


def _likeliest_first(room: Room, mutant: Mutant | None) -> list[str]:
    """The tests named after the file come first; of parameters, their page."""
    paths = room.paths_of_tests()
    if mutant is None:
        return paths
    stem = "document" if mutant.file.endswith("params.py") else Path(mutant.file).stem
    return sorted(paths, key=lambda path: not Path(path).stem.startswith(f"test_{stem}"))


def _first_failure(paths: Sequence[str]) -> int:
    """Test file after file, for most mutants die in the first and need not wait for the rest."""
    for path in paths:
        if status := int(pytest.main([*OPTIONS, path])):
            return status
    return 0


def _silence() -> None:
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)


def _forget_rooms() -> None:
    for name in list(sys.modules):
        room = name.split(".")[1:2]
        is_test = name.startswith("tests.") and room != ["mutation"]
        if is_test or (name.startswith("safety_island.") and room[0] in ABOVE):
            del sys.modules[name]


def run(
    room: Room,
    found: Sequence[Mutant],
    jobs: int,
    limit_s: int,
    told: Callable[[int, Mutant | None], None],
) -> list[Mutant]:
    """Test every mutant; return those that no test noticed.

    ``told`` is called after each, with how many are done, and with the mutant when it survives.
    """
    waiting, running, survivors = list(reversed(found)), dict[int, Mutant](), list[Mutant]()
    while waiting or running:
        while waiting and len(running) < jobs:
            mutant = waiting.pop()
            running[start(room, mutant, limit_s)] = mutant
        pid, status = os.wait()
        mutant = running.pop(pid)
        if status == 0:
            survivors.append(mutant)
        told(len(found) - len(waiting) - len(running), None if status else mutant)
    return sorted(survivors, key=lambda mutant: (mutant.file, mutant.line))


def baseline(room: Room) -> float | None:
    """Return the processor time of a room's tests [s] when nothing is changed; None: they fail."""
    _, status, usage = os.wait4(start(room, None, 600), 0)
    return usage.ru_utime + usage.ru_stime if status == 0 else None
