# SPDX-License-Identifier: Apache-2.0
"""The menu: a stand-in that changes symbols, and the real one on a pseudo-terminal."""

import os
import pty
import subprocess
import sys
from typing import Any

from safety_island.targets.kconfig.menu import Menu, edit
from safety_island.targets.kconfig.places import Places
from safety_island.targets.kconfig.resolve import resolve
from safety_island.targets.kconfig.targets import find_target


def choosing(**symbols: str) -> Menu:
    """A menu in which a user sets these symbols and saves."""

    def menu(kconfig: Any) -> None:
        kconfig.load_config(os.environ["KCONFIG_CONFIG"])
        for name, value in symbols.items():
            kconfig.syms[name].set_value(value)
        kconfig.write_config(os.environ["KCONFIG_CONFIG"])

    return menu


def test_what_is_saved_is_what_later_runs_take(places: Places) -> None:
    lines = edit("posix", places, choosing(LOG_LEVEL="2", CONTROL_CMD_OUTPUT_CAN_ONLY="y"))
    assert lines is not None and "CONFIG_LOG_LEVEL=2" in lines
    found = resolve("posix", places=places)
    values, origins = found.values(), found.origins()
    assert values["LOG_LEVEL"] == 2
    assert values["CONTROL_CMD_OUTPUT_CAN_ONLY"] is values["CAN"] is True
    assert origins["LOG_LEVEL"].startswith("build/posix/menuconfig.conf:")
    assert resolve("freertos_posix", places=places).values()["LOG_LEVEL"] == 1
    assert places.dotconfig(find_target("posix")).read_text() == found.dotconfig()
    assert "KCONFIG_CONFIG" not in os.environ


def test_choice_of_a_board_can_be_undone(places: Places) -> None:
    edit("freertos_posix", places, choosing(CONTROL_CMD_OUTPUT_DDS_ONLY="y"))
    values = resolve("freertos_posix", places=places).values()
    assert values["CONTROL_CMD_OUTPUT_DDS_ONLY"] is True
    assert values["CAN"] is False


def test_second_menu_starts_from_the_first(places: Places) -> None:
    edit("posix", places, choosing(LOG_LEVEL="2"))
    edit("posix", places, choosing(DDS_DOMAIN_ID="5"))
    values = resolve("posix", places=places).values()
    assert (values["LOG_LEVEL"], values["DDS_DOMAIN_ID"]) == (2, 5)
    assert edit("posix", places, choosing(LOG_LEVEL="1", DDS_DOMAIN_ID="2")) == []
    assert not places.saved(find_target("posix")).exists()


def test_edit_of_a_shipped_fragment_is_not_lost(places: Places) -> None:
    edit("posix", places, choosing(LOG_LEVEL="2"))
    prj = places.config / "prj_actuation.conf"
    prj.write_text(prj.read_text() + "CONFIG_LOG_THROTTLE_RATE=8\n")
    values = resolve("posix", places=places).values()
    assert (values["LOG_LEVEL"], values["LOG_THROTTLE_RATE"]) == (2, 8)


def test_leaving_without_saving_changes_nothing(places: Places) -> None:
    assert edit("posix", places, lambda kconfig: None) is None
    assert not places.saved(find_target("posix")).exists()


CHILD = """
import sys
from pathlib import Path
from safety_island.targets.kconfig.menu import edit
from safety_island.targets.kconfig.places import Places
edit("posix", Places(Path("config"), Path("build")))
"""


def shown_until_the_end(terminal: int) -> bytes:
    """Read a terminal until the program behind it is gone; return all that it wrote."""
    seen = b""
    while True:
        try:
            seen += os.read(terminal, 65536)
        except OSError:  # how Linux tells that the other side is closed
            return seen


def test_real_menu_on_a_terminal(places: Places) -> None:
    """Jump to LOG_THROTTLE_RATE with '/', put an 8 behind its 3, leave, and save when asked."""
    terminal, other_side = pty.openpty()
    os.write(terminal, b"/THROTTLE\n\n8\nqy")
    surroundings = {"TERM": "xterm", "LINES": "40", "COLUMNS": "120", "LC_ALL": "C.UTF-8"}
    with subprocess.Popen(
        [sys.executable, "-c", CHILD],
        stdin=other_side,
        stdout=other_side,
        stderr=other_side,
        env={**os.environ, **surroundings, "PYTHONPATH": os.pathsep.join(sys.path)},
        start_new_session=True,
    ) as child:
        os.close(other_side)
        seen = shown_until_the_end(terminal)
    os.close(terminal)
    assert child.returncode == 0, seen
    assert b"Command output" in seen
    assert resolve("posix", places=places).values()["LOG_THROTTLE_RATE"] == 38
