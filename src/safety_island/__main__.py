# SPDX-License-Identifier: Apache-2.0
"""The command ``island``, also as ``python -m safety_island``."""

import os
import signal
import sys

_LIBRARY_SETTINGS = {
    # Nothing here multiplies large matrices. With a thread for each core OpenBLAS would reserve
    # 32 MB of address space for each, so that what a start needs depended on the machine.
    "OPENBLAS_NUM_THREADS": "1",
}


def start() -> int:
    """Load and run the command; Ctrl-C while modules load ends the process without a traceback.

    A parent may have left the signals that end a process blocked: they would never be heard.
    """
    signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT, signal.SIGTERM, signal.SIGHUP))
    handler = signal.getsignal(signal.SIGINT)
    if handler is signal.default_int_handler:  # not where the shell had it ignored
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    for name, value in _LIBRARY_SETTINGS.items():
        os.environ.setdefault(name, value)
    from safety_island.cli.main import main

    signal.signal(signal.SIGINT, handler)
    return main()


if __name__ == "__main__":
    sys.exit(start())
