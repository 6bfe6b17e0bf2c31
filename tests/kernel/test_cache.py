# SPDX-License-Identifier: Apache-2.0
"""Where compiled kernels are kept: by content, in a folder that can be written."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path
from typing import Any

import pytest

from safety_island.errors import ConfigurationError

pytest.importorskip("numba")
needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="gives files away, as only root may")
STRANGER = 4242


def module() -> Any:
    """The module that keeps the cache, as a process that has just started has it."""
    spec = importlib.util.find_spec("safety_island.kernel.cache")
    assert spec is not None and spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


def key() -> str:
    return str(module().code_hash())


@pytest.mark.parametrize("library", ["numba", "np"])
def test_another_version_of_a_library_is_another_folder(
    library: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    before, loaded = key(), module()
    monkeypatch.setattr(getattr(loaded, library), "__version__", "0.0.0")
    assert loaded.code_hash() != before


def test_other_sources_are_another_folder() -> None:
    before, loaded = key(), module()
    loaded.sources_hash = lambda: "0" * 64
    assert loaded.code_hash() != before


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"SAFETY_ISLAND_CACHE": "a", "XDG_CACHE_HOME": "b", "HOME": "c"}, "a"),
        ({"XDG_CACHE_HOME": "b", "HOME": "c"}, "b/safety-island"),
        ({"HOME": "c"}, "c/.cache/safety-island"),
        ({"SAFETY_ISLAND_CACHE": "", "XDG_CACHE_HOME": "", "HOME": "c"}, "c/.cache/safety-island"),
    ],
)
def test_the_place_is_chosen_by_the_environment(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    variables: dict[str, str],
    expected: str,
) -> None:
    for name in ("SAFETY_ISLAND_CACHE", "XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, str(tmp_path / value) if value else "")
    monkeypatch.delenv("XDG_RUNTIME_DIR", raising=False)
    folder, note = module().place()
    assert folder == tmp_path / expected / f"kernels-{key()}"
    assert folder.is_dir() and list(folder.iterdir()) == []
    assert note == "" and folder.stat().st_mode & 0o777 == 0o700


@pytest.fixture
def blocked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache that cannot be written: a file stands where the folder should be."""
    file = tmp_path / "file"
    file.write_text("")
    monkeypatch.setenv("SAFETY_ISLAND_CACHE", str(file / "below"))
    return file


@pytest.fixture
def runtime(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The runtime folder of this user."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "run"))
    return tmp_path / "run" / "safety-island"


def test_a_place_that_cannot_be_written_is_replaced_by_the_users_own_and_told(
    blocked: Path, runtime: Path
) -> None:
    folder, note = module().place()
    assert folder is not None and folder.parent == runtime and folder.is_dir()
    assert note.startswith(f"{blocked / 'below'}") and "cannot be made: Not a directory" in note
    assert f"compiled code is kept in {folder}" in note and "\n" not in note


def test_no_place_at_all_is_told_and_nothing_is_left_in_a_shared_folder(
    blocked: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("XDG_RUNTIME_DIR", raising=False)
    loaded = module()
    folder, note = loaded.place()
    assert folder is None and "each start compiles it (set SAFETY_ISLAND_CACHE" in note
    with pytest.raises(ConfigurationError, match="SAFETY_ISLAND_CACHE"):
        loaded.cache_folder()


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of these sources, made."""
    monkeypatch.setenv("SAFETY_ISLAND_CACHE", str(tmp_path / "cache"))
    folder: Path = module().cache_folder()
    return folder


def test_row_90_a_folder_that_others_can_write_to_is_not_used_and_told(
    cache: Path, runtime: Path
) -> None:
    """Its files are pickles: who can write them runs code as this user."""
    cache.chmod(0o777)
    folder, note = module().place()
    assert folder is not None and folder.parent == runtime
    assert note.startswith(f"{cache} can be written by others (mode 777): ")


@needs_root
def test_row_90_a_folder_of_another_user_is_not_used_and_told(cache: Path, runtime: Path) -> None:
    os.chown(cache, STRANGER, STRANGER)
    folder, note = module().place()
    assert folder is not None and folder.parent == runtime
    assert note.startswith(f"{cache} belongs to user {STRANGER}, not to 0: ")


@needs_root
def test_row_90_a_file_of_another_user_in_it_is_not_loaded(cache: Path, runtime: Path) -> None:
    planted = cache / "longitudinal.longitudinal_step-1.py311.nbi"
    planted.write_bytes(b"")
    os.chown(planted, STRANGER, STRANGER)
    folder, note = module().place()
    assert folder is not None and folder.parent == runtime
    assert note.startswith(f"{planted} belongs to user {STRANGER}")


@needs_root
def test_row_90_a_runtime_folder_of_another_user_is_not_used_either(
    blocked: Path, runtime: Path
) -> None:
    runtime.parent.mkdir()
    os.chown(runtime.parent, STRANGER, STRANGER)
    folder, note = module().place()
    assert folder is None and f"belongs to user {STRANGER}" in note


def test_row_90_a_lock_file_that_is_a_link_is_not_opened(cache: Path, tmp_path: Path) -> None:
    victim = tmp_path / "victim"
    victim.write_text("precious")
    loaded = module()
    loaded.place()
    (cache / "step.lock").symlink_to(victim)
    with loaded.lock("step") as is_ours:
        assert not is_ours
    assert victim.read_text() == "precious"


def test_one_process_at_a_time_has_the_lock_and_the_next_one_does_not_wait(cache: Path) -> None:
    loaded = module()
    with loaded.lock("step") as first, loaded.lock("step") as second, loaded.lock("other") as other:
        assert (first, second, other) == (True, False, True)
        assert loaded.lock_holder("step") == os.getpid()
    with loaded.lock("step") as again:
        assert again
    assert loaded.lock_holder("step") is None
