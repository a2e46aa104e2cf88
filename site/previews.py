"""What is shown of a page where others link to it: its title, a sentence, and its first picture.

Addresses of pictures are relative, unless the build is told where the website will stand (those who show
previews want whole addresses): python -m sphinx -D html_baseurl=https://... site site/_build/html
"""

from __future__ import annotations

import re
import tomllib
from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import urljoin

import nbformat
from docutils import nodes

LONGEST = 200  # characters of a description
COVER = "_static/cover.png"


def sentences(book: Path) -> dict[str, str]:
    """A sentence for each page: the question of a chapter, else how the page begins."""
    path = book / "chapters.toml"
    data = tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    questions = {row["number"]: row["question"] for row in data.get("chapter", [])}
    found = {
        f"lecture-{number:02d}": f"Figures for a lecture. Afterwards students can {lecture['aim']}."
        for number, lecture in enumerate(data.get("lecture", []), start=1)
    }
    for page in book.glob("*.ipynb"):
        first = nbformat.read(page, as_version=4).cells[0].source
        found[page.stem] = questions.get(page.stem.split("-")[0]) or beginning(first)
    return {name: shortened(text) for name, text in found.items()}


def beginning(text: str) -> str:
    """The first paragraph of Markdown below the title, as plain text."""
    paragraph = next(part for part in text.split("\n\n")[1:] if part.strip() and not part.startswith("#"))
    paragraph = paragraph.removeprefix("**Task.** ")
    plain = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", paragraph)
    return re.sub(r"\s+", " ", re.sub(r"[*`$]|<[^>]+>", "", plain)).strip()


def shortened(text: str) -> str:
    """At most LONGEST characters: whole sentences if one fits, else whole words."""
    if len(text) <= LONGEST:
        return text
    whole = re.match(rf".{{40,{LONGEST - 1}}}[.?!](?= )", text)
    return whole[0] if whole else text[:LONGEST].rsplit(" ", 1)[0].rstrip(",;:") + " …"


def add_preview(app: Any, pagename: str, templatename: str, context: dict[str, Any], doctree: Any) -> None:
    """Give a page of the book its <meta> elements (for Sphinx's html-page-context)."""
    text = app.config.page_sentences.get(pagename)
    if text is None or doctree is None:
        return
    base = app.config.html_baseurl
    picture = next(doctree.findall(nodes.image), None)
    address = COVER if picture is None else picture["uri"]
    described = "The running region of the book, meshed." if picture is None else picture.get("alt", "")
    title = re.sub(r"<[^>]+>", "", context["title"])
    properties = {
        "og:type": "article",
        "og:site_name": app.config.html_title,
        "og:title": title,
        "og:description": text,
        "og:image": urljoin(base, address),
        "og:image:alt": described,
        **({"og:url": urljoin(base, f"{pagename}.html")} if base else {}),
    }
    lines = [f'<meta name="description" content="{escape(text)}"/>']
    lines += [f'<meta property="{name}" content="{escape(value)}"/>' for name, value in properties.items()]
    lines += ['<meta name="twitter:card" content="summary_large_image"/>']
    context["metatags"] = context.get("metatags", "") + "\n".join(lines)
