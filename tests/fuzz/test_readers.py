# SPDX-License-Identifier: Apache-2.0
"""Every reader of files against thousands of broken ones: an orderly refusal, or a clean load.

No other exception, no end that does not come, no memory without bound. ``SAFETY_ISLAND_FUZZ=50``
tries so many times as many cases, ``SAFETY_ISLAND_FUZZ_SEED`` others.
"""

from __future__ import annotations

import os
import random
from pathlib import Path

import pytest

from tests.fuzz.limits import StillAtItError, limited
from tests.fuzz.readers import FINDINGS, READERS, FaultError, Reader

TIMES = int(os.environ.get("SAFETY_ISLAND_FUZZ", "1"))
SEED = os.environ.get("SAFETY_ISLAND_FUZZ_SEED", "1")

each_reader = pytest.mark.parametrize("reader", READERS, ids=lambda reader: reader.name)


def told_of(reader: Reader, path: Path) -> str:
    """What a user is told of a file; fails when that is no refusal in whole lines."""
    try:
        with limited():
            told = reader.read(path)
    except (Exception, StillAtItError) as fault:
        raise FaultError(f"{reader.name}: {type(fault).__name__}: {fault}; see {path}") from fault
    return told


@each_reader
def test_good_files_are_read(reader: Reader, tmp_path: Path) -> None:
    """Else the broken ones would be refused for another reason."""
    for number, data in enumerate(reader.good()):
        path = tmp_path / f"good{number}{reader.suffix}"
        path.write_bytes(data)
        assert told_of(reader, path) == ""


@each_reader
@pytest.mark.timeout(600 * TIMES)
def test_broken_files_are_refused_or_read(reader: Reader, tmp_path: Path) -> None:
    good, refused = reader.good(), 0
    for number in range(reader.cases * TIMES):
        rng = random.Random(f"{reader.name} {SEED} {number}")
        path = tmp_path / f"case-{SEED}-{number}{reader.suffix}"
        path.write_bytes(reader.change(rng.choice(good), rng))
        refused += bool(told_of(reader, path))
        path.unlink()
    assert refused  # the changes do harm, and somebody notices


FOUND = [
    (reader, path) for reader in READERS for path in sorted((FINDINGS / reader.name).glob("*"))
]


@pytest.mark.parametrize(
    ("reader", "path"), FOUND, ids=lambda item: getattr(item, "stem", getattr(item, "name", ""))
)
def test_files_that_broke_a_reader_once(reader: Reader, path: Path, tmp_path: Path) -> None:
    copy = tmp_path / f"{path.stem}{reader.suffix}"
    copy.write_bytes(path.read_bytes())
    assert told_of(reader, copy)
