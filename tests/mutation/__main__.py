# SPDX-License-Identifier: Apache-2.0
"""``tools/mutate``: mutation tests of the safety code and of what decides around it."""

from __future__ import annotations

import argparse
import os
import random
import sys
from collections.abc import Sequence
from fnmatch import fnmatch

from tests.mutation.mutants import Mutant, mutants
from tests.mutation.page import Result, excuse_of, read_excuses, update
from tests.mutation.runner import ROOMS, ROOT, SOURCE, Room, baseline, run, warm_up


def main(arguments: Sequence[str] | None = None) -> int:
    """Test the rooms that are named; 0 when every survivor is known to be equivalent."""
    options = _options(arguments)
    chosen = [room for room in ROOMS if not options.rooms or room.name in options.rooms]
    if not options.list:
        warm_up()
    results = []
    for room in chosen:
        every = mutants_of(room, options.files)
        found = drawn(every, options.sample, options.seed)
        if options.list:
            print("\n".join(mutant.place for mutant in found))
        elif (result := _tested(room, found, options.jobs)) is None:
            print(f"{room.name}: its tests fail without any change", file=sys.stderr)
            return 1
        else:
            results.append(result.of(len(every), options.seed))
    if results and not options.files:
        print(f"wrote {update(results)}")
    return int(any(result.unexplained for result in results))


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="tools/mutate", description=__doc__)
    names = [room.name for room in ROOMS]
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help=f"of {', '.join(names)}: all")
    parser.add_argument(
        "--files",
        nargs="+",
        default=[],
        metavar="NAME",
        help="only files of the rooms that are so named, * and ? allowed; the page stays as it is",
    )
    parser.add_argument("--sample", type=int, metavar="N", help="only N mutants of a room, by lot")
    parser.add_argument("--seed", type=int, default=1, help="which N these are (default: 1)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="mutants at once")
    parser.add_argument("--list", action="store_true", help="list the mutants, test none")
    options = parser.parse_args(arguments)
    for name in options.rooms:
        if name not in names:
            parser.error(f"no room {name!r}; expected one of {', '.join(names)}")
    return options


def mutants_of(room: Room, patterns: Sequence[str] = ()) -> list[Mutant]:
    """Return every mutant of the sources of a room, or of those files that a pattern names."""
    return [
        mutant
        for file in room.files()
        if not patterns or any(_is_named(str(file.relative_to(SOURCE)), p) for p in patterns)
        for mutant in mutants(str(file.relative_to(ROOT)), file.read_text("utf-8"))
    ]


def _is_named(path: str, pattern: str) -> bool:
    return fnmatch(path, f"*/{pattern}") or fnmatch(path, f"*/{pattern}.py")


def drawn(found: list[Mutant], sample: int | None, seed: int) -> list[Mutant]:
    """Return so many of the mutants by lot, in their order; the same for the same seed."""
    if sample is None or sample >= len(found):
        return found
    chosen = random.Random(seed).sample(range(len(found)), sample)
    return [found[i] for i in sorted(chosen)]


def _tested(room: Room, found: list[Mutant], jobs: int) -> Result | None:
    seconds = baseline(room)
    if seconds is None:
        return None
    excuses = read_excuses()
    print(f"{room.name}: {len(found)} mutants; its tests take {seconds:.1f} s", flush=True)

    def told(done: int, survivor: Mutant | None) -> None:
        if survivor is not None:
            why = excuse_of(survivor, excuses)
            print(f"  {survivor.place}: {f'equivalent ({why})' if why else 'SURVIVED'}", flush=True)
        if done % 50 == 0 or done == len(found):
            print(f"  {done} of {len(found)}", flush=True)

    survivors = run(room, found, jobs, int(5 * seconds) + 5, told)
    return Result(room.name, len(found), survivors, excuses)


if __name__ == "__main__":
    sys.exit(main())
