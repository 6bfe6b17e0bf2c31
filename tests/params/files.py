# SPDX-License-Identifier: Apache-2.0
"""Parameter files on disk that tests change."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import pytest

from safety_island.params import ParameterError, load_set, read
from safety_island.params.releases import RELEASE, SPANS
from safety_island.params.sets import FILES, OWN, file_of_key

OWN_KEYS = {key for key, file in file_of_key().items() if file in OWN}
"""Keys of the island's own files, which neither Autoware nor the recordings know."""

HEAD = "/**:\n  ros__parameters:\n"


def write(path: Path, text: str) -> Path:
    """Write a text, making the folders above it; return the path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, "utf-8")
    return path


def parameter_file(folder: Path, body: str, name: str = "my.param.yaml") -> Path:
    """Write a file with these lines under ``ros__parameters``, each indented by four spaces."""
    lines = "".join(f"    {line}\n" for line in body.splitlines())
    return write(folder / name, HEAD + lines)


def shipped_text(set_name: str, file: str) -> str:
    """Return the text of one file of a shipped set."""
    folder = files("safety_island.params") / "sets" / ("island" if file in OWN else set_name)
    return folder.joinpath(*file.split("/")).read_text("utf-8")


def copy_of_set(set_name: str, folder: Path) -> dict[str, Path]:
    """Copy a shipped set to a folder; return its files by their names in the set."""
    return {file: write(folder / file, shipped_text(set_name, file)) for file in FILES}


def refused(files: list[Path], base: str | None = "default") -> list[str]:
    """Read files that must be refused; return the lines of the error."""
    with pytest.raises(ParameterError) as caught:
        read(files, base)
    assert caught.value.exit_code == 2
    return str(caught.value).splitlines()


def may_be_missing(key: str, set_name: str) -> bool:
    """Whether the set's release does not have the key, or other keys stand for its value."""
    release = load_set(set_name).node.autoware_release
    return key == RELEASE or (key in SPANS and not SPANS[key].holds(release))
