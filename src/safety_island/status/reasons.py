# SPDX-License-Identifier: Apache-2.0
"""The tables of reasons as sentences of a terminal: the subject named, no back-ticks."""

from __future__ import annotations

from safety_island.input_gate.reason import EXPLANATIONS as SAMPLE_REASONS
from safety_island.input_gate.reason import SampleReason
from safety_island.life_cycle.reason import EXPLANATIONS, Explanation, Reason
from safety_island.messages.status_fields import Status
from safety_island.status.names import input_name

_NEWER = "use the version of the island"


def explained(status: Status, number: int) -> Explanation:
    """Return what a reason means and what to do; ``number`` may be one of a newer island."""
    if number not in list(Reason):
        return Explanation(f"for reason {number}, unknown to this version", _NEWER)
    is_identity = number in (Reason.SECOND_PUBLISHER, Reason.WRITER_FLAPPING)
    other = "the topic of the command" if is_identity else "an input"
    subject = input_name(status.subject) or other
    found = EXPLANATIONS[Reason(number)]
    return Explanation(*(plain(text).replace("{subject}", subject) for text in found))


def explained_refusal(number: int) -> tuple[str, str]:
    """Return what the reason of a refusal means and what to do."""
    if number not in list(SampleReason):
        return f"reason {number}, unknown to this version", _NEWER
    meaning, action = SAMPLE_REASONS[SampleReason(number)]
    return plain(meaning), plain(action)


def plain(text: str) -> str:
    """Return a text of a table as a terminal shows it."""
    return text.replace("`", "'")
