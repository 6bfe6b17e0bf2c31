# SPDX-License-Identifier: Apache-2.0
"""The input gate: what a sample must be before it may touch the controllers."""
