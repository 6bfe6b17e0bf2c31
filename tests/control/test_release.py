# SPDX-License-Identifier: Apache-2.0
"""The table of rules: what each release changed, and nothing else."""

from __future__ import annotations

from dataclasses import asdict, fields

import pytest

from safety_island.control.records import PARAMS, pack_parameters
from safety_island.control.release import CHANGES, RELEASES, Rules, rules_of
from safety_island.params import from_mapping

NAMES = [item.name for item in fields(Rules)]


def test_releases_are_those_from_040_to_053() -> None:
    assert RELEASES[0] == "0.40" and RELEASES[-1] == "0.53" and len(RELEASES) == 14


def test_each_rule_changes_once() -> None:
    changed = [name for of_release in CHANGES.values() for name in of_release]
    assert sorted(changed) == sorted(NAMES)


@pytest.mark.parametrize("release", RELEASES)
def test_a_rule_holds_from_its_release_on(release: str) -> None:
    rules = asdict(rules_of(release))
    for since, changed in CHANGES.items():
        has_come = RELEASES.index(release) >= RELEASES.index(since)
        for name, value in changed.items():
            assert rules[name] == (value if has_come else type(value)(0)), name


def test_an_unknown_release() -> None:
    with pytest.raises(ValueError, match="not in tuple"):
        rules_of("0.39")


def test_the_rules_are_columns_of_the_parameters() -> None:
    packed = pack_parameters(from_mapping({"autoware_release": "0.53"}, "autoware-0.40"))[0]
    assert set(NAMES) <= set(PARAMS.names)
    for name, value in asdict(rules_of("0.53")).items():
        assert packed[name] == value


def test_ours_corrects_the_signs_in_reverse_whatever_the_release() -> None:
    for release in ("0.40", "0.45", "0.53"):
        values = {"autoware_release": release, "correct_reverse_signs": True}
        packed = pack_parameters(from_mapping(values))[0]
        assert packed.feedback_turns_in_reverse and packed.slope_turns_in_reverse
