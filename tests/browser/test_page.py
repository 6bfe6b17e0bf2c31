# SPDX-License-Identifier: Apache-2.0
"""The live page in a real browser, before an island that says what the test wants."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from safety_island.life_cycle.state import State
from tests.browser.browser import OVERLAPS, open_page
from tests.status.samples import NOT_FINITE, ODOMETRY, STALE, FakeIsland, sample

pytestmark = [pytest.mark.live, pytest.mark.browser, pytest.mark.timeout(300)]
SIZES = ((360, 780), (1280, 900), (2560, 1300))


@contextmanager
def monitor(domain_id: int, *arguments: str) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """Run the monitor; yield the address of its page, and the process."""
    command = ["monitor", "--domain", str(domain_id), "--json", *arguments]
    with subprocess.Popen(
        [sys.executable, "-m", "safety_island", *command],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            assert process.stdout is not None
            yield str(json.loads(process.stdout.readline())["address"]), process
        finally:
            process.terminate()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_values_on_the_page_are_those_on_the_domain(domain_id: int, scheme: str) -> None:
    status = sample(
        lateral_error=0.0625, target_vel=6.5, stop_dist=47.25, tick_time=0.00125, command_angle=0.5
    )
    with (
        FakeIsland(domain_id, status),
        monitor(domain_id) as (address, _),
        open_page(address, color_scheme=scheme) as (page, complaints),
    ):
        page.wait_for_selector("#verdict[data-is=good]")
        page.wait_for_function("() => document.getElementById('now-tick').textContent === '1.25'")
        shown = {name: page.inner_text(f"#now-{name}") for name in ("lateral", "target", "stop")}
        assert shown == {"lateral": "0.063", "target": "6.50", "stop": "47.3"}
        assert page.inner_text("#lamps-island [aria-current=true]") == "ACTIVE"
        assert page.inner_text("#lamps-controller [aria-current=true]") == "DRIVE"
        assert page.inner_text("#why").startswith("All is well")
        assert page.inner_text("b[data-field=command_angle]") == "0.500"
        assert "0.09 of 0.90 s" in page.inner_text("#inputs")
        assert complaints == []


def test_a_silence_is_shown_with_its_reason_and_what_to_do(domain_id: int) -> None:
    with (
        FakeIsland(domain_id, sample({ODOMETRY: NOT_FINITE}, **STALE)),
        monitor(domain_id) as (address, _),
        open_page(address) as (page, complaints),
    ):
        page.wait_for_selector("#verdict[data-is=bad]")
        assert page.inner_text("#state") == "SILENT"
        assert "NaN or infinite" in page.inner_text("#why")
        assert "last 3 refused: not finite" in page.inner_text("#inputs")
        assert "not finite" in page.inner_text("#counters")
        assert complaints == []


def test_nothing_overlaps_at_any_width(domain_id: int) -> None:
    buttons = [{"key": "nan", "label": "NaN odometry", "active": True}]
    lines = (
        {"event": "buttons", "buttons": buttons * 12},
        {"event": "mark", "text": "page: odometry is NaN", "of": "fault"},
        {"event": "can", "can": {"frames": ["123#0011223344556677"], "sequence": 7}},
    )
    with (
        FakeIsland(domain_id, sample({ODOMETRY: NOT_FINITE}, **STALE)),
        monitor(domain_id, "--console") as (address, process),
        open_page(address) as (page, complaints),
    ):
        assert process.stdin is not None
        process.stdin.writelines(f"{json.dumps(line)}\n" for line in lines)
        process.stdin.flush()
        page.wait_for_selector("#buttons button >> nth=11")
        page.wait_for_selector("#verdict[data-is=bad]")
        for width, height in SIZES:
            page.set_viewport_size({"width": width, "height": height})
            page.wait_for_function(
                "() => [...document.querySelectorAll('.plot canvas')].every("
                "(c) => c.getBoundingClientRect().right <= innerWidth)"
            )
            assert page.evaluate(OVERLAPS) == [], width
        page.evaluate("document.getElementById('where').style.marginTop = '-12px'")
        assert page.evaluate(OVERLAPS), "the check itself sees an overlap"
        assert complaints == []


def test_a_button_reports_its_key_once_and_only_with_the_token(domain_id: int) -> None:
    line = {"event": "buttons", "buttons": [{"key": "nan", "label": "NaN odometry"}]}
    with monitor(domain_id, "--console") as (address, process):
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(f"{json.dumps(line)}\n")
        process.stdin.flush()
        with open_page(address.partition("#")[0]) as (page, _):
            page.wait_for_selector("#buttons button:disabled")
        with open_page(address) as (page, complaints):
            page.click("#buttons button")
            assert json.loads(process.stdout.readline()) == {"event": "press", "key": "nan"}
            assert complaints == []


def test_loss_and_return_of_the_connection_are_shown(domain_id: int) -> None:
    with FakeIsland(domain_id, sample()), monitor(domain_id) as (address, first):
        port = address.rstrip("/").rpartition(":")[2]
        with open_page(address) as (page, _):
            page.wait_for_selector("#link[data-is=live]")
            first.kill()
            page.wait_for_selector("#link[data-is=lost]")
            first.wait()
            with monitor(domain_id, "--port", port) as (again, _):
                assert again == address
                page.wait_for_selector("#link[data-is=live]")
                page.wait_for_selector("#verdict[data-is=good]")


def test_pause_scroll_and_files(domain_id: int, tmp_path: Path) -> None:
    with (
        FakeIsland(domain_id, sample(lateral_error=0.25)),
        monitor(domain_id) as (address, _),
        open_page(address) as (page, complaints),
    ):
        page.wait_for_selector("#verdict[data-is=good]")
        page.wait_for_timeout(1500)  # some rows to save
        page.keyboard.press("Space")
        assert page.inner_text("#pause") == "Go on"
        assert page.get_attribute("#link", "data-is") == "paused"
        for button, name in (("#save-csv", "drive.csv"), ("#save-png", "drive.png")):
            with page.expect_download() as found:
                page.click(button)
            found.value.save_as(tmp_path / name)
        page.keyboard.press("End")
        assert page.inner_text("#back-said") == "live"
        assert complaints == []
    rows = list(csv.DictReader((tmp_path / "drive.csv").read_text().splitlines()))
    assert len(rows) > 20
    assert {row["lateral_error [m]"] for row in rows} == {"0.25"}
    assert {row["state [number]"] for row in rows} == {str(int(State.ACTIVE))}
    assert (tmp_path / "drive.png").read_bytes().startswith(b"\x89PNG")


def test_keys_change_theme_and_view(domain_id: int) -> None:
    with (
        FakeIsland(domain_id, sample()),
        monitor(domain_id) as (address, _),
        open_page(address, color_scheme="light") as (page, complaints),
    ):
        page.wait_for_selector("#verdict[data-is=good]")
        ink = page.evaluate("getComputedStyle(document.body).color")
        for theme in ("light", "dark", "system"):
            page.keyboard.press("t")
            assert page.inner_text("#theme") == f"Theme: {theme}"
            is_dark = page.evaluate("getComputedStyle(document.body).color") != ink
            assert is_dark == (theme == "dark")
        page.keyboard.press("f")
        assert page.get_attribute("#follow", "aria-pressed") == "false"
        assert complaints == []
