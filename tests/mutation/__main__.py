"""``tools/mutate``: mutation tests of the safety code, and docs/mutation.md."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from tests.mutation.mutants import Mutant, mutants
from tests.mutation.page import Result, excuse_of, read_excuses, update
from tests.mutation.runner import ROOMS, ROOT, Room, baseline, run, warm_up


def main(arguments: Sequence[str] | None = None) -> int:
    """Test the rooms that are named; 0 when every survivor is known to be equivalent."""
    parser = argparse.ArgumentParser(prog="tools/mutate", description=__doc__)
    names = [room.name for room in ROOMS]
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help=f"of {', '.join(names)}: all")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="mutants at once")
    parser.add_argument("--list", action="store_true", help="list the mutants, test none")
    parser.add_argument("--only", metavar="TEXT", default="", help="mutants of files with TEXT")
    options = parser.parse_args(arguments)
    for name in options.rooms:
        if name not in names:
            parser.error(f"no room {name!r}; expected one of {', '.join(names)}")
    chosen = [room for room in ROOMS if not options.rooms or room.name in options.rooms]
    warm_up()
    results = []
    for room in chosen:
        found = [m for m in mutants_of(room) if options.only in m.file]
        if options.list:
            print("\n".join(f"{m.file}:{m.line}: {m.change}" for m in found))
        elif (result := _tested(room, found, options.jobs)) is None:
            print(f"{room.name}: its tests fail without any change", file=sys.stderr)
            return 1
        else:
            results.append(result)
    if results and not options.only:
        print(f"wrote {update(results)}")
    return int(any(result.unexplained for result in results))


def mutants_of(room: Room) -> list[Mutant]:
    """Return every mutant of the sources of a room."""
    return [
        mutant
        for file in room.files()
        for mutant in mutants(str(file.relative_to(ROOT)), file.read_text("utf-8"))
    ]


def _tested(room: Room, found: list[Mutant], jobs: int) -> Result | None:
    seconds = baseline(room)
    if seconds is None:
        return None

    def told(done: int, survived: int) -> None:
        if sys.stdout.isatty() or done % 50 == 0 or done == len(found):
            end = "\r" if sys.stdout.isatty() and done < len(found) else "\n"
            print(f"{room.name}: {done} of {len(found)}, {survived} survive", end=end, flush=True)

    survivors = run(room, found, jobs, int(5 * seconds) + 5, told)
    result = Result(room.name, len(found), survivors, read_excuses())
    for mutant in survivors:
        why = excuse_of(mutant, result.excuses)
        word = "equivalent" if why else "SURVIVED"
        print(f"  {mutant.file}:{mutant.line}: {word}: {mutant.change}" + (why and f" ({why})"))
    return result


if __name__ == "__main__":
    sys.exit(main())
