# SPDX-License-Identifier: Apache-2.0
"""One wait for the subscriptions of several participants, whatever their domains."""

from __future__ import annotations

import ctypes as ct
from types import TracebackType
from typing import Any, Generic, TypeVar

from safety_island.dds.endpoints import Subscription
from safety_island.dds.library.entity import checked, delete
from safety_island.dds.library.layouts import LIBRARY
from safety_island.dds.library.loading import loaded

T = TypeVar("T")


class WaitGroup(Generic[T]):
    """Wakes one thread for many subscriptions and says for which; a context manager.

    Create it while a participant is open. Each subscription has an owner, which ``wait`` returns.
    """

    def __init__(self) -> None:
        self._waitset = checked(loaded().dds_create_waitset(LIBRARY), "no wait set could be made")
        self._owners: dict[int, T] = {}
        self._ready: Any = (ct.c_ssize_t * 1)()

    def add(self, subscription: Subscription, owner: T) -> None:
        """Wake for this subscription from now on."""
        reference = subscription.condition
        code = loaded().dds_waitset_attach(self._waitset, reference, reference)
        checked(code, "a subscription cannot be waited for")
        self._owners[reference] = owner
        self._ready = (ct.c_ssize_t * len(self._owners))()

    def remove(self, subscription: Subscription) -> None:
        """Forget a subscription; do so before it is closed."""
        reference = subscription.condition
        loaded().dds_waitset_detach(self._waitset, reference)
        self._owners.pop(reference, None)

    def wait(self, timeout_s: float) -> list[T]:
        """Wait until something can be taken; the owners of what is ready, after a timeout none.

        ``timeout_s`` in s. Other Python threads run meanwhile. Raises DdsError.
        """
        ready = self._ready
        timeout_ns = round(timeout_s * 1e9)
        code = loaded().dds_waitset_wait(self._waitset, ready, len(ready), timeout_ns)
        count = checked(code, "waiting for samples failed")
        return [self._owners[ready[i]] for i in range(min(count, len(ready)))]

    def close(self) -> None:
        """Give the wait set back. A second call does nothing."""
        if self._waitset:
            delete(self._waitset)
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
