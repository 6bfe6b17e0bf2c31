# SPDX-License-Identifier: Apache-2.0
"""What the pages show is there: commands with their options, Python examples, links."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from safety_island.cli.parser import Parser
from safety_island.cli.table import find, load

ROOT = Path(__file__).parents[2]
PAGES = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")])
BLOCK = re.compile(r"^```\w*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
ISLAND = re.compile(r"^(?:\w+=\S+ |\$ |sudo )*(?:\./|/opt/safety-island/)?island (?P<words>.*)")
OF_THE_SCRIPT = {"test", "dev", "--version"}
"""What ``./island`` itself does."""
EXAMPLE = re.compile(r"^```\w*\n(from safety_island import .*?)^```$", re.MULTILINE | re.DOTALL)


def commands() -> Iterator[tuple[str, str]]:
    """Every line of a block that calls ``island``: the page and what follows that word."""
    for page in PAGES:
        for block in BLOCK.findall(page.read_text("utf-8")):
            for line in block.replace("\\\n", " ").splitlines():
                for part in re.split(r" [|&] ", line):
                    if found := ISLAND.match(part.strip()):
                        yield page.name, found["words"]


COMMANDS = sorted(set(commands()))


def test_there_are_commands_on_the_pages() -> None:
    assert len(COMMANDS) > 25
    assert {"README.md", "autoware.md", "can.md", "deploying.md"} <= {page for page, _ in COMMANDS}


@pytest.mark.parametrize(("page", "words"), COMMANDS)
def test_a_command_on_a_page_is_understood(page: str, words: str) -> None:
    name, *arguments = shlex.split(re.split(r" [<>] ", words)[0], comments=True)
    if name in OF_THE_SCRIPT:
        return
    command = find(name)
    assert command is not None, f"{page}: island {words}"
    parser = Parser(prog=f"island {name}")
    load(command).configure(parser)
    if "--help" not in arguments:
        parser.parse(arguments)


EXAMPLES = [
    (page.name, text) for page in PAGES for text in EXAMPLE.findall(page.read_text("utf-8"))
]


@pytest.mark.parametrize(("page", "text"), EXAMPLES, ids=[page for page, _ in EXAMPLES])
def test_a_python_example_runs_as_it_stands(page: str, text: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", text], cwd=tmp_path, capture_output=True, text=True, timeout=300
    )
    assert (done.returncode, done.stderr) == (0, ""), page
    assert done.stdout


def test_the_python_examples_are_found() -> None:
    assert {page for page, _ in EXAMPLES} == {"python.md", "tuning.md"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_leads_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\((?!https?:)([^)#]+)", page.read_text("utf-8")):
        assert (page.parent / target).exists(), target
