# SPDX-License-Identifier: Apache-2.0
"""The frame of the command line: help, errors in one line, exit codes."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from types import SimpleNamespace

import pytest

from safety_island import __version__
from safety_island.cli import main as frame
from safety_island.cli.main import main
from safety_island.cli.parser import Parser, UsageError
from safety_island.cli.table import COMMANDS, load
from safety_island.errors import ConfigurationError, IslandError

Capture = pytest.CaptureFixture[str]


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """A command whose body a test gives as ``command.execute``."""
    module = SimpleNamespace(configure=lambda parser: None, execute=lambda arguments: 0)
    monkeypatch.setattr(frame, "load", lambda row: module)
    return module


def raises(error: BaseException) -> object:
    def execute(arguments: argparse.Namespace) -> int:
        raise error

    return execute


@pytest.mark.parametrize("arguments", [[], ["-h"], ["--help"], ["help"]])
def test_overview_names_every_command(arguments: list[str], capsys: Capture) -> None:
    assert main(arguments) == 0
    text = capsys.readouterr().out
    assert all(f"  {row.name} " in text and row.summary in text for row in COMMANDS)
    assert max(len(line) for line in text.splitlines()) <= 100


def test_version(capsys: Capture) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"island {__version__}\n"


@pytest.mark.parametrize("row", COMMANDS, ids=[row.name for row in COMMANDS])
def test_every_command_explains_itself_with_examples(row: SimpleNamespace, capsys: Capture) -> None:
    with pytest.raises(SystemExit) as leaving:
        main([row.name, "--help"])
    assert leaving.value.code == 0
    text = capsys.readouterr().out
    assert f"examples:\n  island {row.name}" in text
    assert max(len(line) for line in text.splitlines()) <= 100


@pytest.mark.parametrize("row", COMMANDS, ids=[row.name for row in COMMANDS])
def test_every_command_answers_an_unknown_option_in_one_line(
    row: SimpleNamespace, capsys: Capture
) -> None:
    assert main([row.name, "--no-such-option"]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.startswith("island: error: ")


def test_unknown_command_suggests_the_nearest(capsys: Capture) -> None:
    assert main(["rnu"]) == 2
    expected = "unknown command 'rnu'; did you mean 'run'? (see 'island --help')"
    assert capsys.readouterr().err == f"island: error: {expected}\n"


def test_unknown_option_suggests_the_nearest() -> None:
    parser = Parser(prog="island x")
    parser.add_argument("--period")
    with pytest.raises(UsageError, match="unknown argument '--perod=1'; did you mean '--period'"):
        parser.parse(["--perod=1"])


@pytest.mark.parametrize(
    ("error", "code", "text"),
    [
        (IslandError("no bus"), 1, "island: error: no bus\n"),
        (ConfigurationError("a.yaml:3: bad"), 2, "island: error: a.yaml:3: bad\n"),
        (KeyboardInterrupt(), 130, ""),
    ],
)
def test_errors_become_exit_codes(
    error: BaseException, code: int, text: str, command: SimpleNamespace, capsys: Capture
) -> None:
    command.execute = raises(error)
    assert main(["run"]) == code
    assert capsys.readouterr().err == text


def test_fault_of_the_island_is_one_line_unless_asked(
    command: SimpleNamespace, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    command.execute = raises(ZeroDivisionError("division by zero"))
    monkeypatch.delenv(frame.DEBUG, raising=False)
    assert main(["run"]) == 70
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "ZeroDivisionError: division by zero" in error
    monkeypatch.setenv(frame.DEBUG, "1")
    with pytest.raises(ZeroDivisionError):
        main(["run"])


def test_exit_code_of_the_command_is_returned(command: SimpleNamespace) -> None:
    command.execute = lambda arguments: 3
    assert main(["run"]) == 3


def test_reader_that_went_away_is_no_error() -> None:
    code = "import sys; from safety_island.cli.main import main; sys.exit(main(['--help']))"
    reading, writing = os.pipe()
    os.close(reading)
    process = subprocess.run(
        [sys.executable, "-c", code], stdout=writing, stderr=subprocess.PIPE, timeout=60
    )
    os.close(writing)
    assert (process.returncode, process.stderr) == (141, b"")


def test_help_imports_nothing_heavy() -> None:
    code = (
        "import sys; from safety_island.cli.main import main; main(['--help']);"
        "print(sorted({'numba', 'numpy', 'cyclonedds', 'rich', 'yaml'} & set(sys.modules)),"
        " file=sys.stderr)"
    )
    process = subprocess.run([sys.executable, "-c", code], capture_output=True, timeout=60)
    assert process.stderr == b"[]\n"


def test_module_runs_as_the_command() -> None:
    process = subprocess.run(
        [sys.executable, "-m", "safety_island", "--version"], capture_output=True, timeout=60
    )
    assert (process.returncode, process.stdout) == (0, f"island {__version__}\n".encode())


def test_table_loads() -> None:
    assert all(hasattr(load(row), "execute") for row in COMMANDS)


def test_words_of_others_do_not_reach_the_terminal_as_they_are(
    command: SimpleNamespace, capsys: Capture
) -> None:
    """A file may hold what clears a screen, or a line of a megabyte."""
    command.execute = raises(IslandError(f"found '\x1b[2J\x07\u202e' {'a' * 10**6} in a file"))
    assert main(["demo"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(r"island: error: found '\x1b[2J\x07\u202e' aaa")
    assert line.endswith("aaa in a file") and " [...] " in line and len(line) < 1100


def test_mistakes_without_number_are_told_in_part(
    command: SimpleNamespace, capsys: Capture
) -> None:
    command.execute = raises(IslandError("\n".join(f"line {n}" for n in range(10**5))))
    assert main(["demo"]) == 1
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 201
    assert lines[199:] == ["island: error: line 199", "island: error: and 99800 more of this kind"]
