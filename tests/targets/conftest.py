# SPDX-License-Identifier: Apache-2.0
"""A copy of the shipped configuration that a test may change; builds that tests share."""

import fcntl
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from safety_island.targets.kconfig.places import Places
from safety_island.targets.kconfig.resolve import resolve
from safety_island.targets.package.pipeline import Build
from safety_island.targets.package.products import APPLICATION, Product


@pytest.fixture
def places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Places:
    """The shipped ``config/`` and an empty ``build/`` below the current folder."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(Places().config, tmp_path / "config")
    return Places(tmp_path / "config", tmp_path / "build")


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory, worker_id: str) -> Path:
    """A folder that all test processes of a session share."""
    base = tmp_path_factory.getbasetemp()
    return base if worker_id == "master" else base.parent


@pytest.fixture(scope="session")
def build_of(shared: Path) -> Callable[[str, Product], Path]:
    """Build a target once in a session; returns its folder."""

    def build(target: str, product: Product = APPLICATION) -> Path:
        places = Places(build=shared / "build")
        with (shared / "build.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            made = Build(resolve(target, places=places), product, places, lambda step: None)
            if not made.is_current():
                made.run()
        return made.folder

    return build


@pytest.fixture(scope="session")
def posix_build(build_of: Callable[[str], Path]) -> Path:
    """The folder of a build for this machine."""
    return build_of("posix")
