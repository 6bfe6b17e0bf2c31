# SPDX-License-Identifier: Apache-2.0
"""``island build``: everything that a target needs, made ready in ``build/<target>/``."""

from __future__ import annotations

import argparse
import platform
import shutil
from collections.abc import Callable
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from safety_island.cli.configuration import add_configuration, resolved
from safety_island.cli.parser import UsageError, teach
from safety_island.targets.aot.machines import HOSTS
from safety_island.targets.kconfig.targets import NAMES
from safety_island.targets.package.built import refuse_in_built
from safety_island.targets.package.products import APPLICATION, TEST_PROGRAMS, Product

if TYPE_CHECKING:
    from safety_island.targets.kconfig.places import Places
    from safety_island.targets.package.pipeline import Build


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    teach(
        parser,
        """
Build a target into build/TARGET/: the resolved .config, the message types compiled from IDL, the
control kernels compiled ahead of time with their C header, and a manifest. For a machine that runs
Linux (posix, freertos_posix) also one self-contained program, safety-island.pyz, that starts with
Python alone, without network and without a compiler; for the Arm boards a static library. A build
with nothing changed does nothing. The first one compiles the kernels, which takes about a minute.
""",
        ("island build -t posix", "this machine"),
        ("island build -t s32z270dc2_rtu0_r52@D", "kernels for the Cortex-R52"),
        ("island build -t freertos_posix -D LOG_LEVEL=2", "the simulator, with another log level"),
        ("island build -t posix --dds-publisher", "the program that publishes sample messages"),
        ("island build --wheel", "a wheel with the kernels inside, which needs no compiler"),
        ("island build --wheel aarch64", "the same for another processor"),
        ("island build -c", "remove every build"),
    )
    parser.add_argument("-t", "--target", metavar="TARGET", help=", ".join(NAMES))
    parser.add_argument(
        "-c",
        "--clean",
        action="store_true",
        help="remove all builds, saved menus included, and exit",
    )
    add_configuration(parser)
    parser.add_argument(
        "--wheel",
        nargs="?",
        const=platform.machine(),
        metavar="MACHINE",
        help=f"make a wheel with compiled kernels inside, in dist/, for {' or '.join(HOSTS)} "
        "(default: this machine)",
    )
    programs = parser.add_mutually_exclusive_group()
    for product in TEST_PROGRAMS:
        programs.add_argument(
            f"--{product.name}",
            dest="product",
            action="store_const",
            const=product,
            default=APPLICATION,
            help=product.summary,
        )


def execute(arguments: argparse.Namespace) -> int:
    """Build, or clean."""
    refuse_in_built("island build")
    if arguments.clean:
        return _clean()
    if arguments.wheel is not None:
        return _build_wheel(arguments)
    if arguments.target is None:
        raise UsageError(f"-t TARGET is missing, expected one of {', '.join(NAMES)}")
    return _build(arguments, arguments.product)


def places() -> Places:
    """Return where configurations are read and builds are made."""
    from safety_island.targets.kconfig.places import Places

    return Places()


def _clean() -> int:
    folder = places().build
    found = [name for name in NAMES if (folder / name).is_dir()]
    for name in found:
        shutil.rmtree(folder / name)
    print(f"removed {', '.join(found)}" if found else "nothing to remove")
    return 0


def _build_wheel(arguments: argparse.Namespace) -> int:
    from safety_island.targets.package.wheel import build_wheel

    for option in ("target", "conf", "define"):
        if getattr(arguments, option):
            raise UsageError("--wheel is for every target: give no -t, --conf and -D with it")
    if arguments.wheel not in HOSTS:
        raise UsageError(f"--wheel {arguments.wheel}: expected {' or '.join(HOSTS)}")
    say = _steps()
    made = build_wheel(HOSTS[arguments.wheel], places().wheels, say)
    say("done")
    print(f"  {made.stat().st_size:>12,} B  {_shown(made)}")
    return 0


def _steps() -> Callable[[str], None]:
    """Print each step with the time since the start."""
    started = monotonic()

    def say(step: str) -> None:
        print(f"[{monotonic() - started:5.1f} s] {step}", flush=True)

    return say


def _build(arguments: argparse.Namespace, product: Product) -> int:
    from safety_island.targets.package.pipeline import Build

    say = _steps()
    build = Build(resolved(arguments), product, places(), say)
    if build.is_current():
        print(f"{_shown(build.folder)} is up to date, nothing to do")
        return 0
    build.run()
    say("done")
    _tell(build)
    return 0


def _tell(build: Build) -> None:
    """List what was made."""
    for name in sorted(build.files):
        size = (build.folder / name).stat().st_size
        print(f"  {size:>12,} B  {_shown(build.folder / name)}")
    print(f"  {'':>12}    {_shown(build.manifest_path)}")


def _shown(path: Path) -> str:
    """A path, below the current folder where possible."""
    here = Path.cwd()
    return str(path.relative_to(here) if path.is_relative_to(here) else path)
