"""Turn the stored notebooks into the pages that Sphinx reads, and widgets into what a page can run."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import nbformat
from lectures import lecture_pages

VIEW = "application/vnd.jupyter.widget-view+json"
FRONT, TEACHERS = "index", "teaching"
SVG = "image/svg+xml"
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
# made by their cells from data; their code, which teaches nothing, is not on the site
MADE = {"ledger", "errata", "theorems", "glossary", "index-of-terms", "references"}
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
    "theorems",
    "glossary",
    "index-of-terms",
    "references",
    "teaching",
]


def write_pages(book: Path, site: Path) -> None:
    """Write one page for each notebook of ``book`` into ``site``; remove pages of notebooks now gone."""
    names = [path.stem for path in sorted(book.glob("*.ipynb"))]
    indexed, ledger = places_of_the_index(book), "ledger" in names
    lectures = dict(lecture_pages(book))
    for old in site.glob("*.ipynb"):
        if old.stem not in [*names, *lectures]:
            old.unlink()
    for name, notebook in lectures.items():
        for cell in notebook.cells:
            if cell.cell_type == "markdown":
                cell.source = for_sphinx(cell.source)
        write(site / f"{name}.ipynb", nbformat.writes(notebook))
    for name in names:
        notebook = nbformat.read(book / f"{name}.ipynb", as_version=4)
        for before, cell in zip([None, *notebook.cells], notebook.cells):
            if cell.cell_type == "code":
                for output in cell.outputs:
                    show_widget(output)
                    show_drawing(output)
                    link_to_pages(output)
                if "hide-cell" in cell.metadata.get("tags", []):
                    # below a solution in words, code verifies it
                    what = "check" if before.source.rstrip().endswith("</details>") else "solution"
                    prompts = {"code_prompt_show": f"Show the {what}", "code_prompt_hide": f"Hide the {what}"}
                    cell.metadata["mystnb"] = {**cell.metadata.get("mystnb", {}), **prompts}
                cell.source = re.sub(r"^%.*\n?", "", cell.source, flags=re.M)
                if name in MADE or re.match(r"(Markdown|HTML)\(", cell.source):
                    cell.metadata["tags"] = ["remove-input"]
            else:
                text = linked(for_sphinx(cell.source)) if ledger else for_sphinx(cell.source)
                cell.source = with_entries(text, cell.source, indexed.get(name, {}))
        notebook.cells = [part for cell in notebook.cells for part in (*anchor(cell, ledger), cell)]
        notebook.cells[0].source = with_download(notebook.cells[0].source, f"../{book.name}/{name}.ipynb")
        if name == FRONT:
            notebook.cells.append(nbformat.v4.new_markdown_cell(contents(names), id="contents"))
        if name == TEACHERS and lectures:
            notebook.cells.append(nbformat.v4.new_markdown_cell(slides(lectures), id="slides"))
        write(site / f"{name}.ipynb", nbformat.writes(notebook))


def for_sphinx(text: str) -> str:
    """Markdown as JupyterLab reads it, in the words that Sphinx has for the same: anchors, links to them
    (which Sphinx then checks), numbered equations, boxes."""
    text = re.sub(r"^> \*\*Source\.\*\*(?:.*\n?)(?:^>.*\n?)*", boxed, text, flags=re.M)
    text = re.sub(
        rf'^((?:> ?)*)<a id="((?:{NUMBERED})-[\w-]+)"></a>[ ]*(?:\n\1)?', r"\1(\2)=\n\1", text, flags=re.M
    )
    text = re.sub(rf"\]\([\w.-]*#((?:{NUMBERED})-[\w-]+)\)", r"](#\1)", text)
    text = re.sub(r"(\]\((?:[\w.-]+\.ipynb)?#)([^)\s]+)\)", lambda link: f"{link[1]}{slug(link[2])})", text)
    return re.sub(r"^((?:> ?)*)\$\$(.+?)\$\$$", displayed, text, flags=re.M | re.S)


def with_download(text: str, notebook: str) -> str:
    """A first cell with a link to the notebook itself, as the book has it, below its title."""
    title, _, rest = text.partition("\n")
    link = f"{{download}}`Download this page as a notebook <{notebook}>`"
    return f"{title}\n\n:::{{container}} notebook\n{link}\n:::\n\n{rest}"


def places_of_the_index(book: Path) -> dict[str, dict[str, list[str]]]:
    """What the page of the index lists: by page and anchor (as JupyterLab has it) the names of entries."""
    found: dict[str, dict[str, list[str]]] = {}
    path = book / "index-of-terms.ipynb"
    cells = nbformat.read(path, as_version=4).cells if path.is_file() else []
    shown = "".join(o.get("data", {}).get("text/html", "") for c in cells for o in c.get("outputs", []))
    for item in re.findall(r"<li>(.*?)</li>", shown):
        name = html.unescape(re.sub(r"<[^>]+>", "", item.split(": ", 1)[0]))
        for page, target in re.findall(r'href="([\w.-]+)\.ipynb#([^"]+)"', item):
            if page != "glossary":
                found.setdefault(page, {}).setdefault(html.unescape(target), []).append(name)
    return found


def with_entries(text: str, stored: str, wanted: dict[str, list[str]]) -> str:
    """A cell with the index's entries for its headings and statements, which the search then finds."""
    targets = [title.replace(" ", "-") for title in re.findall(r"^##+ +(.*?)\s*$", stored, flags=re.M)]
    targets += re.findall(r'<a id="([\w-]+)"></a>', stored)
    names = [name for target in targets for name in wanted.get(target, [])]
    if stored.startswith("# "):
        return text
    entries = "".join(f"```{{index}} single: {name}\n```\n\n" for name in dict.fromkeys(names))
    if not text.startswith("<"):
        return entries + text
    place = re.search(r"^(?:> ?)*(?:##|\([\w-]+\)=)", text, flags=re.M)  # HTML takes no anchor: beyond it
    assert place or not names, f"{names}: no heading or statement"
    return f"{text[: place.start()]}{entries}{text[place.start() :]}" if place else text


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


