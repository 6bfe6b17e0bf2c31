# SPDX-License-Identifier: Apache-2.0
"""The optional parts of an installation, and what to say of one that is missing."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Literal

from safety_island.errors import ConfigurationError

Extra = Literal["compile", "osqp"]
PACKAGES: dict[Extra, tuple[str, ...]] = {
    "compile": ("numba", "llvmlite"),
    "osqp": ("osqp", "scipy"),
}
"""What each extra brings, by the names of imports."""


def is_installed(extra: Extra) -> bool:
    """Whether the packages of an extra are there."""
    return all(find_spec(name) is not None for name in PACKAGES[extra])


def require(extra: Extra, what: str, otherwise: str = "") -> None:
    """Raise ConfigurationError, which says how to get the extra, when ``what`` cannot work.

    ``otherwise`` says what a user can do without it.
    """
    if is_installed(extra):
        return
    missing = next(name for name in PACKAGES[extra] if find_spec(name) is None)
    raise ConfigurationError(
        f"{what} needs the package '{missing}', which is not installed; "
        f'install "safety-island[{extra}]" (in a clone: ./island dev){otherwise}'
    )
