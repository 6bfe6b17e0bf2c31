# SPDX-License-Identifier: Apache-2.0
"""Replay of recorded runs through the real controller node on virtual time, and its judgement."""
