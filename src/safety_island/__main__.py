"""The command ``island``, also as ``python -m safety_island``."""

import signal
import sys


def start() -> int:
    """Load and run the command; Ctrl-C while modules load ends the process without a traceback."""
    handler = signal.getsignal(signal.SIGINT)
    if handler is signal.default_int_handler:  # not where the shell had it ignored
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from safety_island.cli.main import main

    signal.signal(signal.SIGINT, handler)
    return main()


if __name__ == "__main__":
    sys.exit(start())
