# SPDX-License-Identifier: Apache-2.0
"""The page's files: all of them are there, none is fetched from elsewhere."""

from __future__ import annotations

import re

from safety_island.monitor.files import HEADERS, load_page

FETCHED = re.compile(rb"""(?:src|href)=["']([^"'#]+)["']|from ["']\./([^"']+)["']""")


def test_every_file_that_the_page_names_is_served() -> None:
    page = load_page()
    named = {
        (match[1] or match[2]).decode()
        for file in page.values()
        if b"uPlot=function" not in file.body
        for match in FETCHED.finditer(file.body)
    }
    assert {"main.js", "style.css", "vendor/uPlot.iife.min.js"} <= named
    assert {f"/{name}" for name in named} <= set(page)


def test_no_address_of_another_host_and_no_script_in_the_text() -> None:
    ours = {name: file for name, file in load_page().items() if "vendor" not in name}
    for name, file in ours.items():
        addresses = re.findall(rb"https?://[^\s\"'`]+", file.body)
        assert not [a for a in addresses if not a.startswith(b"http://www.w3.org/")], name
    index = ours["/"].body
    assert not re.search(rb"<script(?![^>]*\bsrc=)|\son\w+=|style=", index)


def test_the_policy_allows_no_inline_script_and_no_other_host() -> None:
    policy = HEADERS["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "*" not in policy


def test_the_plot_library_comes_with_its_licence() -> None:
    page = load_page()
    assert b"MIT" in page["/vendor/uPlot.LICENSE.txt"].body
    assert b"v1.6." in page["/vendor/uPlot.iife.min.js"].body[:120]


def test_file_types() -> None:
    types = {name.rpartition(".")[2]: file.content_type for name, file in load_page().items()}
    assert types["js"].startswith("text/javascript")
    assert types["css"].startswith("text/css")
    assert load_page()["/"].content_type.startswith("text/html")
