# SPDX-License-Identifier: Apache-2.0
"""Tries a configuration in a process of its own, since the library ends the process for some.

A peer that does not resolve, for example (release 0.10 goes on without it), or the peer 0.0.0.0.
"""

from __future__ import annotations

import re
import signal
import subprocess
import sys

from safety_island.dds.library.loading import loaded
from safety_island.dds.stderr import cause

_LIMIT_S = 60.0
"""Names are resolved meanwhile, and a name server may be slow."""
_START = """
import ctypes, sys
PR_SET_DUMPABLE = 4
ctypes.CDLL(None).prctl(PR_SET_DUMPABLE, 0, 0, 0, 0)  # no core file
library = ctypes.CDLL(sys.argv[1])
library.dds_create_domain.argtypes = [ctypes.c_uint32, ctypes.c_char_p]
library.dds_create_domain(int(sys.argv[2]), sys.argv[3].encode())
"""


BAD_PEER = re.compile(r"add_peer_address(?:es)?: (.*?): (?:unknown|not a valid) address")
"""What the library says of a peer that is no address and does not resolve."""


def why_fatal(domain_id: int, xml: str) -> str | None:
    """Return what the library says of a configuration that cannot be used; None when it can."""
    library = str(loaded().path)
    command = [sys.executable, "-I", "-S", "-c", _START, library, str(domain_id), xml]
    try:
        tried = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, timeout=_LIMIT_S, check=False
        )
    except subprocess.TimeoutExpired:
        return f"it does not come up within {_LIMIT_S:g} s; is a name server out of reach?"
    said = cause(tried.stderr.decode("utf-8", "replace"))
    if tried.returncode >= 0:
        return said if BAD_PEER.search(said) else None
    return said or f"the library ends with {signal.Signals(-tried.returncode).name}"
