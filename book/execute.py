"""Run notebooks top to bottom in fresh kernels and store them with their outputs.

    python book/execute.py                 # every notebook of the book
    python book/execute.py 2.1 ledger      # those whose names start so

This is the only program that writes notebooks: it keeps of the metadata what the book needs
(kernel, tags, alt texts, folding), so that two runs differ by nothing but widget ids.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient

BOOK = Path(__file__).parent
KEPT = ("tags", "mystnb")
FOLDED = {"hide-cell", "hide-input"}


def notebooks(prefixes: list[str]) -> list[Path]:
    """The notebooks whose names start with one of ``prefixes`` (all, where none is given)."""
    found = [p for p in sorted(BOOK.glob("*.ipynb")) if not prefixes or p.name.startswith(tuple(prefixes))]
    if not found:
        raise SystemExit(f"no notebook of the book starts with {' or '.join(prefixes)}")
    return found


def clean(notebook: nbformat.NotebookNode) -> None:
    """Reduce the metadata to what the book uses, and number the cells stably."""
    notebook.metadata = nbformat.from_dict(
        {"kernelspec": {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"}}
    )
    notebook.nbformat_minor = 5
    for number, cell in enumerate(notebook.cells):
        kept = {key: cell.metadata[key] for key in KEPT if cell.metadata.get(key)}
        if FOLDED & set(kept.get("tags", [])):
            kept["jupyter"] = {"source_hidden": True}
        cell.metadata = nbformat.from_dict(kept)
        cell.id = f"c{number:03d}"


def run(path: Path) -> float:
    """Execute one notebook in place; return the seconds it took."""
    notebook = nbformat.read(path, as_version=4)
    clean(notebook)
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
    start = time.perf_counter()
    client = NotebookClient(
        notebook,
        timeout=600,
        kernel_name="python3",
        record_timing=False,
        store_widget_state=False,
        resources={"metadata": {"path": str(path.parent)}},
    )
    client.execute()
    seconds = time.perf_counter() - start
    clean(notebook)
    nbformat.write(notebook, path)
    return seconds


if __name__ == "__main__":
    for notebook_path in notebooks(sys.argv[1:]):
        print(f"{notebook_path.name}: {run(notebook_path):.1f} s", flush=True)
