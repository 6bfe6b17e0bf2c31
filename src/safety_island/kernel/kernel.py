# SPDX-License-Identifier: Apache-2.0
"""The one place that knows how kernels are compiled.

A kernel is written in the part of Python that Numba compiles: scalars, ``float64`` arrays and
records in, a status code out, nothing allocated. It has three lives: compiled in process; plain
Python (``SAFETY_ISLAND_JIT=0``); and taken from a library that was compiled ahead of time (see
``library.py``), where Numba is not even imported. ``_nrt=False`` takes Numba's memory manager away,
so a kernel that allocates an array does not compile; that private option is one reason for the
exact version pin.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import FunctionType, ModuleType
from typing import TYPE_CHECKING, Any

from safety_island.extras import require
from safety_island.kernel import library

if TYPE_CHECKING:
    from safety_island.kernel.cache import Place

_CHOICE = os.environ.get("SAFETY_ISLAND_JIT", "")
"""``0``: plain Python; ``1``: compiled here, whatever library there is; nothing: as it comes."""
_PLAIN = _CHOICE == "0"

LIBRARY = None if _CHOICE else library.find_library()
"""The library of kernels that were compiled ahead of time, None when there is none."""

JIT = not _PLAIN and LIBRARY is None
"""Whether the kernels are compiled in process."""

FLAGS: dict[str, Any] = {"error_model": "numpy", "fastmath": False, "_nrt": False}

ENTRIES: list[Entry] = []
"""Every kernel that the island calls, in the order of definition."""

ON_DEMAND: list[Entry] = []
"""Kernels that only some uses call."""


def cache_folder() -> Path:
    """Where compiled kernels are kept, keyed by the hash of what they come from."""
    from safety_island.kernel import cache

    return cache.cache_folder()


def cache_note() -> str:
    """Say why compiled kernels are not kept where they should be; empty when they are."""
    return _place().note if JIT else ""


def is_kept() -> bool:
    """Whether there is a place to keep compiled kernels in."""
    folder = _place().folder
    return folder is not None and os.access(folder, os.W_OK)


def _place() -> Place:
    """Return where they are looked for; imports the compiler."""
    from safety_island.kernel import cache

    return cache.place()


def _njit(**options: Any) -> Callable[[Any], Any]:
    try:
        import numba
    except ImportError:
        require("compile", "control without a library of compiled kernels")
        raise

    from safety_island.kernel.cache import LOCATOR

    settings: Any = numba.config
    settings.CACHE_LOCATOR_CLASSES = LOCATOR
    decorator: Callable[[Any], Any] = numba.njit(**FLAGS, **options)
    return decorator


def kernel(function: Any) -> Any:
    """Mark a function that other kernels call; compiled as a part of them."""
    return _njit()(function) if JIT else function


def compile_from_outside(module: ModuleType) -> None:
    """Let kernels call every function that a module defines, as if ``kernel`` marked each.

    The functions stay as they are, plain Python, and the module need not know of any compiler.
    """
    if not JIT:
        return
    _njit()  # says what is missing where there is no compiler
    from numba.extending import register_jitable

    for function in vars(module).values():
        if isinstance(function, FunctionType) and function.__module__ == module.__name__:
            register_jitable(**FLAGS)(function)


class Entry:
    """A kernel that the outside calls: its argument types are fixed when it is defined.

    Each argument is a record type (passed as an array of it), or ``float`` or ``int``. Compiling
    ahead and then forbidding more keeps a stray read-only array or an ``int`` given for a ``float``
    from starting a compilation of seconds in the middle of a run: it is a ``TypeError`` instead.
    """

    def __init__(
        self,
        function: Callable[..., int],
        arguments: tuple[Any, ...],
        on_demand: bool,
        records: dict[str, Any] | None = None,
    ) -> None:
        self.name = function.__name__
        self.python = function
        self.arguments = arguments
        self.records = function.__globals__ if records is None else records
        """Where the record types are constants, whose names are those in C."""
        self.call: Callable[..., int] = function
        self._dispatcher: Any = None
        if JIT:
            self._dispatcher = _njit(cache=_place().folder is not None)(function)
        if function.__module__.startswith("safety_island."):  # not one that a test defines
            (ON_DEMAND if on_demand else ENTRIES).append(self)

    def signature(self) -> tuple[Any, ...]:
        """The Numba types of the arguments."""
        import numba

        scalars = {float: numba.float64, int: numba.int64}
        return tuple(
            scalars[a] if a in scalars else numba.types.Array(numba.from_dtype(a), 1, "C")
            for a in self.arguments
        )

    def is_on_disk(self) -> bool:
        """Whether compiled code of it is kept for these sources, Python and processor."""
        if not (index := self._index()):
            return False
        codegen = self._dispatcher.targetctx.codegen()
        name = index.get(self._dispatcher._cache._index_key(self.signature(), codegen))
        return name is not None and (cache_folder() / name).exists()

    def _index(self) -> dict[Any, str] | None:
        """Return Numba's list of the code that is kept; None when it cannot be read."""
        files = getattr(getattr(self._dispatcher, "_cache", None), "_cache_file", None)
        try:
            index: dict[Any, str] = files._load_index() if files is not None else {}
        except Exception:  # a damaged pickle may raise anything
            return None
        return index

    def prepare(self) -> None:
        """Compile, or load the compiled code from disk; then refuse any other argument type."""
        if self.call is not self.python:
            return
        if LIBRARY is not None:
            self.call = library.load(LIBRARY).function(self.name, self.arguments)
        elif self._dispatcher is not None:
            self._load_or_compile()
            self._dispatcher.disable_compile()
            self.call = self._dispatcher

    def _load_or_compile(self) -> None:
        """Load without a lock what is on disk; never wait for another process that compiles."""
        if self.is_on_disk():
            try:
                self._dispatcher.compile(self.signature())
                return
            except Exception:  # a damaged file; a fault of the kernel itself shows again below
                self._dispatcher._cache.flush()
        from safety_island.kernel import cache

        with cache.lock(self.name) as is_ours:
            if not is_ours:
                self._dispatcher._cache.disable()
            elif self._index() is None:
                self._dispatcher._cache.flush()
            self._dispatcher.compile(self.signature())

    def bind(self, *arrays: Any) -> Callable[..., int]:
        """Return the kernel with its leading arguments, which are records, given for good.

        They are looked at here and not at each call, which takes a quarter of the time. Raises
        TypeError when one is not what the entry was defined with, or cannot be written.
        """
        for position, (dtype, array) in enumerate(zip(self.arguments, arrays, strict=False), 1):
            library.require_records(f"{self.name}: argument {position}", dtype, array)
        self.prepare()
        function = self.call
        if self._dispatcher is not None:
            # past the dispatcher, which would look at the type of every argument
            function = self._dispatcher.overloads[self.signature()].entry_point
        return partial(function, *arrays)


def entry(
    *arguments: Any, on_demand: bool = False, records: dict[str, Any] | None = None
) -> Callable[[Callable[..., int]], Entry]:
    """Mark a kernel that the outside calls, with the type of each argument.

    ``on_demand``: few need it, so it is compiled by whoever calls its ``prepare``, not by ours.
    ``records``: the globals in which the record types are constants, where the kernel's own module
    does not know them (one that is compiled from outside).
    """
    return lambda function: Entry(function, arguments, on_demand, records)


def is_cached() -> bool:
    """Whether compiled code for these sources is on disk (so that a start takes no compilation)."""
    return not JIT or all(item.is_on_disk() for item in ENTRIES)


def prepare(report: Callable[[str, int, int], None] | None = None) -> None:
    """Make every entry ready to run; ``report(name, index, count)`` is told before each one."""
    for index, item in enumerate(ENTRIES):
        if report is not None:
            report(item.name, index, len(ENTRIES))
        item.prepare()
