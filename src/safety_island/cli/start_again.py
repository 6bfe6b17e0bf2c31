# SPDX-License-Identifier: Apache-2.0
"""Starting again where an interface has got another address: an open domain cannot move.

Peers know a participant by its address, so its domain has to be left and joined anew. The process
replaces itself by what it was started as, which keeps its number, scheduling and standard streams.
"""

from __future__ import annotations

import os
import sys
from typing import NoReturn


def must_rejoin() -> bool:
    """Whether an open domain has lost its address for another one."""
    from safety_island.dds.domain import must_rejoin

    return must_rejoin()


def start_again() -> NoReturn:
    """Replace this process by what it was started as."""
    sys.stdout.flush()
    sys.stderr.flush()
    os.execv(sys.executable, [sys.executable, *sys.orig_argv[1:]])
