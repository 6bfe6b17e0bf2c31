# SPDX-License-Identifier: Apache-2.0
"""What one scalar of a parameter file means, and how a value is shown to a reader."""

from __future__ import annotations

import re

_LONGEST = 80
"""Characters of a value that an error shows."""

_TRUE = {"true", "True", "TRUE", "yes", "Yes", "YES", "on", "On", "ON"}
_FALSE = {"false", "False", "FALSE", "no", "No", "NO", "off", "Off", "OFF"}
_NULL = {"", "~", "null", "Null", "NULL"}
_INTEGER = re.compile(r"[-+]?[0-9]{1,18}")
_FLOAT = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")
_SPECIAL = re.compile(r"([-+]?)\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


def interpret(text: str, quoted: bool) -> object:
    """Return the bool, int, float, None or str that a scalar stands for.

    As ROS 2 reads it, not as YAML 1.1 does: ``1e-6`` is a number, ``1:30`` and ``0x10`` are texts.
    """
    if quoted:
        return text
    if text in _TRUE or text in _FALSE:
        return text in _TRUE
    if text in _NULL:
        return None
    if _INTEGER.fullmatch(text):
        return int(text)
    if _FLOAT.fullmatch(text):
        return float(text)
    if _SPECIAL.fullmatch(text):
        return float(text.replace(".", ""))
    return text


def shown(value: object) -> str:
    """Return a value as a parameter file writes it."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, list | tuple):
        return "[" + ", ".join(shown(item) for item in value) + "]"
    return str(value)


def found(value: object) -> str:
    """Return a value with its type, for the words 'found ...' of an error."""
    if isinstance(value, str):
        return f"the text {value[:60]!r}"
    if isinstance(value, dict):
        return "a map"
    kinds = {bool: "a switch", int: "a whole number", float: "a number"}
    kind = kinds.get(type(value))
    text = shown(value)
    if len(text) > _LONGEST:
        text = text[: _LONGEST - 4].rstrip(" ,") + " ..."
        if isinstance(value, list | tuple):
            text += f"] ({len(value)} entries)"
    return text + (f" ({kind})" if kind else "")
