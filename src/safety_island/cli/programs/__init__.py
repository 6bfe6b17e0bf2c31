# SPDX-License-Identifier: Apache-2.0
"""Test programs of the build: a publisher, a subscriber, and a round trip of the node over DDS."""
