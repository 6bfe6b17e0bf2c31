# SPDX-License-Identifier: Apache-2.0
"""Bytes of the five inputs to records: kernels, bounded against every hostile length."""
