"""A tenth of the mutations is red: the second half of the chapters, which a process runs by itself."""

from __future__ import annotations

from pathlib import Path

import pytest
from mutated import FILES, all_are_red


@pytest.mark.parametrize(("path", "notebook"), FILES[1::2])
def test_a_tenth_is_red(path: Path, notebook: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    all_are_red(path, notebook, monkeypatch)
