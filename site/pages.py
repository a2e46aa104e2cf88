"""Turn the stored notebooks into the pages that Sphinx reads, and widgets into what a page can run."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import nbformat

VIEW = "application/vnd.jupyter.widget-view+json"
FRONT = "index"
# What has a number and an anchor: <a id="theorem-3-1-2"></a>, <a id="equation-3-1-2"></a>
NUMBERED = "theorem|lemma|corollary|proposition|definition|equation"
# after the chapters, in these orders
HOW_TO = [
    "howto-geojson-to-gmsh",
    "howto-airfoil-to-su2",
    "howto-boundary-conditions",
    "howto-sizes",
    "howto-stretched-bodies",
    "howto-refine-again",
    "howto-three-dimensions",
    "howto-mesh-a-body",
    "howto-heat-in-a-body",
]
BACK = [
    "benchmarks",
    "benchmarks-planar",
    "benchmarks-front",
    "benchmarks-volume",
    "benchmarks-tree",
    "benchmarks-prisms",
    "benchmarks-surface",
    "ledger",
    "errata",
    "reference",
    "references",
]


def write_pages(book: Path, site: Path) -> None:
    """Write one page for each notebook of ``book`` into ``site``; remove pages of notebooks now gone."""
    names = [path.stem for path in sorted(book.glob("*.ipynb"))]
    for old in site.glob("*.ipynb"):
        if old.stem not in names:
            old.unlink()
    for name in names:
        notebook = nbformat.read(book / f"{name}.ipynb", as_version=4)
        for cell in notebook.cells:
            if cell.cell_type == "code":
                for output in cell.outputs:
                    show_widget(output)
                    link_to_cells(output)
                cell.source = re.sub(r"^%.*\n?", "", cell.source, flags=re.M)
            else:
                cell.source = for_sphinx(cell.source)
        notebook.cells = [part for cell in notebook.cells for part in (*anchor(cell), cell)]
        if name == FRONT:
            notebook.cells.append(nbformat.v4.new_markdown_cell(contents(names), id="contents"))
        write(site / f"{name}.ipynb", nbformat.writes(notebook))


def for_sphinx(text: str) -> str:
    """Markdown as JupyterLab reads it, in the words that Sphinx has for the same: anchors, links to them
    (which Sphinx then checks), numbered equations, boxes."""
    text = re.sub(r"^> \*\*Source\.\*\*(?:.*\n?)(?:^>.*\n?)*", boxed, text, flags=re.M)
    text = re.sub(
        rf'^((?:> ?)*)<a id="((?:{NUMBERED})-[\w-]+)"></a>[ ]*(?:\n\1)?', r"\1(\2)=\n\1", text, flags=re.M
    )
    text = re.sub(rf"\]\([\w.-]*#((?:{NUMBERED})-[\w-]+)\)", r"](#\1)", text)
    return re.sub(r"^((?:> ?)*)\$\$(.+?)\$\$$", displayed, text, flags=re.M | re.S)


def boxed(quote: re.Match[str]) -> str:
    """A block quote that begins with "**Source.**", as an admonition."""
    lines = re.sub(r"^> ?", "", quote[0], flags=re.M).removeprefix("**Source.**").strip()
    return f":::{{admonition}} Source\n:class: note source\n\n{lines}\n:::\n"


def displayed(formula: re.Match[str]) -> str:
    """Displayed mathematics, apart from the lines around it; an environment of its own if it has a number."""
    lead, body = formula[1], formula[2].strip()
    if "\\tag{" not in body:
        return f"{lead}\n{formula[0]}\n{lead}"
    lines = [
        "",
        r"\begin{equation*}",
        *re.sub(rf"^{lead}", "", body, flags=re.M).splitlines(),
        r"\end{equation*}",
        "",
    ]
    return "\n".join(lead + line for line in lines)


def groups(names: list[str]) -> list[tuple[str, list[str]]]:
    """The pages in their order, but for the front page: chapters by number, then the others."""
    chapters = [name for name in names if name[0].isdigit()]
    others = [name for name in BACK if name in names]
    tasks = [name for name in HOW_TO if name in names]
    others += [name for name in names if name not in [FRONT, *chapters, *tasks, *others]]
    return [("Chapters", chapters), ("How to", tasks), ("Beside the chapters", others)]


def contents(names: list[str]) -> str:
    """The table of contents that makes the site's navigation."""
    trees = []
    for caption, group in groups(names):
        if group:
            trees.append("\n".join(["```{toctree}", ":hidden:", f":caption: {caption}", "", *group, "```"]))
    return "\n\n".join(trees)


def anchor(cell: Any) -> list[Any]:
    """A place to link to, before each cell that checks a claim."""
    if not any(tag.startswith("C12") for tag in cell.metadata.get("tags", [])):
        return []
    return [nbformat.v4.new_markdown_cell(f'<span id="{cell.id}"></span>', id=f"{cell.id}-anchor")]


def link_to_cells(output: Any) -> None:
    """Turn JupyterLab's links to cells of other notebooks into links to their anchors."""
    text = output.get("data", {}).get("text/html")
    if text:
        text = "".join(text)
        output["data"]["text/html"] = re.sub(r"\.ipynb#cell-id=(\w+)", r".html#\1", text)


def show_widget(output: Any) -> None:
    """Put the stored state of a widget, if this output is one, in the place of the live view."""
    if VIEW not in output.get("data", {}):
        return
    state = json.dumps(output["metadata"]["widget"], separators=(",", ":")).replace("</", "<\\/")
    place = f'<div class="unstruct-widget"><script type="application/json">{state}</script></div>'
    output["data"] = nbformat.from_dict({"text/html": place})
    output["metadata"] = nbformat.from_dict({})


def write_scripts(view: Path, made: Path) -> None:
    """Put the library's own scripts and styles of widgets into one file that a page loads."""
    files = {p.name: p.read_text(encoding="utf-8") for p in [*view.rglob("*.js"), *view.rglob("*.css")]}
    made.mkdir(exist_ok=True)
    write(made / "scripts.js", f"window.unstructFiles = {json.dumps(dict(sorted(files.items())))};\n")


def write(path: Path, text: str) -> None:
    """Write only what has changed, so that a second build is quick."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
