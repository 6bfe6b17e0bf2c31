# SPDX-License-Identifier: Apache-2.0
"""A simulated main compute: vehicle, courses, planner, and the loops that join them."""
