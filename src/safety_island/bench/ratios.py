# SPDX-License-Identifier: Apache-2.0
"""What the ratios mean that ``island bench``, its help and the README state: one definition each.

``YARDSTICK`` is measured in every run. The firmware is not part of this repository, so the ratios
to its C++ cannot be measured on the machine at hand: they were measured once, as ``METHOD`` says,
and are times of the C++ over times of the island, not yardsticks.
"""

YARDSTICK = (
    "one cold solve of a fixed problem by OSQP (set-up, solve and polish), by OSQP's own clock,"
    " measured in the same run"
)

METHOD = (
    "measured side by side: the benchmark run, in one run of both, on one core, in turn, the C++"
    " compiled with -O3, `unconstraint_fast` in both"
)
HEAP_TUNED = 36.8
"""Controllers of both; the C++ with its heap tuned, which is its best."""
AS_SHIPPED = 41.6
"""The same, the C++ with the heap as it is shipped."""
INSTRUCTIONS = 37.8
"""The same, instructions in place of time."""
WHOLE_NODE = 13.1
"""The controllers of the C++ alone over the island's whole node."""
POINTS = {50: 28, 3000: 65}
"""Controllers of both, by the points of the trajectory."""
HORIZON = {10: 36, 64: 41}
"""Controllers of both, by the steps of the horizon."""
