# SPDX-License-Identifier: Apache-2.0
"""The programs that a build can make of a target whose machine runs Python."""

from __future__ import annotations

from typing import NamedTuple


class Product(NamedTuple):
    """One row; ``entry`` is ``module:function``, ``file`` the name without its suffix."""

    name: str
    file: str
    entry: str
    summary: str

    @property
    def manifest(self) -> str:
        """The name of its manifest."""
        return "manifest.json" if self is APPLICATION else f"manifest-{self.name}.json"


_TESTS = "safety_island.cli.programs"

APPLICATION = Product("application", "safety-island", "safety_island.__main__:start", "the island")
UNIT_TEST = Product(
    "unit-test",
    "safety-island-unit-test",
    f"{_TESTS}.unit_test:main",
    "build the node and DDS round-trip test program instead of the application",
)
DDS_PUBLISHER = Product(
    "dds-publisher",
    "safety-island-dds-publisher",
    f"{_TESTS}.dds_publisher:main",
    "build the program that publishes sample messages in a loop",
)
DDS_SUBSCRIBER = Product(
    "dds-subscriber",
    "safety-island-dds-subscriber",
    f"{_TESTS}.dds_subscriber:main",
    "build the program that logs each message that it receives",
)
TEST_PROGRAMS = (UNIT_TEST, DDS_PUBLISHER, DDS_SUBSCRIBER)
