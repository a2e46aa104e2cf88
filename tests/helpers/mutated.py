"""The tenth of the mutations that the tests run, in two halves, so that two processes share them."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import pytest
from book_files import BOOK
from mutate import files, read, run_here, tenth

FILES = [pytest.param(path, notebook, id=path.stem) for path, notebook in files()]


def all_are_red(path: Path, notebook: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a chapter's tenth, as `mutate.py --tenth` does."""
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.chdir(BOOK)
    with matplotlib.rc_context():
        results = run_here(notebook, tenth(read(path)), sliced=True)
    green = [f"{result.mutation}: {result.told}" for result in results if not result.red]
    assert results and not green, "\n".join(green)
