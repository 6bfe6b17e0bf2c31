# SPDX-License-Identifier: Apache-2.0
"""One wait for the subscriptions of several participants, whatever their domains."""

from __future__ import annotations

import ctypes as ct
from types import TracebackType
from typing import Any, Generic, TypeVar

from cyclonedds.internal import DDS, dds_c_t

from safety_island.dds.endpoints import Subscription
from safety_island.dds.errors import DdsError

T = TypeVar("T")
_LIBRARY = 0x7FFF0100
"""``DDS_CYCLONEDDS_HANDLE``: the library as a whole, the parent of all domains."""


def _function(name: str, *arguments: Any) -> Any:
    """Return a C function with a prototype of its own: cyclonedds sets others on the library."""
    library: Any = DDS._dll_handle
    return ct.CFUNCTYPE(ct.c_int32, *arguments)((name, library))


_entity = dds_c_t.entity
_create = _function("dds_create_waitset", _entity)
_attach = _function("dds_waitset_attach", _entity, _entity, ct.c_ssize_t)
_detach = _function("dds_waitset_detach", _entity, _entity)
_wait = _function("dds_waitset_wait", _entity, ct.c_void_p, ct.c_size_t, ct.c_int64)
_delete = _function("dds_delete", _entity)


class WaitGroup(Generic[T]):
    """Wakes one thread for many subscriptions and says for which; a context manager.

    Create it while a participant is open. Each subscription has an owner, which ``wait`` returns.
    """

    def __init__(self) -> None:
        self._waitset: int = _create(_LIBRARY)
        if self._waitset < 0:
            raise DdsError(f"no wait set could be made ({self._waitset})")
        self._owners: dict[int, T] = {}
        self._ready: Any = (ct.c_ssize_t * 1)()

    def add(self, subscription: Subscription, owner: T) -> None:
        """Wake for this subscription from now on."""
        reference = subscription.condition._ref
        code = _attach(self._waitset, reference, reference)
        if code < 0:
            raise DdsError(f"a subscription cannot be waited for ({code})")
        self._owners[reference] = owner
        self._ready = (ct.c_ssize_t * len(self._owners))()

    def remove(self, subscription: Subscription) -> None:
        """Forget a subscription; do so before it is closed."""
        reference = subscription.condition._ref
        _detach(self._waitset, reference)
        self._owners.pop(reference, None)

    def wait(self, timeout_s: float) -> list[T]:
        """Wait until something can be taken; the owners of what is ready, after a timeout none.

        ``timeout_s`` in s. Other Python threads run meanwhile. Raises DdsError.
        """
        ready = self._ready
        count = _wait(self._waitset, ready, len(ready), round(timeout_s * 1e9))
        if count < 0:
            raise DdsError(f"waiting for samples failed ({count})")
        return [self._owners[ready[i]] for i in range(min(count, len(ready)))]

    def close(self) -> None:
        """Give the wait set back. A second call does nothing."""
        if self._waitset:
            _delete(self._waitset)
            self._waitset = 0

    def __enter__(self) -> WaitGroup[T]:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
