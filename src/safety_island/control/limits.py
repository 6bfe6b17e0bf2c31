# SPDX-License-Identifier: Apache-2.0
"""Fixed sizes of the controller's memory; what does not fit is refused before a kernel sees it."""

MAX_POINTS = 4096
"""Points of one received trajectory."""

MAX_REFERENCE = 16384
"""Points of the resampled reference path (1.6 km at the usual 0.1 m)."""

EXTENSION_POINTS = 512
"""Room for the points that the terminal extension appends (10 m at 0.02 m)."""

MAX_HORIZON = 64
"""Steps of the MPC."""

MAX_DELAY_STEPS = 64
"""Control periods of input delay that the MPC compensates."""

MAX_RATE_TABLE = 32
"""Entries of a steering-rate-limit table."""

MAX_HISTORY = 256
"""Entries of a bounded command or speed history (1 s at 30 ms is 34)."""

MAX_OFFSET_SAMPLES = 4096
"""Samples of the steering offset estimator."""

MAX_SHAPE_HISTORY = 1024
"""End points of past trajectories that the shape-change test remembers (5 s at 100 Hz is 500)."""
