# SPDX-License-Identifier: Apache-2.0
"""A headless Chromium that shows the live page, and everything it complains about."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Page

CHROMIUM = shutil.which("chromium")
QUIET = (
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
LIMIT_MS = 60_000
"""A machine that is busy with other tests takes its time."""


@contextmanager
def open_page(address: str, **context: Any) -> Iterator[tuple[Page, list[str]]]:
    """Open an address; yield the page, and the list that its complaints are added to."""
    if CHROMIUM is None:
        pytest.skip("needs the Debian package chromium")
    api = pytest.importorskip("playwright.sync_api", reason="needs the package playwright")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        page = browser.new_context(**context).new_page()
        page.set_default_timeout(LIMIT_MS)
        complaints: list[str] = []
        page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(address)
        yield page, complaints
        browser.close()


OVERLAPS = """() => {
  const name = (e) => `${e.tagName} ${e.id} '${e.textContent.trim().slice(0, 30)}'`;
  const shown = (e) => e.checkVisibility() && !e.closest("option, .uplot, .skip, .events, .toast");
  const boxes = []; // of each line of each text, and of each control: element, rectangle
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const { currentNode: text } = texts, parent = text.parentElement;
    if (!text.data.trim() || !shown(parent)) continue;
    const range = document.createRange();
    range.selectNodeContents(text);
    for (const r of range.getClientRects()) boxes.push([parent, text, r]);
  }
  for (const e of document.querySelectorAll("button, input, select")) {
    if (shown(e)) boxes.push([e, e, e.getBoundingClientRect()]);
  }
  const found = [];
  for (const [i, [a, node, p]] of boxes.entries()) {
    if (p.right > document.documentElement.clientWidth + 1) found.push(`${name(a)} is cut`);
    for (const [b, other, q] of boxes.slice(i + 1)) {
      if (node.contains(other) || other.contains(node)) continue;
      const width = Math.min(p.right, q.right) - Math.max(p.left, q.left);
      const height = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
      if (width > 1 && height > 1) found.push(`${name(a)} and ${name(b)}`);
    }
  }
  for (const e of new Set(boxes.map(([element]) => element))) {
    if (e.scrollWidth > e.clientWidth + 1 && e.clientWidth && !e.matches("input, select")) {
      found.push(`${name(e)} does not fit`);
    }
  }
  if (document.documentElement.scrollWidth > innerWidth) found.push("the page is too wide");
  return found;
}"""
"""Returns what is laid over something else, or cut."""
