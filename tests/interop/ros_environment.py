# SPDX-License-Identifier: Apache-2.0
"""A ROS 2 without a ROS installation: rclpy from PyPI in a virtual environment of its own.

It is made once and kept: in ``ISLAND_ROS_VENV`` when that is set, else under the user's cache, in a
folder named after the pinned requirements. CI calls ``python -m tests.interop.ros_environment``.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

REQUIREMENTS = Path(__file__).with_name("requirements.txt")
_VERSION = (3, 11)
"""The wheels of ROS 2 Kilted are built for this Python."""


def base_python() -> str | None:
    """Return a Python 3.11, None when this machine has none."""
    if sys.version_info[:2] == _VERSION:
        return sys.executable
    return shutil.which("python3.11")


def folder() -> Path:
    """Return where the environment is, or will be."""
    if own := os.environ.get("ISLAND_ROS_VENV"):
        return Path(own)
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    digest = hashlib.sha256(REQUIREMENTS.read_bytes()).hexdigest()[:12]
    return cache / "safety-island" / f"ros-kilted-{digest}"


def install() -> Path:
    """Return the Python of the environment; make the environment when it is not complete."""
    home = folder()
    done, python = home / "complete", home / "bin" / "python"
    if not done.exists():
        base = base_python()
        assert base is not None, "the ROS 2 wheels need Python 3.11"
        subprocess.run([base, "-m", "venv", "--clear", str(home)], check=True)
        pip = [str(python), "-m", "pip", "install", "--quiet", "--no-input"]
        subprocess.run([*pip, "-r", str(REQUIREMENTS)], check=True)
        done.touch()
    return python


if __name__ == "__main__":
    print(install())
