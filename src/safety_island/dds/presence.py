# SPDX-License-Identifier: Apache-2.0
"""How a participant shows itself as a ROS 2 node: ``ros2 node list``, ``ros2 topic info``."""

from __future__ import annotations

from collections.abc import Iterable

from safety_island.dds.qos import LATCHED
from safety_island.errors import ConfigurationError
from safety_island.messages import codec

TOPIC = "ros_discovery_info"
"""DDS name; it has no ``rt/`` in front."""
TYPE = "rmw_dds_common/msg/ParticipantEntitiesInfo"
QOS = LATCHED
PARTICIPANT_USER_DATA = b"enclave=/;"


def presence(
    participant: bytes,
    namespace: str,
    node_name: str,
    readers: Iterable[bytes],
    writers: Iterable[bytes],
) -> bytes:
    """Return the serialized ParticipantEntitiesInfo of one node; all GUIDs have 16 bytes."""
    node = {
        "node_namespace": namespace,
        "node_name": node_name,
        "reader_gid_seq": [_gid(guid) for guid in readers],
        "writer_gid_seq": [_gid(guid) for guid in writers],
    }
    message = {"gid": _gid(participant), "node_entities_info_seq": [node]}
    return codec.encode(TYPE, message)


def nodes_of_writers(data: bytes) -> tuple[bytes, dict[bytes, str]]:
    """Return a participant's GUID and the full node name of each of its publishers.

    Raises DecodeError for what is no ParticipantEntitiesInfo.
    """
    message = codec.decode(TYPE, data)
    found = {}
    for node in message["node_entities_info_seq"]:
        name = f"{node['node_namespace'].rstrip('/')}/{node['node_name']}"
        found.update({bytes(gid["data"]): name for gid in node["writer_gid_seq"]})
    return bytes(message["gid"]["data"]), found


def check_node_name(name: str, namespace: str) -> None:
    """Raise ConfigurationError for a node name or namespace that ROS 2 does not allow."""
    parts = [part for part in namespace.split("/") if part]
    legal = all(part.isidentifier() and part.isascii() for part in [name, *parts])
    if not legal or not namespace.startswith("/") or len(name) > 255:
        raise ConfigurationError(
            f"node name {name!r} in namespace {namespace!r} is not legal: expected letters, digits"
            " and underscores, and a namespace that starts with /"
        )


def _gid(guid: bytes) -> dict[str, list[int]]:
    return {"data": list(guid)}
