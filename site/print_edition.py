"""The whole book as one PDF: python site/print_edition.py book.pdf

The website is built, a browser prints each page of it as it prints for readers (site/_static/print.css), and
the parts are joined: with a title page, a table of contents, page numbers, bookmarks, and links that lead to
pages of the book. It needs Chromium and pypdf, and nothing from the network. `--lecture 5` makes slides.
"""

from __future__ import annotations

import html
import io
import shutil
import subprocess
import sys
from collections.abc import Iterator
from itertools import accumulate
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import unquote, urlsplit

import click
from pages import FRONT, groups
from playwright.sync_api import sync_playwright
from pypdf import PageObject, PdfReader, PdfWriter
from pypdf.annotations import Link
from pypdf.generic import ArrayObject, Fit, NameObject

HERE = Path(__file__).resolve().parent
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update"]
ONLINE = ["reference"]  # some 150 sheets of docstrings, which change with the library
PAPER: dict[str, Any] = {
    "format": "A4",
    "print_background": True,
    "margin": {"top": "18mm", "bottom": "20mm", "left": "19mm", "right": "19mm"},
}
SMALLEST_LINK = 2.0  # points: the links of PREPARE are smaller
PATIENCE = 900_000  # milliseconds, to end what hangs
# Folds are opened; and since Chromium gives names only to places that something links to, something does.
PREPARE = """async () => {
  await window.MathJax?.startup?.promise;
  for (const place of document.querySelectorAll(".unstruct-widget"))
    while (!place.dataset.state) await new Promise((done) => setTimeout(done, 20));
  for (const fold of document.querySelectorAll("details")) fold.open = true;
  for (const picture of document.querySelectorAll("img")) picture.loading = "eager";
  const links = document.querySelector(".bd-article").appendChild(document.createElement("div"));
  links.style.cssText = "position:absolute; bottom:0; font-size:1px; line-height:1px; color:transparent";
  const headings = [];
  for (const place of document.querySelectorAll(".bd-article [id]")) {
    if (/^(MJX|unstruct-player)/.test(place.id)) continue;
    const link = links.appendChild(document.createElement("a"));
    link.href = "#" + place.id;
    link.textContent = ".";
    const title = place.matches("section") && place.querySelector(":scope > :is(h1, h2)");
    if (title) headings.push([place.id, Number(title.tagName[1]), title.innerText.replace(/#$/, "").trim()]);
  }
  return headings;
}"""
SHEET = """<!doctype html><meta charset="utf-8"><style>
@page {{ size: A4; margin: {margin} }} body {{ margin: 0; font-family: "Helvetica Neue", Arial, sans-serif }}
{style}</style>{body}"""
COVER = """body { font-size: 11pt } h1 { font-size: 30pt; margin: 60mm 0 4mm }
h2 { page-break-before: always; font-size: 20pt } h3 { margin: 8mm 0 0; break-after: avoid }
p { margin: 0 0 3mm } .row { display: flex; margin: .7mm 0 } .row b { font-weight: normal; flex: 1 }
.row.one { font-weight: 600; margin-top: 3mm; break-after: avoid }
.row.two { padding-left: 7mm; font-size: 10pt }"""
TITLE = """<h1>Unstructured mesh generation</h1>
<p>A textbook of notebooks on an exact, fast, tested library</p><p>The unstruct authors</p>
<p>Text and figures CC BY 4.0, code MIT</p><h2>Contents</h2>"""
FOOTS = """div { position: relative; height: 296.9mm; page-break-after: always }
p { position: absolute; left: 19mm; right: 19mm; bottom: 9mm; margin: 0; font-size: 8.5pt; color: #555;
  display: flex; justify-content: space-between }"""


