"""The files of the project as the tests of the book read them: notebooks, ledger, tracked files."""

from __future__ import annotations

import re
import subprocess
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import nbformat

ROOT = Path(__file__).resolve().parents[2]
BOOK = ROOT / "book"
CLAIM = re.compile(r"C\d+(\.\d+)*-\d+")


@cache
def notebook(path: Path) -> nbformat.NotebookNode:
    return nbformat.read(path, as_version=4)


def notebooks() -> list[Path]:
    """All notebooks of the book, in its order."""
    return sorted(BOOK.glob("*.ipynb"))


def chapters() -> list[Path]:
    """The chapters: their names start with the number of a section."""
    return [path for path in notebooks() if path.name[0].isdigit()]


def code_cells(path: Path) -> list[nbformat.NotebookNode]:
    return [cell for cell in notebook(path).cells if cell.cell_type == "code"]


def tags(cell: nbformat.NotebookNode) -> list[str]:
    return list(cell.metadata.get("tags", []))


def headings(path: Path) -> list[tuple[int, str]]:
    """(level, text) of every Markdown heading, code blocks left out."""
    found = []
    for cell in notebook(path).cells:
        if cell.cell_type == "markdown":
            text = re.sub(r"^(```|~~~).*?^\1", "", cell.source, flags=re.M | re.S)
            found += [(len(marks), title) for marks, title in re.findall(r"^(#+)\s+(.*)$", text, flags=re.M)]
    return found


@cache
def ledger() -> list[dict[str, Any]]:
    return tomllib.loads((BOOK / "claims.toml").read_text(encoding="utf-8")).get("claim", [])


@cache
def tracked() -> list[Path]:
    """The files that belong to the project: what git tracks, and what is new and not ignored."""
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=ROOT, capture_output=True, check=True
    )
    return [path for name in listed.stdout.decode().split("\0") if name and (path := ROOT / name).is_file()]
