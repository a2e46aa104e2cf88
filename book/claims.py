"""The ledger as the ledger and errata pages read it: its rows, the cells that check them, tables."""

from __future__ import annotations

import html
import json
import tomllib
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

BOOK = Path(__file__).parent
VERDICTS = ("true", "needs-assumption", "false", "extension", "misprint", "vague", "historical", "unverified")
EVIDENCE = ("derived", "exact", "property-tested", "counterexample", "measured", "cited")


def rows() -> list[dict[str, Any]]:
    """The rows of the ledger in the order of the source."""
    found = tomllib.loads((BOOK / "claims.toml").read_text(encoding="utf-8"))["claim"]

    def place(row: dict[str, Any]) -> tuple[list[int], int]:
        section, number = row["id"].removeprefix("C").split("-")
        return [int(part) for part in section.split(".")], int(number)

    return sorted(found, key=place)


def cells() -> dict[str, list[tuple[str, str]]]:
    """For each claim the cells that check it, as pairs of notebook and cell."""
    found: dict[str, list[tuple[str, str]]] = {}
    for path in sorted(BOOK.glob("*.ipynb")):
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            for tag in cell["metadata"].get("tags", []):
                if cell["cell_type"] == "code" and tag.startswith("C12"):
                    found.setdefault(tag, []).append((path.name, cell["id"]))
    return found


def links(name: str, found: dict[str, list[tuple[str, str]]]) -> str:
    """HTML that leads to the cells of a claim; a dash where it has none."""
    made = [f'<a href="{file}#cell-id={cell}">{file.split("-")[0]}</a>' for file, cell in found.get(name, [])]
    return ", ".join(made) or "–"


def count(column: str, names: Sequence[str], claims: Iterable[dict[str, Any]]) -> list[tuple[str, int]]:
    """How many claims have each value of a column, in the order of ``names``."""
    totals = Counter(row[column] for row in claims)
    return [(name, totals[name]) for name in names if totals[name]]


def table(head: Sequence[str], body: Iterable[Sequence[Any]]) -> str:
    """An HTML table; cells that begin with ``<a`` are taken as they are, others are escaped."""

    def cell(value: Any, tag: str) -> str:
        text = value if str(value).startswith("<a ") else html.escape(str(value), quote=False)
        return f'<{tag} style="text-align: left; vertical-align: top">{text}</{tag}>'

    lines = ["<table>", "<tr>" + "".join(cell(name, "th") for name in head) + "</tr>"]
    lines += ["<tr>" + "".join(cell(value, "td") for value in row) + "</tr>" for row in body]
    return "\n".join([*lines, "</table>"])
