"""One wait for the subscriptions of several participants, whatever their domains."""

from __future__ import annotations

from types import TracebackType
from typing import Any

from cyclonedds.core import WaitSet

from safety_island.dds import binding
from safety_island.dds.endpoints import Subscription


class _Library:
    """Stands for the library as a whole, the parent of all domains (``DDS_CYCLONEDDS_HANDLE``)."""

    _ref = 0x7FFF0100


class WaitGroup:
    """Wakes one thread for many subscriptions; create it while a participant is open."""

    def __init__(self) -> None:
        library: Any = _Library()
        self._waitset = WaitSet(library)

    def add(self, subscription: Subscription) -> None:
        """Wake for this subscription from now on."""
        self._waitset.attach(subscription.condition)

    def remove(self, subscription: Subscription) -> None:
        """Forget a subscription; do so before it is closed."""
        self._waitset.detach(subscription.condition)

    def wait(self, timeout_s: float) -> bool:
        """Wait until one of them has something to take; False after ``timeout_s`` [s]."""
        return self._waitset.wait(round(timeout_s * 1e9)) > 0

    def close(self) -> None:
        """Give the wait set back. A second call does nothing."""
        binding.delete(self._waitset)

    def __enter__(self) -> WaitGroup:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
