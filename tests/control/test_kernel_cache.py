"""Where compiled kernels are kept: by content, in a folder that can be written."""

from __future__ import annotations

import importlib.util
import shutil
from pathlib import Path
from typing import Any

import pytest

from safety_island.control import kernel
from safety_island.errors import ConfigurationError

pytest.importorskip("numba")
CONTROL = Path(kernel.__file__).parent


def module(folder: Path) -> Any:
    """The module that keeps the cache, from a copy of the kernel sources."""
    spec = importlib.util.spec_from_file_location("a_copy", folder / "kernel_cache.py")
    assert spec is not None and spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


@pytest.fixture
def sources(tmp_path: Path) -> Path:
    """A copy of the kernel sources."""
    return Path(shutil.copytree(CONTROL, tmp_path / "control"))


def key(sources: Path) -> str:
    return str(module(sources).source_hash())


def test_a_copy_of_the_same_sources_finds_the_same_code(sources: Path) -> None:
    assert key(sources) == key(CONTROL)


@pytest.mark.parametrize("name", ["geometry.py", "lateral.py", "records.py", "kernel.py"])
def test_any_edit_of_a_source_is_another_folder(sources: Path, name: str) -> None:
    """Also in a file that only an imported function stands in."""
    before = key(sources)
    with (sources / name).open("a") as file:
        file.write("# one more\n")
    assert key(sources) != before


def test_a_new_source_is_another_folder_and_a_note_is_not(sources: Path) -> None:
    before = key(sources)
    (sources / "notes.txt").write_text("not compiled")
    assert key(sources) == before
    (sources / "another.py").write_text("LIMIT = 1\n")
    assert key(sources) != before


@pytest.mark.parametrize("library", ["numba", "np"])
def test_another_version_of_a_library_is_another_folder(
    sources: Path, library: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    before, loaded = key(sources), module(sources)
    monkeypatch.setattr(getattr(loaded, library), "__version__", "0.0.0")
    assert loaded.source_hash() != before


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
    folder = module(CONTROL).cache_folder()
    assert folder == tmp_path / expected / f"kernels-{key(CONTROL)}"
    assert folder.is_dir() and list(folder.iterdir()) == []


@pytest.fixture
def blocked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache that cannot be written: a file stands where the folder should be."""
    file = tmp_path / "file"
    file.write_text("")
    monkeypatch.setenv("SAFETY_ISLAND_CACHE", str(file / "below"))
    return file


def test_a_place_that_cannot_be_written_is_replaced(
    tmp_path: Path, blocked: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    loaded = module(CONTROL)
    monkeypatch.setattr(loaded.tempfile, "tempdir", str(tmp_path))
    folder = loaded.cache_folder()
    assert folder.parent.parent == tmp_path and folder.is_dir()


def test_no_place_at_all_is_told(blocked: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    loaded = module(CONTROL)
    monkeypatch.setattr(loaded.tempfile, "tempdir", str(blocked))
    with pytest.raises(ConfigurationError, match="SAFETY_ISLAND_CACHE") as told:
        loaded.cache_folder()
    assert str(blocked / "below") in str(told.value) and "\n" not in str(told.value)
