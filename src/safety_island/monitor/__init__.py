# SPDX-License-Identifier: Apache-2.0
"""The live page: what the island does, seen in a browser."""
