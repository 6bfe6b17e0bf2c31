# SPDX-License-Identifier: Apache-2.0
"""Every test on disk is run by pytest, and every Python file is seen by format and lint."""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
NOT_OURS = (".venv", "build", "dist")
"""Folders of the project itself that hold what others made, or a build."""


def python_files(root: Path) -> Iterator[Path]:
    """Every Python file of the project."""
    for folder, names, files in os.walk(root):
        skipped = NOT_OURS if Path(folder) == root else ()
        names[:] = [n for n in names if n not in skipped and not n.startswith((".", "__pycache__"))]
        yield from (Path(folder) / name for name in files if name.endswith(".py"))


def on_disk(root: Path) -> set[str]:
    """``path::name`` of each function named as a test, and each file named as one has some."""
    found = set[str]()
    for path in python_files(root):
        nodes = ast.walk(ast.parse(path.read_text("utf-8")))
        kinds = ast.FunctionDef | ast.AsyncFunctionDef
        names = [n.name for n in nodes if isinstance(n, kinds) and n.name.startswith("test_")]
        if not names and path.name.startswith("test_"):
            names = ["(no test in it)"]
        found |= {f"{path.relative_to(root)}::{name}" for name in names}
    return found


def run(root: Path, *command: str) -> str:
    result = subprocess.run(
        [sys.executable, "-m", *command],
        cwd=root,
        env={k: v for k, v in os.environ.items() if not k.startswith("PYTEST_")},
        capture_output=True,
        text=True,
        timeout=110,
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


def collected(root: Path) -> set[str]:
    """``path::name`` of the tests that pytest finds when it is given none: as CI runs it."""
    shown = run(root, "pytest", "--collect-only", "-q", "-p", "no:xdist", "-p", "no:cacheprovider")
    words = [line.partition("[")[0].split("::") for line in shown.splitlines() if "::" in line]
    return {f"{path}::{rest[-1]}" for path, *rest in words}


def left_out(root: Path) -> set[str]:
    """Tests on disk that pytest does not run."""
    return on_disk(root) - collected(root)


def test_every_test_on_disk_is_collected() -> None:
    assert on_disk(ROOT)
    assert left_out(ROOT) == set()


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A project with the settings of this one, and a test."""
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    write(tmp_path, "tests/test_seen.py", "def test_seen() -> None: ...\n")
    return tmp_path


def write(root: Path, name: str, text: str) -> None:
    (root / name).parent.mkdir(parents=True, exist_ok=True)
    (root / name).write_text(text, "utf-8")


def test_no_name_of_a_folder_hides_its_tests(tree: Path) -> None:
    """Not even one that pytest passes over when nothing else is said."""
    for folder in ("build", "dist", "venv", "CVS", "_darcs", "a.egg", "plain"):
        write(tree, f"tests/{folder}/test_one.py", f"def test_{folder[0]}() -> None: ...\n")
    assert left_out(tree) == set()


PASSED_OVER = {
    "a/checks.py": ("def test_other_name() -> None: ...", "test_other_name"),
    "a/test_none.py": ("def check_one() -> None: ...", "(no test in it)"),
    "a/test_class.py": ("class Whole:\n    def test_method(self): ...", "test_method"),
    "a/test_inner.py": ("def test_outer():\n    def test_inner(): ...", "test_inner"),
    "b/test_named.py": ("def test_named() -> None: ...", "test_named"),
    "c/test_like.py": ("def test_like() -> None: ...", "test_like"),
}


def test_what_pytest_passes_over_is_noticed(tree: Path) -> None:
    for name, (text, _) in PASSED_OVER.items():
        write(tree, f"tests/{name}", text)
    write(tree, "tests/conftest.py", "collect_ignore = ['b/test_named.py']")
    write(tree, "tests/c/conftest.py", "collect_ignore_glob = ['*like*']")
    assert left_out(tree) == {f"tests/{name}::{test}" for name, (_, test) in PASSED_OVER.items()}


def test_format_and_lint_see_every_python_file() -> None:
    seen = {Path(line) for line in run(ROOT, "ruff", "check", "--show-files", ".").splitlines()}
    assert set(python_files(ROOT)) - seen == set()
