# SPDX-License-Identifier: Apache-2.0
"""Kernels that were compiled ahead of time: a shared library, so that no compiler runs here.

The library is made by ``island build``. ``SAFETY_ISLAND_KERNELS`` names it, or it is beside this
file: in a built island, and where a platform wheel is installed. It knows the kernel sources it was
made from and is refused with any others.
"""

from __future__ import annotations

import ctypes
import operator
import os
import weakref
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from safety_island.errors import ConfigurationError
from safety_island.kernel.sources import sources_hash
from safety_island.package import PACKAGE

VARIABLE = "SAFETY_ISLAND_KERNELS"
"""Environment variable that names the library."""
LIBRARY_NAME = "libsafety_island_control.so"
LIBRARY_PLACE = f"kernel/{LIBRARY_NAME}"
"""Where an installed island has it, in the package."""
PREFIX = "safety_island_"
"""What every symbol of the library begins with."""
SOURCES = f"{PREFIX}sources"
"""The symbol that holds the hash of the kernel sources, as text."""

_SCALARS: dict[Any, tuple[Any, Callable[[Any], Any]]] = {
    float: (ctypes.c_double, float),
    int: (ctypes.c_int64, operator.index),
}


def find_library() -> Path | None:
    """Return the library that the environment names, or the one of a built island."""
    named = os.environ.get(VARIABLE)
    if named:
        return Path(named)
    own = Path(__file__).with_name(LIBRARY_NAME)
    return own if own.exists() else None


def require_records(place: str, dtype: Any, array: Any) -> None:
    """Raise TypeError, which names ``place``, unless a kernel can take the array as records."""
    is_records = isinstance(array, np.ndarray) and array.dtype == dtype
    if not is_records or array.ndim != 1 or not len(array):
        kind = f"{array.dtype} {array.shape}" if isinstance(array, np.ndarray) else repr(array)
        raise TypeError(f"{place} is {kind:.200}, expected (n,) of {dtype}")
    if not array.flags.carray:
        raise TypeError(f"{place} must be contiguous, aligned and writeable")


class _Addresses:
    """Turns record arrays of one type into addresses; an array is looked at once in its life."""

    def __init__(self, kernel: str, position: int, dtype: Any) -> None:
        self._place = f"{kernel}: argument {position}"
        self._dtype = dtype
        self._known: dict[int, tuple[int, weakref.ref[Any]]] = {}

    def __call__(self, array: Any) -> int:
        """Return the address of the first record. Raises TypeError when it is no such array."""
        key = id(array)
        found = self._known.get(key)
        return found[0] if found is not None else self._look(key, array)

    def _look(self, key: int, array: Any) -> int:
        require_records(self._place, self._dtype, array)
        address = int(array.ctypes.data)
        forget = weakref.ref(array, lambda _: self._known.pop(key, None))
        self._known[key] = (address, forget)
        return address


class Library:
    """A loaded library. Raises ConfigurationError when it cannot be used."""

    def __init__(self, path: Path) -> None:
        try:
            # The interpreter stays locked: a kernel takes less time than handing it over.
            self._library = ctypes.PyDLL(str(path.absolute()))
            found = ctypes.c_char.in_dll(self._library, SOURCES)
        except (OSError, ValueError) as error:
            raise ConfigurationError(
                f"{path}: not a library of control kernels for this machine ({error}); "
                "make one with: island build -t posix"
            ) from None
        if ctypes.string_at(ctypes.addressof(found)).decode() != sources_hash():
            raise ConfigurationError(
                f"{path}: made from other kernel sources than those in {PACKAGE}; "
                "make it again with: island build -t posix"
            )
        self.path = path

    def function(self, name: str, arguments: Sequence[Any]) -> Callable[..., int]:
        """Return an entry by its name; the callable takes what the compiled-in-process one takes.

        Raises ConfigurationError when the library has no such entry.
        """
        try:
            function = self._library[PREFIX + name]
        except AttributeError:
            raise ConfigurationError(
                f"{self.path}: has no kernel '{name}': what needs it (such as the solver 'osqp') "
                "works where kernels are compiled in process"
            ) from None
        kinds = [
            _SCALARS.get(kind) or (ctypes.c_void_p, _Addresses(name, position, kind))
            for position, kind in enumerate(arguments, 1)
        ]
        function.restype = ctypes.c_int32
        function.argtypes = [kind for kind, _ in kinds]
        converters = [convert for _, convert in kinds]

        def call(*values: Any) -> int:
            pairs = zip(converters, values, strict=True)
            result: int = function(*[convert(value) for convert, value in pairs])
            return result

        return call


@cache
def load(path: Path) -> Library:
    """Return the library of a path, loaded once."""
    return Library(path)
