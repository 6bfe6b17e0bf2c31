# SPDX-License-Identifier: Apache-2.0
"""``island config``: show the configuration of a target, or what differs from the defaults."""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections.abc import Iterable, Iterator

from safety_island.cli.configuration import add_configuration, add_target, resolved
from safety_island.cli.options import add_json
from safety_island.cli.parser import teach
from safety_island.targets.kconfig.resolve import Resolved, Setting, resolve
from safety_island.targets.package.built import refuse_in_built


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare ``show`` and ``diff``."""
    teach(
        parser,
        """
A target's configuration is merged as Zephyr does: the defaults of config/Kconfig, then
prj_actuation.conf, boards/<board>_actuation.conf, what 'island menuconfig' saved, the fragments of
--conf and the -D options, the later one winning. 'show' prints each symbol with the file and line
that its value comes from; 'diff' prints those that are not at their default.
""",
        ("island config show -t freertos_posix", "what the simulator runs with"),
        ("island config show -t posix -D LOG_LEVEL=2 --conf my.conf", "with changes of your own"),
        ("island config diff -t s32z270dc2_rtu0_r52@D", "what its fragments change"),
        ("island config diff -t posix --against freertos_posix", "two targets compared"),
    )
    actions = parser.add_subparsers(dest="action", metavar="show|diff", required=True)
    show = actions.add_parser("show", help="print every symbol")
    show.add_argument("--all", action="store_true", help="also symbols whose needs are not met")
    diff = actions.add_parser("diff", help="print what differs")
    diff.add_argument(
        "--against", metavar="TARGET", help="compare with this target, not with the defaults"
    )
    for action in (show, diff):
        add_target(action)
        add_configuration(action)
        add_json(action, "the symbols")


def execute(arguments: argparse.Namespace) -> int:
    """Show or compare."""
    refuse_in_built("island config")
    found = resolved(arguments)
    if arguments.action == "show":
        wanted = [item for item in found.settings if item.line or arguments.all or arguments.json]
        _print_settings(wanted, arguments.json)
    elif arguments.against:
        _print_differences(found, resolve(arguments.against), arguments.json)
    else:
        changed = [item for item in found.settings if item.value != item.default]
        _print_settings(changed, arguments.json)
    return 0


def _print_settings(settings: list[Setting], as_json: bool) -> None:
    if as_json:
        print(json.dumps([dataclasses.asdict(item) for item in settings], indent=2))
        return
    print("\n".join(_aligned((item.text, item.origin) for item in settings)))


def _print_differences(one: Resolved, other: Resolved, as_json: bool) -> None:
    pairs = [
        (mine, theirs)
        for mine, theirs in zip(one.settings, other.settings, strict=True)
        if mine.value != theirs.value
    ]
    if as_json:
        names = (one.target.name, other.target.name)
        rows = [dict(zip(names, map(dataclasses.asdict, pair), strict=True)) for pair in pairs]
        print(json.dumps(rows, indent=2))
        return
    lines = []
    for mine, theirs in pairs:
        lines += [(f"-{theirs.text}", theirs.origin), (f"+{mine.text}", mine.origin)]
    print("\n".join(_aligned(lines)))


def _aligned(rows: Iterable[tuple[str, str]]) -> Iterator[str]:
    """Yield two columns, the second in line."""
    table = list(rows)
    width = max((len(text) for text, _ in table), default=0)
    for text, origin in table:
        yield f"{text:<{width}}  {origin}"
