"""Run notebooks top to bottom in fresh kernels and store them with their outputs.

    python book/execute.py                 # every notebook of the book
    python book/execute.py 2.1 ledger      # those whose names start so

This is the only program that writes notebooks: it keeps of the metadata what the book needs
(kernel, tags, alt texts, folding), so that two runs differ by nothing. The state of each widget that
a cell shows is stored beside that output, under stable names: the website draws the players from it.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient
from nbformat import NotebookNode

BOOK = Path(__file__).parent
SCRIPTS = BOOK.parent / "unstruct" / "view"
KEPT = ("tags", "mystnb")
FOLDED = {"hide-cell", "hide-input"}
STATE = "application/vnd.jupyter.widget-state+json"
VIEW = "application/vnd.jupyter.widget-view+json"
REFERENCE = "IPY_MODEL_"


def notebooks(prefixes: list[str]) -> list[Path]:
    """The notebooks whose names start with one of ``prefixes`` (all, where none is given)."""
    found = [p for p in sorted(BOOK.glob("*.ipynb")) if not prefixes or p.name.startswith(tuple(prefixes))]
    if not found:
        raise SystemExit(f"no notebook of the book starts with {' or '.join(prefixes)}")
    return found


def clean(notebook: NotebookNode) -> None:
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


def keep_widgets(notebook: NotebookNode) -> None:
    """Move the state of each widget shown to the output that shows it, and name it stably."""
    state = notebook.metadata.get("widgets", {}).get(STATE, {}).get("state", {})
    for cell in notebook.cells:
        for number, output in enumerate(cell.get("outputs", [])):
            if VIEW in output.get("data", {}):
                root = output["data"][VIEW]["model_id"]
                output["data"][VIEW]["model_id"] = f"{cell.id}-{number}"
                output["metadata"] = nbformat.from_dict({"widget": _model(root, state)})


def _model(name: str, state: dict[str, Any]) -> dict[str, Any]:
    """What a page without a kernel can draw of a widget: a box, an anywidget, a text, or a control."""
    model = state[name]
    traits = model["state"]
    if "children" in traits:
        parts = [_model(child.removeprefix(REFERENCE), state) for child in traits["children"]]
        return {"kind": "row" if model["model_name"] == "HBoxModel" else "column", "children": parts}
    if "_esm" in traits:
        own = {k: v for k, v in traits.items() if not k.startswith("_") and not _refers(v)}
        code = {"script": _file(traits["_esm"]), "style": _file(traits.get("_css", ""))}
        return {"kind": "anywidget", **code, "traits": own}
    if model["model_name"] in ("HTMLModel", "HTMLMathModel", "LabelModel"):
        return {"kind": "text", "value": traits.get("value", "")}
    return {"kind": "control", "description": traits.get("description", "")}


def _refers(value: Any) -> bool:
    return isinstance(value, str) and value.startswith(REFERENCE)


def _file(text: str) -> str:
    """The name of the library's file that holds this script or style; the text itself if there is none."""
    for path in [*sorted(SCRIPTS.rglob("*.js")), *sorted(SCRIPTS.rglob("*.css"))]:
        if path.read_text(encoding="utf-8") == text:
            return path.name
    return text


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
        timeout=None,  # on a busy machine anything may take long
        startup_timeout=36_000,
        kernel_name="python3",
        record_timing=False,
        coalesce_streams=True,  # where a stream is cut in pieces depends on the clock
        store_widget_state=True,
        resources={"metadata": {"path": str(path.parent)}},
    )
    client.execute()
    seconds = time.perf_counter() - start
    keep_widgets(notebook)
    clean(notebook)
    nbformat.write(notebook, path)
    return seconds


if __name__ == "__main__":
    for notebook_path in notebooks(sys.argv[1:]):
        print(f"{notebook_path.name}: {run(notebook_path):.1f} s", flush=True)