def slides(lectures: dict[str, Any]) -> str:
    """The section of the page for teachers that leads to the figures of the lectures."""
    titles = {
        name: notebook.cells[0].source.splitlines()[0].removeprefix("# ")
        for name, notebook in lectures.items()
    }
    lines = [f"- [{title}]({name}.ipynb)" for name, title in titles.items()]
    return "\n".join(
        [
            "## The figures of each lecture",
            "",
            "One page for each lecture has the figures of its chapters, with their captions. Each figure is "
            "a slide, when a page is printed, or by `python site/print_edition.py slides.pdf --lecture 1`.",
            "",
            *lines,
        ]
    )


def anchor(cell: Any, ledger: bool) -> list[Any]:
    """Before each cell that checks claims a place to link to, and links to the rows of the ledger, if any."""
    claims = [tag for tag in cell.metadata.get("tags", []) if tag.startswith("C12")]
    if not claims:
        return []
    links = [to_row(name, f"{name} ↗") for name in claims if ledger]
    text = f'<div class="claims" id="{cell.id}">{" ".join(links)}</div>'
    return [nbformat.v4.new_markdown_cell(text, id=f"{cell.id}-anchor")]


def to_row(name: str, text: str) -> str:
    """A link to the row of a claim on the page of the ledger."""
    row = "claim-" + name.removeprefix("C").replace(".", "-")
    return f'<a href="ledger.html#{row}" title="its row in the ledger">{text}</a>'


def linked(text: str) -> str:
    """Markdown in which the claims that boxes on the source name lead to their rows."""
    claim = re.compile(r"\bC12(?:\.\d+)*-\d+\b")
    box = re.compile(r"^:::\{admonition\} Source\n.*?^:::$", flags=re.M | re.S)
    return box.sub(lambda found: claim.sub(lambda name: to_row(name[0], name[0]), found[0]), text)


def slug(fragment: str) -> str:
    """JupyterLab's anchor of a heading (`By-hand`), as Sphinx has it (`by-hand`)."""
    return re.sub(r"[^\w-]", "", unquote(fragment).lower())


def link_to_pages(output: Any) -> None:
    """Turn links to notebooks, their cells and headings, in what a cell puts out, into those of the site."""

    def link(found: re.Match[str]) -> str:
        fragment = html.unescape(found[2] or "").removeprefix("cell-id=")
        return f'href="{found[1]}.html' + (f'#{slug(fragment)}"' if fragment else '"')

    data = output.get("data", {})
    if text := "".join(data.get("text/html", "")):
        data["text/html"] = re.sub(r'href="([\w.-]+)\.ipynb(?:#([^"]+))?"', link, text)
    if text := "".join(data.get("text/markdown", "")):
        data["text/markdown"] = for_sphinx(text)


def show_widget(output: Any) -> None:
    """Put the stored state of a widget, if this output is one, in the place of the live view."""
    if VIEW not in output.get("data", {}):
        return
    state = json.dumps(output["metadata"]["widget"], separators=(",", ":")).replace("</", "<\\/")
    place = f'<div class="unstruct-widget"><script type="application/json">{state}</script></div>'
    output["data"] = nbformat.from_dict({"text/html": place})
    output["metadata"] = nbformat.from_dict({})


def show_drawing(output: Any) -> None:
    """Put a drawing that has links, which a picture has not, into the page itself."""
    if SVG in output.get("data", {}):
        output["data"] = nbformat.from_dict(
            {"text/html": f'<div class="drawing">{output["data"][SVG]}</div>'}
        )


def write_scripts(view: Path, made: Path) -> None:
    """Put the library's own scripts and styles of widgets into one file that a page loads."""
    files = {p.name: p.read_text(encoding="utf-8") for p in [*view.rglob("*.js"), *view.rglob("*.css")]}
    made.mkdir(exist_ok=True)
    write(made / "scripts.js", f"window.unstructFiles = {json.dumps(dict(sorted(files.items())))};\n")


def write(path: Path, text: str) -> None:
    """Write only what has changed, so that a second build is quick."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
