"""Chapters run as on other processors: which ones, under which settings, and what they print differently."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from book_files import BOOK, chapters, code_cells

sys.path.append(str(BOOK))
import processors

__all__ = ["named", "print_the_same"]

SOLVES = re.compile(r"skfem|linalg\.(solve|lstsq|eig|svd)|spsolve|from_hessian|from_error")


def that_solve() -> list[Path]:
    return [path for path in chapters() if any(SOLVES.search(cell.source) for cell in code_cells(path))]


def named(which: str) -> dict[str, str]:
    """A setting; "another" has the linear algebra of another processor than this one and the oldest."""
    names = ("Sandybridge", "Haswell", "one thread") if which == "another" else (which,)
    return next(setting for name in names if (setting := processors.settings().get(name)) is not None)


def print_the_same(setting: str) -> None:
    """Assert that the chapters that solve something print under a setting what is stored."""
    paths = that_solve()
    names = "2.1- 2.2a 2.3- 2.4b 2.6a 2.6d 2.7- 2.8a 2.8b 2.8c 2.8d 3.3- 4b-t 4c-t 5-pr".split()
    assert {path.name[:4] for path in paths} == set(names)
    found = processors.compared(named(setting), paths)
    text = "\n".join(f"{where}\n{processors.shown(text)}" for where, text in found.items())
    assert not found, f"under {named(setting)}: {text}"