class Part(NamedTuple):
    """A page of the site on paper: its headings are (anchor, level, title)."""

    name: str
    caption: str
    reader: PdfReader
    headings: list[tuple[str, int, str]]

    def page_of(self, anchor: str) -> int:
        """On which of its own pages an anchor is; the first, if it has no place there."""
        place = self.reader.named_destinations.get(f"/{anchor}")
        number = None if place is None else self.reader.get_destination_page_number(place)
        return number if number is not None and number >= 0 else 0


def in_order(site: Path) -> Iterator[tuple[str, str]]:
    """The pages of a built site that are printed, with the caption of their group: the front page first."""
    stems = [path.stem for path in sorted(HERE.glob("*.ipynb")) if (site / f"{path.stem}.html").exists()]
    names = [name for name in stems if not name.startswith("lecture-")]
    yield FRONT, ""
    for caption, group in groups(names):
        yield from ((name, caption) for name in group if name not in ONLINE)


def printed(browser: Any, address: str) -> tuple[PdfReader, list[tuple[str, int, str]]]:
    """A page of the site on paper, and its headings of the first two levels."""
    page = browser.new_page(viewport={"width": 650, "height": 930})
    page.set_default_timeout(PATIENCE)
    page.emulate_media(media="print", color_scheme="light")
    page.goto(address)
    headings = [(anchor, level, title) for anchor, level, title in page.evaluate(PREPARE)]
    made = PdfReader(io.BytesIO(page.pdf(**PAPER)))
    page.close()
    return made, headings


def slides(browser: Any, place: Path, out: Path) -> int:
    """Write the figures of a lecture as slides, and return how many there are."""
    if not place.is_file():
        raise click.ClickException(f"there is no {place.name}: the course has 12 lectures")
    page = browser.new_page(viewport={"width": 968, "height": 530})
    page.emulate_media(media="print", color_scheme="light")
    page.goto(place.resolve().as_uri())
    page.evaluate(PREPARE)
    out.write_bytes(page.pdf(prefer_css_page_size=True, print_background=True))
    page.close()
    return len(PdfReader(out).pages)


def drawn(browser: Any, body: str, style: str, margin: str) -> PdfReader:
    """A PDF of a sheet of our own."""
    page = browser.new_page()
    page.set_content(SHEET.format(body=body, style=style, margin=margin))
    made = PdfReader(io.BytesIO(page.pdf(prefer_css_page_size=True, print_background=True)))
    page.close()
    return made


def rows(parts: list[Part], start: dict[str, int]) -> Iterator[str]:
    """The table of contents as lines of HTML."""
    caption = ""
    for part in parts:
        if part.caption != caption:
            caption = part.caption
            yield f"<h3>{html.escape(caption)}</h3>"
        for anchor, level, title in part.headings:
            if level == 1 or part.name[0].isdigit():
                place = start[part.name] + part.page_of(anchor) + 1
                kind = "one" if level == 1 else "two"
                yield f'<div class="row {kind}"><b>{html.escape(title)}</b><span>{place}</span></div>'


def front_matter(browser: Any, parts: list[Part]) -> tuple[PdfReader, dict[str, int]]:
    """Title and table of contents, and the number of pages before each part: set twice, since the number of
    pages of the table moves what it counts."""
    length = 0
    while True:
        ends = accumulate((len(part.reader.pages) for part in parts), initial=length)
        start = {part.name: first for part, first in zip(parts, ends)}
        body = "".join([TITLE, *rows(parts, start)])
        made = drawn(browser, body, COVER, "18mm 19mm 20mm")
        if len(made.pages) == length:
            return made, start
        length = len(made.pages)


def footed(browser: Any, feet: list[str]) -> PdfReader:
    """As many empty pages as there are ``feet``, each with its foot and its number."""
    lines = (
        f"<div><p><span>{html.escape(foot)}</span><span>{k + 1}</span></p></div>" if foot else "<div></div>"
        for k, foot in enumerate(feet)
    )
    return drawn(browser, "".join(lines), FOOTS, "0")


