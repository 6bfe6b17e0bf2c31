# SPDX-License-Identifier: Apache-2.0
"""Measurements on the machine at hand, stated as ratios to a yardstick of the same run."""
