# SPDX-License-Identifier: Apache-2.0
"""The command ``island``: one small file for each of its commands."""
