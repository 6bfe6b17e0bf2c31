# SPDX-License-Identifier: Apache-2.0
"""Keeps a reader's room for one writer: what others write does not get into its cache.

All writers of a topic share a reader's cache, so one that floods it pushes out what another one
said. The library knows no way to ignore a writer; what it has is a filter that its receiving thread
asks about each sample before the sample gets in. That must not be Python, which would have to stop
the tick for it: it is the few instructions of ``tests/dds/writer_filter.ll``, as LLVM makes them.
On a processor that is not in the table nothing is kept out, and the samples are dropped later.
"""

from __future__ import annotations

import ctypes as ct
import mmap
import platform
from functools import cache

from safety_island.dds.library.entity import checked
from safety_island.dds.library.layouts import Filter
from safety_island.dds.library.loading import loaded

CODE = {
    "x86_64": "488b064885c07406483947207503b001c348ff460831c0c3",
    "aarch64": "280040f9880000b4091040f93f0108eb6100005420008052c0035fd6"
    "280440f9e0031f2a08050091280400f9c0035fd6",
}
"""Machine -> ``bool keeps(const dds_sample_info_t *, struct state *)``, which calls nothing."""

_BY_SAMPLE_INFO = 3
"""``DDS_TOPIC_FILTER_SAMPLEINFO_ARG``."""


class State(ct.Structure):
    """What the filter is told, and what it counts; one for each reader, which locks it."""

    _fields_ = (("writer", ct.c_uint64), ("kept_out", ct.c_uint64))


class WriterFilter:
    """Filters a topic entity that one reader uses, to be made before the reader is.

    ``state.writer`` is the handle of the writer that is kept to, 0: of all.
    """

    def __init__(self, topic: int) -> None:
        self.state = State()
        """Lives as long as the topic may be filtered: as long as this object."""
        address = function_address()
        if address is None:
            return
        filtered = Filter(_BY_SAMPLE_INFO, address, ct.addressof(self.state))
        code = loaded().dds_set_topic_filter_extended(topic, filtered)
        checked(code, "the writers of a topic cannot be kept apart")


@cache
def _memory() -> mmap.mmap | None:
    """Return executable memory that holds the code, None where there can be none."""
    code = CODE.get(platform.machine())
    if code is None:
        return None
    try:
        memory = mmap.mmap(
            -1,
            mmap.PAGESIZE,
            mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS,
            mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC,
        )
    except OSError:  # a system that forbids it
        return None
    memory.write(bytes.fromhex(code))
    return memory


@cache
def function_address() -> int | None:
    """Return where the code is, None where it cannot run."""
    memory = _memory()
    return None if memory is None else ct.addressof(ct.c_char.from_buffer(memory))
