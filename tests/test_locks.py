# SPDX-License-Identifier: Apache-2.0
"""The lock files fit pyproject.toml and each other, and name no host and no path."""

from __future__ import annotations

import re
import tomllib
from importlib.metadata import distributions
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
LOCKS = ("requirements.lock", "requirements-osqp.lock", "requirements-dev.lock")
PIN = re.compile(r"([a-z0-9-]+)(?:\[[^]]*\])?==(\S+) ;.*\\$")
EXTRAS = re.compile(r"([A-Za-z0-9._-]+)\[([^]]+)\]")


def pins(name: str) -> dict[str, set[str]]:
    """Versions of each package in a lock file (one for each Python that needs another)."""
    found: dict[str, set[str]] = {}
    for line in (ROOT / name).read_text().splitlines():
        if match := PIN.match(line):
            found.setdefault(match[1], set()).add(match[2])
    return found


def wanted(lock: str) -> list[str]:
    """Requirements of the project itself, and of the extras that a lock file brings."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    extras = settings["project"]["optional-dependencies"]
    brought = ("compile",) if lock == LOCKS[0] else tuple(extras)
    own = settings["tool"]["hatch"]["metadata"]["hooks"]["custom"]["dependencies"]
    return [*own, *(text for extra in brought for text in extras[extra])]


@pytest.mark.parametrize("lock", LOCKS)
def test_every_requirement_is_locked(lock: str) -> None:
    locked = pins(lock)
    for requirement in map(Requirement, wanted(lock)):
        versions = locked.get(canonicalize_name(requirement.name))
        assert versions, f"{requirement}: run tools/lock"
        assert all(map(requirement.specifier.contains, versions)), f"{requirement}: run tools/lock"


def test_extras_that_a_package_asks_for_are_pinned_with_it() -> None:
    text = (ROOT / "requirements-dev.lock").read_text()
    locked = pins("requirements-dev.lock")
    for distribution in distributions():
        if distribution.name.lower() not in locked:
            continue
        for requirement in distribution.requires or ():
            asked = EXTRAS.match(requirement)
            if asked and "extra ==" not in requirement and asked[1].lower() in locked:
                # pip takes "name" and "name[extra]" for two things, and looks for the newest one.
                assert f"{asked[1].lower()}[{asked[2]}]==" in text, f"{requirement}: run tools/lock"


def test_development_adds_and_changes_nothing() -> None:
    run, osqp, dev = (pins(lock) for lock in LOCKS)
    assert {name: osqp.get(name) for name in run} == run
    assert {name: dev.get(name) for name in osqp} == osqp


def test_a_run_brings_nothing_that_only_comparisons_and_tools_need() -> None:
    assert not {"osqp", "scipy", "joblib", "pytest", "mypy", "ruff"} & pins(LOCKS[0]).keys()


@pytest.mark.parametrize("lock", LOCKS)
def test_every_package_has_a_hash_and_no_host(lock: str) -> None:
    text = (ROOT / lock).read_text()
    assert "://" not in text
    assert not re.search(r"(^|\s)/", text), "a path of some machine"
    packages = re.split(r"\n(?=[a-z0-9-]+(?:\[[^]]*\])?==)", text)[1:]
    assert len(packages) > 20
    assert all("--hash=sha256:" in package for package in packages)
