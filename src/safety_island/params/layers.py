# SPDX-License-Identifier: Apache-2.0
"""Layers of values, one over the other, with where each value comes from."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from safety_island.params.consistency import Rule, inconsistencies
from safety_island.params.convert import NotAllowedError, convert, nearest
from safety_island.params.no_effect import NoEffect, no_effect
from safety_island.params.problem import Place, Problem
from safety_island.params.releases import FOREIGN, FORMER, RELEASE, SPANS, Former, decide
from safety_island.params.scalars import found, shown
from safety_island.params.schema import KNOWN
from safety_island.params.sets import file_of_key, sources_of
from safety_island.params.source import Source, read_source
from safety_island.params.tree import Entry, parse, value_of_text


@dataclass(frozen=True)
class Ignored:
    """A key that was accepted and has no effect, with the reason."""

    place: Place
    key: str
    reason: str

    def __str__(self) -> str:
        return f"{self.place}: {self.key}: no effect: {self.reason}"


@dataclass
class Layers:
    """Values by key as the layers so far give them; the latest of each key wins."""

    values: dict[str, Any] = field(default_factory=dict)
    origins: dict[str, Entry] = field(default_factory=dict)
    depth: dict[str, int] = field(default_factory=dict)
    refused: set[str] = field(default_factory=set)
    ignored: list[Ignored] = field(default_factory=list)
    translated: list[str] = field(default_factory=list)
    """Older keys that were read as today's, a line each."""
    problems: list[Problem] = field(default_factory=list)
    count: int = 0

    given: list[Entry] = field(default_factory=list)
    """What the user's files and overrides hold, in their order."""

    def add_file(self, path: Path) -> None:
        """Lay a file of the user over what is there."""
        source = read_source(path)
        if isinstance(source, Problem):
            self.problems.append(source)
        else:
            self.given += parse(source).entries
            self.add_source(source)

    def add_source(self, source: Source) -> None:
        """Lay the text of a file over what is there."""
        parsed = parse(source)
        self.problems += parsed.problems
        self.add_entries(parsed.entries)

    def add_mapping(self, overrides: Mapping[str, object], name: str) -> None:
        """Lay values by key over what is there; a text is read as a file would."""
        place = Place(name)
        entries = [
            Entry(key, self._plain(key, value, place), place, place)
            for key, value in _flat(overrides)
        ]
        self.given += entries
        self.add_entries(entries)

    def add_entries(self, given: Iterable[Entry]) -> None:
        """Lay entries over what is there; each key may stand once in a layer."""
        self.count += 1
        lines: dict[str, Place] = {}
        for entry in given:
            if entry.key in lines:
                text = f"found a second time, first at {lines[entry.key]}; expected once"
                self.problems.append(Problem(entry.place, entry.key, text))
            else:
                lines[entry.key] = entry.place
                self._add(entry)

    def _plain(self, key: str, value: object, place: Place) -> object:
        if not isinstance(value, str):
            return value
        try:
            return value_of_text(value)
        except yaml.YAMLError:
            self.problems.append(Problem(place, key, f"found {found(value)}; expected a value"))
            return value

    def _add(self, entry: Entry) -> None:
        known = KNOWN.get(entry.key)
        if known is None:
            self._add_unknown(entry, no_effect(entry.key))
            return
        self.origins[entry.key] = entry
        self.depth[entry.key] = self.count
        try:
            self.values[entry.key] = convert(known, entry.value)
            self.refused.discard(entry.key)
        except NotAllowedError as error:
            self.refused.add(entry.key)
            self.problems.append(Problem(entry.place, entry.key, str(error)))

    def _add_unknown(self, entry: Entry, reason: NoEffect | None) -> None:
        if entry.key in FORMER:
            self._add_former(entry, FORMER[entry.key])
        elif entry.key in FOREIGN:
            self.problems.append(Problem(entry.place, entry.key, FOREIGN[entry.key]))
        elif reason is None:
            near = nearest(entry.key)
            hint = f"; the nearest known key is {near}" if near else "; see docs/parameters.md"
            self.problems.append(Problem(entry.place, entry.key, f"is not a known key{hint}"))
        elif reason.only is not None and entry.value != reason.only:
            text = f"found {found(entry.value)}; only {shown(reason.only)} is built in"
            self.problems.append(Problem(entry.place, entry.key, text))
        else:
            self.ignored.append(Ignored(entry.place, entry.key, reason.reason))

    def _add_former(self, entry: Entry, former: Former) -> None:
        """Take the value of an older key over to today's, where there is such a value."""
        if former.today is None:
            text = f"is of files before {former.since}; write {former.replaced_by}"
            self.problems.append(Problem(entry.place, entry.key, text))
            return
        text = f"is of files before {former.since}, read as {former.replaced_by}"
        self.translated.append(f"{entry.place}: {entry.key}: {text}")
        for key, value in former.today(entry.value).items():
            if not any(given.key == key for given in self.given):
                self._add(Entry(key, value, entry.place, entry.section))

    def decide_release(self) -> None:
        """Follow the release that the user's keys stand for, unless they name one."""
        if any(entry.key == RELEASE for entry in self.given):
            return
        decision = decide(self.given)
        if decision is None:
            return
        place = Place(f"by the files: {decision.why}")
        if decision.entry is not None:
            place = Place(f"{place.source}, {decision.entry.place}")
        self.count += 1
        self._add(Entry(RELEASE, decision.release, place, place))

    def _of_other_releases(self) -> dict[str, Entry]:
        """Values of our own set for keys that are missing because the release has no such key."""
        release = self.values.get(RELEASE)
        if release is None:
            return {}
        absent = {key for key, span in SPANS.items() if key in KNOWN and not span.holds(release)}
        absent -= set(self.origins)
        entries = (e for s in sources_of("default") for e in parse(s).entries)
        return {entry.key: entry for entry in entries if entry.key in absent} if absent else {}

    def check(self) -> None:
        """Look for missing keys and for values that do not fit together."""
        fillers = self._of_other_releases()
        missing = [key for key in KNOWN if key not in self.origins and key not in fillers]
        self.problems += [self._missing(key) for key in missing]
        for entry in fillers.values():
            self._add(entry)
        usable = {key: value for key, value in self.values.items() if key not in self.refused}
        for rule, text in inconsistencies(usable):
            key = self._culprit(rule)
            self.problems.append(Problem(self.origins[key].place, key, text))

    def _culprit(self, rule: Rule) -> str:
        """Return the key of a broken rule that the topmost layer gave."""
        return max(rule.keys, key=lambda key: self.depth[key])

    def _missing(self, key: str) -> Problem:
        """A missing key is told at the section that holds the others of its file."""
        home = file_of_key()
        text = f"is missing; expected {KNOWN[key].allowed_text}"
        for other, entry in self.origins.items():
            if home.get(other) == home.get(key):
                return Problem(entry.section, key, text)
        return Problem(Place(f"no {home.get(key)}"), key, text)


def _flat(overrides: Mapping[str, object], prefix: str = "") -> Iterator[tuple[str, object]]:
    for key, value in overrides.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value
