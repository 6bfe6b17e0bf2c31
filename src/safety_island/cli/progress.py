# SPDX-License-Identifier: Apache-2.0
"""Shows what is going on while the control kernels are compiled."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from multiprocessing import get_context
from time import perf_counter, sleep
from typing import TextIO

from safety_island.platform.posix.process import end_with

Report = Callable[[str, int, int], None]
"""Told the name of a kernel that is done, its index and the count."""
LOCK_LIMIT_S = 60.0
"""Longest wait [s] of one start for other processes that compile the same kernels."""
LOCK_POLL_S = 0.2


def prepare_kernels(on_demand: bool = False) -> None:
    """Load the control kernels, compiling them first when they are not on disk.

    A compilation takes tens of seconds once, so it says what it does, on standard error; loading
    compiled code is quick and leaves nothing on the screen. ``on_demand``: also those that only
    some uses need.
    """
    missing = _missing(on_demand)
    from safety_island.kernel import kernel

    if note := kernel.cache_note():
        _say(note)
    if missing:
        started = perf_counter()
        with _display() as show:
            _compile(missing, show)
        _say(f"control kernels compiled in {perf_counter() - started:.0f} s")
    kernel.prepare()


def _missing(on_demand: bool) -> list[str]:
    """Name the island's kernels of which no compiled code is on disk."""
    from safety_island.kernel import kernel
    from safety_island.kernel.entries import all_entries

    wanted = all_entries(on_demand)
    return [item.name for item in wanted if kernel.JIT and not item.is_on_disk()]


def _compile(names: list[str], show: Report) -> None:
    """Compile each kernel, in processes of their own when the code is kept for this one to load."""
    from safety_island.kernel import kernel

    if not kernel.is_kept():
        for index, name in enumerate(names):
            show(_compile_one(name), index, len(names))
        return
    end = perf_counter() + LOCK_LIMIT_S  # of the monotonic clock, which all processes share
    with ProcessPoolExecutor(
        os.cpu_count(),
        mp_context=get_context("spawn"),
        initializer=end_with,
        initargs=(os.getpid(),),
    ) as pool:
        running = [pool.submit(_compile_kept, name, end) for name in names]
        for index, done in enumerate(as_completed(running)):
            show(done.result(), index, len(names))


def _compile_kept(name: str, end: float) -> str:
    """Compile a kernel, unless another process that does so stands still."""
    if _wait_for_others(name, end):
        _compile_one(name)
    return name


def _compile_one(name: str) -> str:
    from safety_island.kernel.entries import all_entries

    entries = {item.name: item for item in all_entries(on_demand=True)}
    entries[name].prepare()
    return name


def _wait_for_others(name: str, end: float) -> bool:
    """Wait until no other process compiles the kernel, and say so; False: it still did at ``end``.

    What is then still missing is compiled by the process that needs it, and not kept.
    """
    from safety_island.kernel import cache

    is_told = False
    while True:
        with cache.lock(name) as is_free:
            if is_free:
                return True
        holder = cache.lock_holder(name)
        who = f"process {holder}" if holder else "another process"
        if perf_counter() > end:
            _say(f"{who} still holds the lock of kernel {name}: compiling it for this run alone")
            return False
        if not is_told:
            left = end - perf_counter()
            _say(f"waiting at most {left:.0f} s for {who}, which compiles kernel {name}")
            is_told = True
        sleep(LOCK_POLL_S)


@contextmanager
def _display() -> Iterator[Report]:
    if sys.stderr.isatty():
        with _spinner() as show:
            yield show
    else:
        _say("compiling the control kernels, once; this takes some tens of seconds")
        yield lambda name, index, count: _say(f"  {index + 1} of {count} done: {name}")


@contextmanager
def _spinner() -> Iterator[Report]:
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("compiling the control kernels, once; some tens of seconds")

        def show(name: str, index: int, count: int) -> None:
            text = f"compiling the control kernels, {index + 1} of {count} done: {name}"
            progress.update(task, description=text)

        yield show


def _say(text: str) -> None:
    print(f"island: {text}", file=sys.stderr, flush=True)


@contextmanager
def tick_progress(title: str, total: int, stream: TextIO) -> Iterator[Callable[[int], None]]:
    """Show a bar while ticks go by, on a terminal; nothing elsewhere."""
    if not stream.isatty():
        yield lambda tick: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(file=stream), transient=True) as progress:
        task = progress.add_task(title, total=total)
        yield lambda tick: progress.update(task, completed=tick + 1)
