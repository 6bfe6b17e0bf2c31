"""Where compiled kernels are kept: a folder named after the content that they come from.

Numba's own rule (path and time of one source file) would not notice an edit in a function that was
imported from another file, and would compile again for every copy of the same sources. Here the
key is a hash of all kernel sources, so any copy of them finds the code, and no other one does.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core.caching import _CacheLocator

from safety_island.errors import ConfigurationError

LOCATOR = f"{__name__}.Locator"
"""For Numba's setting ``CACHE_LOCATOR_CLASSES``."""


@cache
def source_hash() -> str:
    """Hash of every kernel source and of the versions of Numba and NumPy; read once."""
    digest = hashlib.sha256(f"{numba.__version__} {np.__version__}".encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


@cache
def cache_folder() -> Path:
    """The folder, made: below $SAFETY_ISLAND_CACHE, $XDG_CACHE_HOME or ~/.cache.

    Where none can be written, one in the system's temporary folder. Raises ConfigurationError.
    """
    home = os.environ.get("XDG_CACHE_HOME")
    default = (Path(home) if home else Path("~/.cache").expanduser()) / "safety-island"
    chosen = Path(os.environ.get("SAFETY_ISLAND_CACHE") or default)
    spare = Path(tempfile.gettempdir()) / f"safety-island-{os.getuid()}"
    for root in (chosen, spare):
        folder = root / f"kernels-{source_hash()}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError:
            continue
        return folder
    raise ConfigurationError(
        f"neither {chosen} nor {spare} can be written, so compiled kernels have no place: "
        "set SAFETY_ISLAND_CACHE to a folder that can"
    )


class Locator(_CacheLocator):
    """Tells Numba the folder; the hash in its name says all there is to say of freshness."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._line = function.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        """The folder."""
        return str(cache_folder())

    def get_source_stamp(self) -> str:
        """The hash."""
        return source_hash()

    def get_disambiguator(self) -> str:
        """Tells functions of one name apart."""
        return str(self._line)

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> Locator:
        """Numba's way to make one."""
        return cls(py_func)
