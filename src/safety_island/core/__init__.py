# SPDX-License-Identifier: Apache-2.0
"""Where the rooms' kernels are compiled and joined."""
