# SPDX-License-Identifier: Apache-2.0
"""Every golden run through the controllers: ``python -m tests.targets.aot.fingerprint``.

Prints JSON: a hash of all commands and traces of each run, and the modules of a compiler that were
imported. Runs of OSQP, which is no kernel, are solved by ``daqp``.
"""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import replace

from safety_island.control.follower import TrajectoryFollower
from safety_island.replay.recording import load
from tests.golden.harness import name_of, parameters_of, played, run_paths

COMPILERS = ("numba", "llvmlite")


def fingerprint() -> dict[str, str]:
    """Return a hash of every bit that came out of each run, and of the number of commands."""
    found = {}
    for path in run_paths():
        run = load(path)
        parameters = parameters_of(run)
        if parameters.lateral.qp_solver_type == "osqp":
            lateral = replace(parameters.lateral, qp_solver_type="daqp")
            parameters = replace(parameters, lateral=lateral)
        follower = TrajectoryFollower(parameters)
        digest, commands = hashlib.sha256(), 0
        for _, now in played(run, follower):
            commands += follower.step(now)
            digest.update(follower.command.tobytes() + follower.trace.tobytes())
        found[name_of(path)] = f"{commands} {digest.hexdigest()}"
    return found


if __name__ == "__main__":
    runs = fingerprint()
    print(
        json.dumps({"compilers": [name for name in COMPILERS if name in sys.modules], "runs": runs})
    )
