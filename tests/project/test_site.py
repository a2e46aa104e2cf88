"""The website builds without a warning, and stands alone: no network, no dead link, no bare picture."""

from __future__ import annotations

import json
import re
import tomllib
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import nbformat
from book_files import BOOK, chapters, code_cells, notebooks


class Page(HTMLParser):
    """What a page loads, shows and links to."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.links: list[str] = []
        self.ids: set[str] = set()
        self.bare_pictures: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        found = {name: value or "" for name, value in attributes}
        self.ids |= {found[name] for name in ("id", "name") if name in found}
        if tag in ("script", "img", "iframe", "source") and "src" in found:
            self.loads.append(found["src"])
        if tag == "link" and found.get("rel") in ("stylesheet", "preload", "icon", "shortcut icon"):
            self.loads.append(found["href"])
        if tag == "a" and "href" in found:
            self.links.append(found["href"])
        if tag == "img" and len(found.get("alt", "")) < 20:
            self.bare_pictures.append(found.get("src", ""))


def pages(site: Path) -> dict[str, Page]:
    return {path.name: Page(path) for path in sorted(site.glob("*.html"))}


def test_every_notebook_is_a_page(site: Path) -> None:
    assert {f"{path.stem}.html" for path in notebooks()} <= set(pages(site))


def test_nothing_comes_from_elsewhere(site: Path) -> None:
    for name, page in pages(site).items():
        outside = [source for source in page.loads if urlsplit(source).scheme or source.startswith("//")]
        assert not outside, f"{name} loads {outside}"
        for source in page.loads:
            assert (site / unquote(urlsplit(source).path)).is_file(), f"{name} loads {source}: not there"
    for style in (site / "_static").rglob("*.css"):
        text = style.read_text(encoding="utf-8")
        assert not re.search(r"(@import|url\()\s*[\"']?(https?:)?//", text), style.name


def test_no_dead_link(site: Path) -> None:
    found = pages(site)
    dead = []
    for name, page in found.items():
        for link in page.links:
            parts = urlsplit(link)
            if not parts.scheme and parts.path in ("", *found):
                target = found[parts.path or name]
                if parts.fragment and unquote(parts.fragment) not in target.ids:
                    dead.append(f"{name}: {link}")
            elif not parts.scheme and not (site / unquote(parts.path)).exists():
                dead.append(f"{name}: {link}")
    assert not dead, "\n".join(dead)


def test_each_page_has_its_notebook(site: Path) -> None:
    """The very file of the book, which opens in Jupyter, is downloaded from below the title."""
    for path in notebooks():
        text = (site / f"{path.stem}.html").read_text(encoding="utf-8")
        (link,) = re.findall(r'class="reference download internal" download="" href="([^"]+)"', text)
        assert (site / unquote(link)).read_bytes() == path.read_bytes(), path.name
        assert text.rindex("</h1>") < text.index(link) < text.rindex("</h1>") + 200
        nbformat.validate(nbformat.read(site / unquote(link), as_version=4))


def previews(site: Path) -> dict[str, dict[str, str]]:
    """What each page says of itself to those who link to it."""
    meta = re.compile(r'<meta (?:name|property)="(description|og:[\w:]+)" content="([^"]*)"')
    texts = {path.stem: path.read_text(encoding="utf-8") for path in site.glob("*.html")}
    return {name: {key: unescape(value) for key, value in meta.findall(text)} for name, text in texts.items()}


def test_each_page_has_a_sentence_and_a_picture_for_links_to_it(site: Path) -> None:
    found = previews(site)
    pages_ = [path.stem for path in notebooks()]
    sentences = [found[name]["description"] for name in pages_]
    assert len(set(sentences)) == len(sentences), "each has its own"
    for name in pages_:
        one = found[name]
        assert 20 <= len(one["og:description"]) <= 200 and one["og:description"] == one["description"]
        assert one["og:title"] and "<" not in one["og:title"]
        assert (site / one["og:image"]).is_file() and len(one["og:image:alt"]) >= 20
    pictures = [found[path.stem]["og:image"] for path in chapters()]
    assert len(set(pictures)) == len(pictures) and all(name.startswith("_images/") for name in pictures)


def test_lectures_have_the_figures_of_their_chapters(site: Path) -> None:
    """All of them, but for those of exercises, with their captions."""
    lectures = tomllib.loads((BOOK / "chapters.toml").read_text(encoding="utf-8"))["lecture"]
    teachers = (site / "teaching.html").read_text(encoding="utf-8")
    for number, lecture in enumerate(lectures, start=1):
        name = f"lecture-{number:02d}"
        text = (site / f"{name}.html").read_text(encoding="utf-8")
        assert f'href="{name}.html"' in teachers and lecture["title"] in text
        pictures = re.findall(r'<img alt="[^"]{20,}" src="(_images/[^"]+)"', text)
        assert len(pictures) >= 8, f"{name}: {len(pictures)} figures"
        for chapter in lecture["chapters"]:
            (path,) = (path for path in chapters() if path.name.startswith(f"{chapter}-"))
            own = (site / f"{path.stem}.html").read_text(encoding="utf-8")
            assert any(picture in own for picture in pictures) and f'href="{path.stem}.html' in text
    index = (site / "searchindex.js").read_text(encoding="utf-8")
    assert "Lecture 1: " not in index, "the search leads to the chapters"


def test_every_picture_has_a_text(site: Path) -> None:
    bare = {name: page.bare_pictures for name, page in pages(site).items() if page.bare_pictures}
    assert not bare, bare


def test_no_table_is_left_in_its_source(site: Path) -> None:
    """Markdown that a cell puts out is rendered, too."""
    for path in sorted(site.glob("*.html")):
        assert not re.search(r"\|\s*:?(---|—|–)+:?\s*\|", path.read_text(encoding="utf-8")), path.name
    assert (site / "benchmarks.html").read_text(encoding="utf-8").count("<table") >= 4


def test_search_mathematics_and_dark_mode(site: Path) -> None:
    assert "circumcent" in (site / "searchindex.js").read_text(encoding="utf-8")
    front = (site / "index.html").read_text(encoding="utf-8")
    assert "theme-switch" in front
    texts = [page.read_text(encoding="utf-8") for page in site.glob("2*.html")]
    with_mathematics = [text for text in texts if "math notranslate" in text]
    assert with_mathematics
    assert all("tex-svg.js" in text for text in with_mathematics)


def test_the_search_finds_the_entries_of_the_index(site: Path) -> None:
    text = (site / "searchindex.js").read_text(encoding="utf-8")
    index = json.loads(re.search(r"Search\.setIndex\((.*)\)", text, flags=re.S)[1])
    entries = index["indexentries"]
    assert len(entries) >= 250
    for name in ("sliver", "rebay, s.", "voronoi_segment", "terrain"):
        places = [(index["docnames"][page], target) for page, target, _ in entries[name]]
        assert places and not any(page == "index-of-terms" for page, _ in places)
        for page, target in places:
            assert f'id="{target}"' in (site / f"{page}.html").read_text(encoding="utf-8")


def test_the_search_finds_the_terms_of_the_glossary(site: Path) -> None:
    text = (site / "searchindex.js").read_text(encoding="utf-8")
    index = json.loads(re.search(r"Search\.setIndex\((.*)\)", text, flags=re.S)[1])
    page = index["docnames"].index("glossary")
    for stem in ("sliver", "circumcent", "encroach", "quadtre"):
        found = index["terms"][stem]
        assert page == found or page in found, stem


def test_cells_of_claims_lead_to_their_rows_and_back(site: Path) -> None:
    found = pages(site)
    rows = {name for name in found["ledger.html"].ids if name.startswith("claim-")}
    assert len(rows) >= 200
    linked = {link for name in found for link in found[name].links if link.startswith("ledger.html#claim-")}
    tagged = {
        tag for path in notebooks() for cell in code_cells(path) for tag in cell.metadata.get("tags", [])
    }
    claims = {tag.removeprefix("C").replace(".", "-") for tag in tagged if tag.startswith("C12")}
    assert (
        {f"ledger.html#claim-{name}" for name in claims} <= linked <= {f"ledger.html#{row}" for row in rows}
    )
    text = (site / "2.7-surfaces.html").read_text(encoding="utf-8")
    boxes = re.findall(r'<div class="[^"]*\bsource\b[^"]*admonition[^"]*">.*?</div>', text, flags=re.S)
    assert boxes and all('href="ledger.html#claim-12-2-7-' in box for box in boxes)
    back = [link for link in found["ledger.html"].links if re.search(r"^[1-5].*\.html#c\d{3}$", link)]
    assert len(back) >= len(claims)


def test_every_widget_has_its_place(site: Path) -> None:
    for path in notebooks():
        stored = [o for cell in code_cells(path) for o in cell.outputs if "widget" in o.get("metadata", {})]
        text = (site / f"{path.stem}.html").read_text(encoding="utf-8")
        states = re.findall(r'class="unstruct-widget"><script type="application/json">(.*?)</script>', text)
        assert len(states) == len(stored), path.name
        assert [json.loads(state) for state in states] == [o.metadata["widget"] for o in stored]


def test_no_equation_of_a_statement_is_quoted_twice(site: Path) -> None:
    """An anchor before an equation within a statement made a quotation of its own, narrow and gray."""
    equations = 0
    for path in notebooks():
        text = (site / f"{path.stem}.html").read_text(encoding="utf-8")
        assert not re.search(r"<blockquote[^>]*>(?:(?!</blockquote>).)*<blockquote", text, re.S), path.stem
        quoted = re.findall(r"<blockquote[^>]*>(.*?)</blockquote>", text, re.S)
        equations += sum(len(re.findall(r'amsmath[^>]*id="equation-', part)) for part in quoted)
    assert equations >= 4


def test_statements_boxes_and_solutions_of_new_chapters(skeleton_site: Path) -> None:
    """Anchors are those of the notebook, and a link to one leads there from another page."""
    found = pages(skeleton_site)
    assert {"theorem-0-0-1", "equation-0-0-1"} <= found["0.0-skeleton.html"].ids
    assert "#equation-0-0-1" in found["0.0-skeleton.html"].links
    assert "0.0-skeleton.html#equation-0-0-1" in found["0.1-second.html"].links
    assert "0.0-skeleton.html#theorem-0-0-1" in found["index.html"].links
    text = (skeleton_site / "0.0-skeleton.html").read_text(encoding="utf-8")
    assert re.search(
        r'<div class="[^"]*\bsource\b[^"]*admonition[^"]*">\s*<p class="admonition-title">Source</p>', text
    )
    assert re.search(r"<details><summary>Solution</summary>\s*<p>Put", text)
    assert r"\begin{equation*}" in text and r"\tag{0.0.1}" in text and "**Source" not in text
