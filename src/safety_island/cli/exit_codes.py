# SPDX-License-Identifier: Apache-2.0
"""What the exit code of ``island`` says, for its help and docs/json.md."""

from __future__ import annotations

EXIT_CODES: dict[int, str] = {
    0: "done, and what was asked holds",
    1: "a failure: something did not work, or a check did not hold",
    2: "usage or configuration: an option, a file or a variable that cannot be used",
    70: "a fault of the island itself, or less memory allowed than a start needs",
    130: "ended by Ctrl-C before there was anything to end in order",
    141: "nobody reads the output any more",
}
