# SPDX-License-Identifier: Apache-2.0
"""Shared options refuse what cannot be used, and say what can."""

from __future__ import annotations

import argparse

import pytest

from safety_island.cli import options
from safety_island.cli.main import main
from safety_island.cli.parser import Parser, UsageError


@pytest.fixture
def parser() -> Parser:
    made = Parser(prog="island x")
    options.add_domain(made, 2, "the island")
    options.add_interface(made)
    options.add_params(made)
    options.add_period(made)
    options.add_duration(made, 60.0)
    options.add_json(made, "the summary")
    return made


def test_defaults(parser: Parser) -> None:
    assert parser.parse([]) == argparse.Namespace(
        domain=2, interface="lo", params=["default"], period=None, duration=60.0, json=False
    )


def test_values(parser: Parser) -> None:
    line = "--domain 232 --interface tap0 --params firmware a.yaml --period 0.03 --duration 0"
    assert parser.parse([*line.split(), "--json"]) == argparse.Namespace(
        domain=232,
        interface="tap0",
        params=["firmware", "a.yaml"],
        period=0.03,
        duration=0.0,
        json=True,
    )


@pytest.mark.parametrize(
    ("option", "value"),
    [
        *(("--domain", value) for value in ("-1", "233", "x", "1.5", "", "²")),
        *(("--period", value) for value in ("0", "-1", "nan", "inf", "1.01", "0.0009", "x")),
        *(("--interface", value) for value in ("", ".", "a b", "a/b", "a:1", "e" * 16, "ä" * 8)),
        *(("--duration", value) for value in ("-1", "nan", "inf", "soon")),
    ],
)
def test_refused(parser: Parser, option: str, value: str) -> None:
    with pytest.raises(
        UsageError, match=f"argument {option}: '{value}' is not a .*island x --help"
    ):
        parser.parse([f"{option}={value}"])


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["bridge", "--realtime", "off", "--cpu", "1"], "--cpu: with --realtime off no core"),
        (["main-compute", "--repeat", "--within", "30"], "--within: --repeat drives without end"),
    ],
)
def test_an_option_that_would_do_nothing_is_refused(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert told in line
