# SPDX-License-Identifier: Apache-2.0
"""The user's own configuration: one or more parts, each a file or XML, checked before use.

The library takes XML in a short form (``<Gen><Interfaces><Netw n="lo"/></></>``): names cut short,
``</>`` for any closing tag, no root. In a file it takes XML proper.
"""

from __future__ import annotations

import os
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from safety_island.errors import ConfigurationError
from safety_island.text_file import UnreadableError, read_text

URI = "CYCLONEDDS_URI"
_TAG = re.compile(
    r"<!--.*?-->|<\?.*?\?>|<(?P<close>/)?(?P<name>[^\s<>/]*)"
    r"(?P<attributes>(?:\"[^\"]*\"|'[^']*'|[^<>\"'])*?)(?P<empty>/)?>",
    re.DOTALL,
)


def user_xml() -> str | None:
    """Return the user's own configuration (``CYCLONEDDS_URI``), None when there is none."""
    return os.environ.get(URI) or None


def check_user_xml(uri: str) -> None:
    """Raise ConfigurationError for what the library would pass over: broken XML, missing files."""
    if not uri.isascii():
        raise ConfigurationError(f"{URI} holds characters outside ASCII: {uri!r}")
    for part in parts(uri):
        if part.startswith("<"):
            _check(URI, written_out(part))
        else:
            path = part.removeprefix("file://")
            _check(path, _text(path))


def parts(uri: str) -> list[str]:
    """Split a configuration at its commas, those inside XML left alone."""
    found = []
    rest = uri
    while rest := rest.strip(", \t\r\n"):
        start = _end_of_document(rest) if rest.startswith("<") else 0
        end = rest.find(",", start)
        part, rest = (rest, "") if end < 0 else (rest[:end], rest[end:])
        found.append(part.strip())
    return found


def written_out(text: str) -> str:
    """Return the short form as XML proper: each ``</>`` with the name of what it closes."""
    opened: list[str] = []

    def replace(tag: re.Match[str]) -> str:
        if tag["close"] and not tag["name"] and opened:
            return f"</{opened.pop()}>"
        _follow(tag, opened)
        return tag[0]

    return _TAG.sub(replace, text)


def _end_of_document(text: str) -> int:
    """Return where the first element of the text ends; its length when it does not."""
    opened: list[str] = []
    for tag in _TAG.finditer(text):
        _follow(tag, opened)
        if not opened and tag["name"] is not None:
            return tag.end()
    return len(text)


def _follow(tag: re.Match[str], opened: list[str]) -> None:
    """Keep the names of the elements that are open behind a tag."""
    if tag["name"] is None:  # a comment, or an instruction
        return
    if tag["close"]:
        del opened[-1:]
    elif not tag["empty"]:
        opened.append(tag["name"])


def _text(path: str) -> str:
    try:
        return read_text(Path(path))
    except UnreadableError as why:
        shown = path if path.isprintable() else repr(path)
        raise ConfigurationError(f"{URI}: cannot read {shown}: {why}") from None


def _check(where: str, text: str) -> None:
    try:
        ElementTree.fromstring(text)
    except ElementTree.ParseError as problem:
        line, column = problem.position
        what = str(problem).partition(":")[0]
        raise ConfigurationError(f"{where}:{line}:{column + 1}: not XML: {what}") from None
    except (RecursionError, ValueError) as problem:
        raise ConfigurationError(f"{where}: not XML: {problem}") from None
