"""What a replay gave, tick by tick, as CSV."""

from __future__ import annotations

from pathlib import Path

from safety_island.errors import IslandError
from safety_island.replay.check import Table
from safety_island.replay.recording import CONTRACT_COLUMNS, Recording


def write_csv(folder: Path, run: Recording, replayed: dict[str, Table]) -> Path:
    """Write ``<scenario>__<run>.csv`` with full precision; return its path.

    Raises IslandError when the folder cannot be written.
    """
    path = folder / f"{run.scenario}__{run.path.stem}.csv"
    columns = [replayed[name] for name in CONTRACT_COLUMNS]
    lines = [",".join(CONTRACT_COLUMNS)]
    for row in zip(*columns, strict=True):
        t, published, *command = (float(value) for value in row)
        lines.append(",".join([repr(t), str(int(published)), *(repr(value) for value in command)]))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines) + "\n")
    except OSError as error:
        raise IslandError(f"{path} cannot be written: {error.strerror}") from None
    return path
