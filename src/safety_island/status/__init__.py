# SPDX-License-Identifier: Apache-2.0
"""What the status of an island means: names, reasons in words, what holds the vehicle, JSON."""
