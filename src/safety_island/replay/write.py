# SPDX-License-Identifier: Apache-2.0
"""What a replay gave, tick by tick, as CSV."""

from __future__ import annotations

from pathlib import Path

from safety_island.errors import IslandError
from safety_island.replay.check import Table
from safety_island.replay.guard_acts import GUARD_COLUMNS, guard_acts, names_of
from safety_island.replay.recording import CONTRACT_COLUMNS, Recording


def write_csv(folder: Path, run: Recording, replayed: dict[str, Table]) -> Path:
    """Write ``<scenario>__<run>.csv`` with full precision; return its path.

    The columns are those of the contract and, for a command that the guard changed or refused, the
    guard's verdict and the limits that acted. Raises IslandError when the folder cannot be written.
    """
    path = folder / f"{run.scenario}__{run.path.stem}.csv"
    columns = [replayed[name] for name in CONTRACT_COLUMNS]
    acts = {act.tick: act for act in guard_acts(replayed).acts}
    lines = [",".join((*CONTRACT_COLUMNS, *GUARD_COLUMNS))]
    for tick, row in enumerate(zip(*columns, strict=True)):
        t, published, *command = (float(value) for value in row)
        words = [repr(t), str(int(published)), *(repr(value) for value in command), "", ""]
        if act := acts.get(tick):
            words[-2:] = act.verdict.name, " ".join(names_of(act.limits))
        lines.append(",".join(words))
    try:
        path.write_text("\n".join(lines) + "\n")
    except OSError as error:
        raise IslandError(f"{path} cannot be written: {error.strerror}") from None
    return path
