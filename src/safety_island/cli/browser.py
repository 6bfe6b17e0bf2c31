# SPDX-License-Identifier: Apache-2.0
"""Opens a page in the browser of the desktop, where there is one."""

from __future__ import annotations

import os
import shutil
import subprocess

OPENER = "xdg-open"


def open_page(address: str) -> bool:
    """Show a page and wait for nothing; False where there is no desktop to show it on."""
    opener = shutil.which(OPENER)
    if not opener or not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return False
    quiet = subprocess.DEVNULL
    subprocess.Popen(
        [opener, address], stdin=quiet, stdout=quiet, stderr=quiet, start_new_session=True
    )
    return True
