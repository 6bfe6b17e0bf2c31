# SPDX-License-Identifier: Apache-2.0
"""The page of the demo: each fault is a click, and its reaction is seen and timed on the page."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import pytest

from tests.browser.browser import open_page

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = [pytest.mark.live, pytest.mark.browser, pytest.mark.slow, pytest.mark.timeout(600)]
LOSES_AN_INPUT = ("nan", "freeze odometry", "kill bridge", "still bridge", "still main-compute")
TIMED = re.compile(r"island SILENT after (\d+\.\d+) s(?:, bound (\d+\.\d+) s)?")


@contextmanager
def demo() -> Iterator[str]:
    """Run the demo lap after lap; yield the address of its page."""
    command = [sys.executable, "-m", "safety_island", "demo", "--plain", "--duration", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            for line in process.stdout:
                if found := re.search(r"the page: (http://\S+#\S+)", line):
                    yield found[1]
                    break
            else:
                raise AssertionError("the demo names no page")
        finally:
            process.send_signal(signal.SIGINT)
            process.communicate()


def test_each_fault_gives_its_reaction_and_clearing_lets_it_drive_again() -> None:
    with demo() as address, open_page(address) as (page, complaints):
        for fault in (*LOSES_AN_INPUT, "jump", "second island"):
            is_driving(page)
            break_it(page, fault)
            heal(page)
        assert complaints == []


def is_driving(page: Page) -> None:
    page.wait_for_selector("#lamps-island li:text-is('ACTIVE')[aria-current=true]")
    page.wait_for_function(
        "() => parseFloat(document.getElementById('now-speed').textContent) > 0.5"
    )


def break_it(page: Page, fault: str) -> None:
    """Press a button; the island falls silent, or goes on and names the second one."""
    page.click(f'[data-key="{fault}"]')
    page.wait_for_selector(f'[data-key="{fault}"][aria-pressed=true]')
    if fault == "second island":
        page.wait_for_selector("#events li >> text=second island started")
        page.wait_for_selector("#verdict:not([data-is=good])")
        return
    page.wait_for_selector("#lamps-island li:text-is('SILENT')[aria-current=true]")
    reaction = page.locator("#events li[data-of=reaction]").first
    reaction.wait_for()
    timed = TIMED.search(page.inner_text("#events"))
    assert timed is not None, page.inner_text("#events")
    assert float(timed[1]) > 0.0
    assert bool(timed[2]) == (fault in LOSES_AN_INPUT)


def heal(page: Page) -> None:
    """Clear every fault and arm the island until it is."""
    page.click('[data-key="clear"]')
    page.wait_for_function("() => !document.querySelector('#buttons [aria-pressed=true]')")
    for _ in range(30):
        if page.inner_text("#lamps-island [aria-current=true]") == "ACTIVE":
            return
        page.click('[data-key="arm"]')
        page.wait_for_timeout(2000)  # the island answers within that time, whatever it answers
    raise AssertionError(page.inner_text("#why"))
