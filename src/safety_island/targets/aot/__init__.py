# SPDX-License-Identifier: Apache-2.0
"""Kernels compiled ahead of time: IR, objects for each machine, archives and libraries."""
