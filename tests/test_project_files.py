# SPDX-License-Identifier: Apache-2.0
"""What stands around the sources: licence lines, citation, security, addresses."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

from safety_island import __version__

ROOT = Path(__file__).parents[1]
SPDX = ROOT / "tools" / "spdx"


def test_every_source_names_its_licence() -> None:
    """When this fails: tools/spdx."""
    result = subprocess.run([sys.executable, SPDX, "--check"], capture_output=True, text=True)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('"""A module."""\n', '# SPDX-License-Identifier: Apache-2.0\n"""A module."""\n'),
        ("", "# SPDX-License-Identifier: Apache-2.0\n"),
        ("#!/bin/sh\nls\n", "#!/bin/sh\n# SPDX-License-Identifier: Apache-2.0\nls\n"),
    ],
)
def test_the_licence_line_comes_first_but_after_the_interpreter(
    before: str, after: str, tmp_path: Path
) -> None:
    (tmp_path / "tools").mkdir()
    (tmp_path / "src").mkdir()
    for name in ("tools/spdx", "island", "build.sh"):
        (tmp_path / name).write_text((ROOT / name).read_text() if name == "tools/spdx" else before)
    (tmp_path / "src" / "a.py").write_text(before)
    command = [sys.executable, str(tmp_path / "tools" / "spdx")]
    subprocess.run(command, check=True, capture_output=True)
    assert (tmp_path / "src" / "a.py").read_text() == after
    assert subprocess.run([*command, "--check"], check=False).returncode == 0


def test_the_citation_is_of_this_version_and_place() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert citation["cff-version"] == "1.2.0"
    assert citation["version"] == __version__
    assert citation["license"] == settings["project"]["license"]
    place = settings["tool"]["hatch"]["metadata"]["hooks"]["custom"]["repository"]
    assert citation["repository-code"] == place
    assert {"title", "message", "authors", "type"} <= citation.keys()


def test_types_are_shipped() -> None:
    assert (ROOT / "src" / "safety_island" / "py.typed").is_file()


def test_how_to_report_a_vulnerability_is_written() -> None:
    assert "vulnerability" in (ROOT / "SECURITY.md").read_text()
