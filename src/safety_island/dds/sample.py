# SPDX-License-Identifier: Apache-2.0
"""What a subscription gives."""

from __future__ import annotations

from typing import NamedTuple


class Sample(NamedTuple):
    """One received message: serialized CDR with its header, and where it came from."""

    data: bytes
    source_timestamp_ns: int
    """The writer's wall clock when it wrote [ns since the epoch]."""
    writer_guid: bytes
