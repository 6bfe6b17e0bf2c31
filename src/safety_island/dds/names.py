# SPDX-License-Identifier: Apache-2.0
"""How ROS 2 names stand on the wire."""

from __future__ import annotations

import re

from safety_island.errors import ConfigurationError

TOPIC_PREFIX = "rt"
_NAME = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")


def dds_topic_name(topic: str) -> str:
    """Return the DDS name of a ROS topic: ``/a/b`` gives ``rt/a/b``.

    Raises ConfigurationError for a name that is not absolute or not legal in ROS 2.
    """
    if not _NAME.fullmatch(topic) or "__" in topic:
        raise ConfigurationError(
            f"topic name {topic!r} is not legal: expected /word/word with letters, digits and"
            " single underscores, no word starting with a digit"
        )
    return TOPIC_PREFIX + topic


def ros_topic_name(dds_name: str) -> str:
    """Return the ROS name of a DDS topic, or the name itself when it is no ROS topic."""
    return dds_name[len(TOPIC_PREFIX) :] if dds_name.startswith(f"{TOPIC_PREFIX}/") else dds_name
