# SPDX-License-Identifier: Apache-2.0
"""Records, of which all memory of the kernels is made: C-aligned, so that the type is the C struct.

A kernel takes a record as an array of shape (1,) and indexes it inside.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Records = npt.NDArray[Any]
"""A one-dimensional array of records."""


def record(columns: list[Any]) -> Any:
    """Return a C-aligned record type whose fields read as attributes, those of inner records too.

    ``columns``: name and type of each field, and its shape when it is an array.
    """
    placed: Any = np.dtype(
        [(name, _plain(kind), *shape) for name, kind, *shape in columns], align=True
    )
    layout: Any = {
        "names": placed.names,
        "formats": [(kind, *shape) if shape else kind for _, kind, *shape in columns],
        "offsets": [placed.fields[name][1] for name in placed.names],
        "itemsize": placed.itemsize,
        "aligned": True,
    }
    return np.dtype((np.record, np.dtype(layout)))


def _plain(kind: Any) -> Any:
    """Return the type without attributes: one with them has lost its alignment."""
    kind = np.dtype(kind)
    if kind.subdtype:
        base, shape = kind.subdtype
        return np.dtype((_plain(base), shape))
    if not kind.names:
        return kind
    fields = [kind.fields[name] for name in kind.names]
    formats, offsets = [_plain(inner) for inner, *_ in fields], [at for _, at, *_ in fields]
    layout: Any = {"names": kind.names, "formats": formats, "offsets": offsets}
    return np.dtype(layout | {"itemsize": kind.itemsize, "aligned": True})


def cells(records: Records) -> dict[str, memoryview[Any]]:
    """Return the scalar fields of a record of shape (1,), each as one number that can be set.

    ``cell[0] = value`` takes half the time that NumPy takes. The record must stay where it is.
    """
    memory: Any = records.view(np.uint8).data
    fields_of: Any = records.dtype.fields
    places = ((name, *fields_of[name][:2]) for name in fields_of)
    return {
        name: memory[at : at + kind.itemsize].cast(kind.char)
        for name, kind, at in places
        if kind.names is None and not kind.shape
    }
