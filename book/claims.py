"""The ledger as its page and others read it: rows, the cells that check them, their mutations, tables."""

from __future__ import annotations

import html
import json
import tomllib
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

BOOK = Path(__file__).parent
LOOK = 'style="text-align: left; vertical-align: top"'  # JupyterLab would set cells to the right
MUTATIONS = BOOK.parent / "tests" / "mutations"
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


def mutations() -> dict[str, list[dict[str, str]]]:
    """For each claim the changes of its cell that must not pass."""
    found: dict[str, list[dict[str, str]]] = {}
    for path in sorted(MUTATIONS.glob("*.toml")):
        for row in tomllib.loads(path.read_text(encoding="utf-8")).get("mutation", []):
            found.setdefault(row["claim"], []).append(row)
    return found


def anchor(name: str) -> str:
    """The id of a claim's row on the ledger page: "claim-12-2-3-01" for C12.2.3-01."""
    return "claim-" + name.removeprefix("C").replace(".", "-")


def to_row(name: str) -> str:
    """HTML that leads to the row of a claim."""
    return f'<a href="ledger.ipynb#{anchor(name)}">{name}</a>'


def ledger(claims: Iterable[dict[str, Any]]) -> str:
    """The ledger as an HTML table; the website filters its rows by section and verdict."""
    found, changes = cells(), mutations()
    head = ["id", "the source claims", "verdict", "correct", "evidence", "cell"]
    lines = ['<table class="ledger">', "<tr>" + "".join(f"<th {LOOK}>{name}</th>" for name in head) + "</tr>"]
    for row in claims:
        name = row["id"]
        texts = [name, row["statement"], row["verdict"], row.get("correct", ""), row["evidence"]]
        texts = [html.escape(text, quote=False) for text in texts] + [links(name, found)]
        texts[3] += folded(changes.get(name, []))
        marks = f'id="{anchor(name)}" data-section="{row["section"]}" data-verdict="{row["verdict"]}"'
        lines.append(f"<tr {marks}>" + "".join(f"<td {LOOK}>{text}</td>" for text in texts) + "</tr>")
    return "\n".join([*lines, "</table>"])


def folded(changes: Sequence[dict[str, str]]) -> str:
    """The mutations of a claim, folded: what is put in, the text that is replaced, and what replaces it."""
    if not changes:
        return ""
    items = []
    for change in changes:
        why, old, new = (html.escape(change[key], quote=False) for key in ("why", "find", "replace"))
        items.append(f"<p>{why}:</p><pre>{old}</pre><p>becomes</p><pre>{new or '(nothing)'}</pre>")
    count = "1 mutation" if len(changes) == 1 else f"{len(changes)} mutations"
    return f"<details><summary>{count}</summary>{''.join(items)}</details>"


def count(column: str, names: Sequence[str], claims: Iterable[dict[str, Any]]) -> list[tuple[str, int]]:
    """How many claims have each value of a column, in the order of ``names``."""
    totals = Counter(row[column] for row in claims)
    return [(name, totals[name]) for name in names if totals[name]]


def table(head: Sequence[str], body: Iterable[Sequence[Any]]) -> str:
    """An HTML table; cells that begin with ``<a`` are taken as they are, others are escaped."""

    def cell(value: Any, tag: str) -> str:
        text = value if str(value).startswith("<a ") else html.escape(str(value), quote=False)
        return f"<{tag} {LOOK}>{text}</{tag}>"

    lines = ["<table>", "<tr>" + "".join(cell(name, "th") for name in head) + "</tr>"]
    lines += ["<tr>" + "".join(cell(value, "td") for value in row) + "</tr>" for row in body]
    return "\n".join([*lines, "</table>"])
