# SPDX-License-Identifier: Apache-2.0
"""``island config`` and ``island menuconfig``: what they print and how they refuse."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safety_island.cli.main import main
from safety_island.targets.kconfig.places import Places
from safety_island.targets.kconfig.resolve import resolve
from safety_island.targets.kconfig.targets import NAMES

Capture = pytest.CaptureFixture[str]


@pytest.fixture(autouse=True)
def _nothing_saved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a developer chose in the menu must not change what these tests see."""
    monkeypatch.setattr(
        "safety_island.targets.kconfig.resolve.Places", lambda: Places(build=tmp_path)
    )


@pytest.mark.parametrize("target", NAMES)
def test_show_has_every_symbol_in_force_with_its_origin(target: str, capsys: Capture) -> None:
    assert main(["config", "show", "-t", target]) == 0
    shown = capsys.readouterr().out.splitlines()
    expected = [item for item in resolve(target).settings if item.line]
    assert len(shown) == len(expected)
    for line, item in zip(shown, expected, strict=True):
        assert line.startswith(item.line)
        assert line.endswith(f"  {item.origin}")


def test_show_all_tells_what_the_others_need(capsys: Capture) -> None:
    assert main(["config", "show", "-t", "posix", "--all"]) == 0
    shown = capsys.readouterr().out
    assert "# CONFIG_CAN_DEVICE needs CAN " in shown
    assert "# CONFIG_CAN is not set " in shown
    assert len(shown.splitlines()) == len(resolve("posix").settings)


def test_show_as_json(capsys: Capture) -> None:
    assert main(["config", "show", "-t", "posix", "-D", "LOG_LEVEL=2", "--json"]) == 0
    rows = {row["symbol"]: row for row in json.loads(capsys.readouterr().out)}
    assert set(rows) == set(resolve("posix").values())
    assert rows["LOG_LEVEL"]["value"] == 2
    assert rows["LOG_LEVEL"]["default"] == 1
    assert rows["LOG_LEVEL"]["origin"] == "-D LOG_LEVEL=2"


def test_diff_shows_what_is_not_at_its_default(tmp_path: Path, capsys: Capture) -> None:
    own = tmp_path / "own.conf"
    own.write_text("CONFIG_LOG_THROTTLE_RATE=9\n")
    assert main(["config", "diff", "-t", "posix", "--conf", str(own)]) == 0
    lines = [line.split("  ")[0] for line in capsys.readouterr().out.splitlines()]
    assert lines == ['CONFIG_DDS_NETWORK_INTERFACE="lo"', "CONFIG_LOG_THROTTLE_RATE=9"]


def test_diff_of_two_targets(capsys: Capture) -> None:
    words = ["config", "diff", "-t", "s32z270dc2_rtu0_r52@D", "--against", "freertos_posix"]
    assert main(words) == 0
    lines = [line.split("  ")[0] for line in capsys.readouterr().out.splitlines()]
    assert lines == [
        '-CONFIG_CAN_DEVICE="mock"',
        '+CONFIG_CAN_DEVICE="socketcan:can0"',
        '-CONFIG_DDS_NETWORK_INTERFACE="lo"',
        '+CONFIG_DDS_NETWORK_INTERFACE="ethernet@74b00000"',
    ]
    assert main([*words, "--json"]) == 0
    pairs = json.loads(capsys.readouterr().out)
    assert [pair["freertos_posix"]["value"] for pair in pairs] == ["mock", "lo"]


def test_replaced_value_is_told_beside_the_output(capsys: Capture) -> None:
    assert main(["config", "show", "-t", "posix", "-D", "DDS_DOMAIN_ID=5"]) == 0
    told = capsys.readouterr().err
    assert told.startswith("note: -D DDS_DOMAIN_ID=5: CONFIG_DDS_DOMAIN_ID=5 replaces ")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["config", "show", "-t", "stm32"], "unknown target 'stm32', expected one of fvp_baser"),
        (["config", "show"], "the following arguments are required: -t/--target"),
        (["config", "diff", "-t", "posix", "-D", "LOG_LEVEL=9"], "expected a whole number from 0"),
        (
            ["config", "show", "-t", "posix", "-D", "NET_IFACE1_ADDR=here"],
            "expected an IPv4 address such as 192.0.2.10",
        ),
        (["menuconfig", "-t", "posix"], "menuconfig needs a terminal; without one use --conf"),
        (["menuconfig", "-t", "posx"], "did you mean 'posix'?"),
    ],
)
def test_refusal_is_one_line_and_code_2(words: list[str], told: str, capsys: Capture) -> None:
    assert main(words) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert line.startswith("island: error: ")
    assert told in line
