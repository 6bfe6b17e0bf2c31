# SPDX-License-Identifier: Apache-2.0
"""The trajectory follower: array mathematics only, no clock, no I/O, no allocation in a tick."""
