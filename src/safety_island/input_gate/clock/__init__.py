# SPDX-License-Identifier: Apache-2.0
"""Stamps of the inputs and the clock of their sender: kernels over one record for each input."""
