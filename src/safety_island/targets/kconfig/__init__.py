# SPDX-License-Identifier: Apache-2.0
"""Kconfig: symbols, fragments, places, the menu, and what a target's configuration means."""
