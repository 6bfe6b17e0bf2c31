"""Shows what is going on while the control kernels are compiled."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import TextIO

Report = Callable[[str, int, int], None]
"""Told the name of a kernel, its index and the count, before each one."""


def prepare_kernels() -> None:
    """Load the control kernels, compiling them first when they are not on disk.

    A compilation takes tens of seconds once, so it says what it does, on standard error; loading
    compiled code is quick and leaves nothing on the screen.
    """
    import safety_island.control.follower  # noqa: F401  (defines every entry)
    from safety_island.control import kernel

    cached = kernel.is_cached()
    started = perf_counter()
    with _display("loading" if cached else "compiling") as show:
        kernel.prepare(show)
    if not cached:
        _say(f"control kernels compiled in {perf_counter() - started:.0f} s")


@contextmanager
def _display(verb: str) -> Iterator[Report]:
    if sys.stderr.isatty():
        with _spinner(verb) as show:
            yield show
    elif verb == "loading":
        yield lambda name, index, count: None
    else:
        _say("compiling the control kernels, once; this takes some tens of seconds")
        yield lambda name, index, count: _say(f"  {index + 1} of {count}: {name}")


@contextmanager
def _spinner(verb: str) -> Iterator[Report]:
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("control kernels")

        def show(name: str, index: int, count: int) -> None:
            progress.update(
                task, description=f"{verb} control kernels, {index + 1} of {count}: {name}"
            )

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
