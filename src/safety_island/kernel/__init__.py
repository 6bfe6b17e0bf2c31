# SPDX-License-Identifier: Apache-2.0
"""Kernels: how they are compiled, where the code is kept, and the library made ahead of time."""
