# SPDX-License-Identifier: Apache-2.0
"""What is wrong with an input without ending the output; the bits stand in the status message."""

from __future__ import annotations

from enum import IntFlag


class InputWarning(IntFlag):
    """Warnings about one input."""

    AGE = 1
    RATE = 2
    CLOCK = 4
    DELAY = 8
    SECOND_PUBLISHER = 16
    PUBLISHER_CHANGED = 32
    CLOCK_STEP = 64
    CLOCK_RATE = 128
    YAW_REPLACED = 256


EXPLANATIONS: dict[InputWarning, tuple[str, str]] = {
    InputWarning.AGE: (
        "it is older than `gate.age_warning`",
        "look at its publisher, the bridge and the network",
    ),
    InputWarning.RATE: (
        "fewer samples come than 90 % of its usual rate",
        "look at the network, and at the load of the main compute",
    ),
    InputWarning.CLOCK: (
        "its stamp is more than `gate.clock_warning` away from the island's wall clock",
        "set the clocks of both machines by one source",
    ),
    InputWarning.DELAY: (
        "it is under way for longer than before, by more than half its age limit",
        "look at the bridge and the network",
    ),
    InputWarning.SECOND_PUBLISHER: (
        "another publisher is on its topic, and the island keeps to the first",
        "stop the second publisher",
    ),
    InputWarning.PUBLISHER_CHANGED: (
        "its publisher changed within the last second",
        "nothing, when it was restarted on purpose",
    ),
    InputWarning.CLOCK_STEP: (
        "its stamps jumped against the island's own clock within the last second",
        "let the clocks of both machines be slewed, not set, while the vehicle drives",
    ),
    InputWarning.CLOCK_RATE: (
        "the stamps of all inputs run slowly or fast, by more than 1 % of the island's own clock",
        "nothing for a simulation that is slower or faster than real time (`use_sim_time`);"
        " else look at the sender's clock, and whether the network holds all inputs up",
    ),
    InputWarning.YAW_REPLACED: (
        "orientations of its points contradict the path, and were replaced by its direction",
        "look at the planner: which module inserts points",
    ),
}
"""Warning -> what it means, what to do."""