def lead_home(page: PageObject, part: Part, start: dict[str, int], parts: dict[str, Part]) -> list[Link]:
    """Links of a page to pages of the site, as links to pages of the book; other files are not in it."""
    kept, led = ArrayObject(), []
    for annotation in page.get("/Annots") or []:
        one = annotation.get_object()
        address = urlsplit(str(one.get("/A", {}).get("/URI", "")))
        named = str(one.get("/Dest", "")).removeprefix("/")
        target, anchor = (part.name, named) if named else (Path(unquote(address.path)).stem, address.fragment)
        box = tuple(float(x) for x in one["/Rect"])
        if (named or address.scheme == "file") and target in parts:
            if box[3] - box[1] > SMALLEST_LINK:
                goal = start[target] + parts[target].page_of(unquote(anchor))
                led.append(Link(rect=box, target_page_index=goal, fit=Fit.fit_horizontally()))
        elif address.scheme in ("http", "https", "mailto"):
            kept.append(annotation)
    page[NameObject("/Annots")] = kept
    return led


def joined(browser: Any, parts: list[Part]) -> PdfWriter:
    """The book."""
    front, start = front_matter(browser, parts)
    by_name = {part.name: part for part in parts}
    writer = PdfWriter()
    feet = [""] * len(front.pages)
    for page in front.pages:
        writer.add_page(page)
    for part in parts:
        for page in part.reader.pages:
            writer.add_page(page)
        title = part.headings[0][2] if part.headings else part.name
        feet += [title] * len(part.reader.pages)
    for page, foot in zip(writer.pages, footed(browser, feet).pages, strict=True):
        page.merge_page(foot)
        page.compress_content_streams()
    for part in parts:
        first = start[part.name]
        for page in writer.pages[first : first + len(part.reader.pages)]:
            for link in lead_home(page, part, start, by_name):
                writer.add_annotation(page_number=page.page_number, annotation=link)
        above = None
        for anchor, level, heading in part.headings:
            mark = writer.add_outline_item(
                title=heading, page_number=first + part.page_of(anchor), parent=above if level > 1 else None
            )
            above = mark if level == 1 else above
    writer.add_metadata({"/Title": "Unstructured mesh generation", "/Author": "The unstruct authors"})
    writer.page_mode = "/UseOutlines"
    writer.compress_identical_objects()
    return writer


@click.command()
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path), default="book.pdf")
@click.option("--only", multiple=True, help="Pages whose names begin so, for a look at some.")
@click.option("--lecture", type=int, help="The figures of this lecture as slides, in place of the book.")
@click.option("--site", type=click.Path(path_type=Path), help="A built site, which is then not built anew.")
def main(out: Path, only: tuple[str, ...], lecture: int | None, site: Path | None) -> None:
    """Write the book, or some of its pages, into OUT."""
    browser_path = next(filter(None, map(shutil.which, NAMES)), None)
    if browser_path is None:
        raise click.ClickException(f"no browser: none of {', '.join(NAMES)} is installed")
    if site is None:
        site = HERE / "_build" / "html"
        subprocess.run(
            [sys.executable, "-m", "sphinx", "-q", "-W", "-E", "-b", "html", HERE, site], check=True
        )
    wanted = [(n, c) for n, c in in_order(site) if not only or n.startswith(only)]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path, args=FLAGS, timeout=PATIENCE)
        if lecture is not None:
            count = slides(browser, site / f"lecture-{lecture:02d}.html", out)
            click.echo(f"{out}: {count} slides, {out.stat().st_size / 1e6:.1f} MB")
            return
        parts = []
        with click.progressbar(wanted, label="pages", file=sys.stderr) as bar:
            for name, caption in bar:
                parts.append(
                    Part(name, caption, *printed(browser, (site / f"{name}.html").resolve().as_uri()))
                )
        book = joined(browser, parts)
        browser.close()
    book.write(out)
    click.echo(f"{out}: {len(book.pages)} pages, {out.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
