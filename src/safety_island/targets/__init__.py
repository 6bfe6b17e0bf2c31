# SPDX-License-Identifier: Apache-2.0
"""Targets, their configuration by Kconfig, and the build."""
