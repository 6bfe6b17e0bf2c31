# SPDX-License-Identifier: Apache-2.0
"""The island's life cycle: from conditions to a state, and what each state lets out."""
