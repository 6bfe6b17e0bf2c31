"""A copy of the shipped configuration that a test may change."""

import shutil
from pathlib import Path

import pytest

from safety_island.build.kconfig_places import Places


@pytest.fixture
def places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Places:
    """The shipped ``config/`` and an empty ``build/`` below the current folder."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(Places().config, tmp_path / "config")
    return Places(tmp_path / "config", tmp_path / "build")
