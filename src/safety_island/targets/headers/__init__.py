# SPDX-License-Identifier: Apache-2.0
"""C headers: records, constants, interface and messages, made from the Python that defines them."""
