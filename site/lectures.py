"""For each lecture of the course a page with the figures of its chapters, which prints as slides.

The figures are those stored in the notebooks, each with its heading and its caption. No list is kept by hand:
a figure that a chapter gains is on the page of its lecture, too.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
from nbformat.v4 import new_code_cell, new_markdown_cell

LEFT_OUT = ("Exercises", "Sources", "What to take away")
CAPTION = re.compile(r"\*(?!\*)(.{20,}?)(?<!\*)\*(?!\*)", flags=re.S)  # not a single word in italics


def lecture_pages(book: Path) -> Iterator[tuple[str, Any]]:
    """The name of each page, and its notebook; none, if the book has no lectures."""
    path = book / "chapters.toml"
    data = tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {"lecture": []}
    for number, lecture in enumerate(data["lecture"], start=1):
        cells = [new_markdown_cell(f"# Lecture {number}: {lecture['title']}\n\n{opening(lecture)}", id="top")]
        for chapter in lecture["chapters"]:
            (source,) = book.glob(f"{chapter}-*.ipynb")
            cells += figures(source, chapter)
        notebook = nbformat.v4.new_notebook(cells=cells, metadata={"nosearch": True, "orphan": True})
        notebook.metadata["kernelspec"] = {
            "display_name": "Python 3",
            "language": "python",
            "name": "python3",
        }
        yield f"lecture-{number:02d}", notebook


def opening(lecture: dict[str, Any]) -> str:
    return (
        f"Afterwards students can {lecture['aim']}.\n\n"
        "These are the figures of the chapters, in their order; each heading leads to its place, where there "
        "are players, proofs and code. Print this page for slides, one figure each.\n\n"
        '<div class="lecture-figures"></div>'
    )


def figures(source: Path, number: str) -> Iterator[Any]:
    """Cells with a heading, a picture and its caption for each picture of a chapter, not of exercises."""
    cells = nbformat.read(source, as_version=4).cells
    title, section = cells[0].source.splitlines()[0].removeprefix("# "), ""
    last = ""
    yield new_markdown_cell(f"## [{title}]({source.name})", id=f"chapter-{number.replace('.', '-')}")
    for place, cell in enumerate(cells):
        if cell.cell_type == "markdown":
            if headings := re.findall(r"^## +(.*?)\s*$", cell.source, flags=re.M):
                section = headings[-1]
            continue
        alt = cell.metadata.get("mystnb", {}).get("image", {}).get("alt", "")
        shown = [o for o in cell.outputs if "image/png" in o.get("data", {}) and "widget" not in o.metadata]
        if not alt or not shown or section.startswith(LEFT_OUT):
            continue
        after = cells[place + 1].source if place + 1 < len(cells) else ""
        caption = CAPTION.match(after)
        name = f"{number.replace('.', '-')}-{cell.id}"
        goal = f"{source.name}#{section.replace(' ', '-')}" if section else source.name
        heading = f"{number} {section or 'The question'}"
        text = f'<p class="again">{heading}</p>' if heading == last else f"### [{heading}]({goal})"
        yield new_markdown_cell(text, id=f"h-{name}")
        last = heading
        look = {"tags": ["remove-input"], "mystnb": {"image": {"alt": alt}}}
        yield new_code_cell("figure", id=f"c-{name}", metadata=look, outputs=[picture(o) for o in shown])
        if caption:
            yield new_markdown_cell(f"*{caption[1]}*", id=f"t-{name}")


def picture(output: Any) -> Any:
    """An output reduced to its picture."""
    data = {"image/png": output.data["image/png"], "text/plain": ""}
    return nbformat.v4.new_output("display_data", data=data)
