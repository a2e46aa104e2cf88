"""The print edition: pages of the site become one PDF whose numbers, bookmarks and links lead home."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from book_files import ROOT

pypdf = pytest.importorskip("pypdf", reason="pypdf is not installed")
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
pytestmark = pytest.mark.skipif(
    not any(map(shutil.which, NAMES)), reason=f"no browser: none of {', '.join(NAMES)} is installed"
)
PAGES = ["3.1", "3.4", "errata"]


@pytest.fixture(scope="module")
def book(site: Path, tmp_path_factory: pytest.TempPathFactory) -> pypdf.PdfReader:
    """Three pages of the site as a book."""
    out = tmp_path_factory.mktemp("print") / "book.pdf"
    command = [sys.executable, ROOT / "site" / "print_edition.py", out, "--site", site]
    subprocess.run([*command, *(word for name in PAGES for word in ("--only", name))], check=True)
    return pypdf.PdfReader(out)


@pytest.fixture(scope="module")
def texts(book: pypdf.PdfReader) -> list[str]:
    return [page.extract_text() for page in book.pages]


def chapters_of(book: pypdf.PdfReader) -> dict[str, int]:
    """The pages, counted from 0, on which the chapters begin, by the bookmarks."""
    tops = [mark for mark in book.outline if not isinstance(mark, list)]
    return {mark.title: book.get_destination_page_number(mark) for mark in tops}


def test_pages_are_numbered_and_bear_their_chapter(book: pypdf.PdfReader, texts: list[str]) -> None:
    front = min(chapters_of(book).values())
    assert front == 2  # title and contents
    starts = sorted((first, title) for title, first in chapters_of(book).items())
    for k, text in enumerate(texts[front:], start=front):
        title = [title for first, title in starts if first <= k][-1]
        assert re.search(rf"(^|\s){k + 1}$", text, flags=re.M), k
        assert title in text.replace("\n", " "), (k, title)


def test_the_contents_agree_with_the_bookmarks(book: pypdf.PdfReader, texts: list[str]) -> None:
    contents = texts[1]
    assert len(chapters_of(book)) == len(PAGES)
    for title, first in chapters_of(book).items():
        assert title in texts[first]
        assert re.search(rf"{re.escape(title)}\s+{first + 1}\b", contents), title


def test_links_lead_to_pages_of_the_book(book: pypdf.PdfReader) -> None:
    """Of the two chapters, that to the other."""
    second = next(first for title, first in chapters_of(book).items() if title.startswith("3.4"))
    across = set()
    for k, page in enumerate(book.pages):
        for annotation in page.get("/Annots") or []:
            one = annotation.get_object()
            address = str(one.get("/A", {}).get("/URI", ""))
            assert not address.startswith("file:"), address
            if "/Dest" in one:
                goal = book.get_page_number(one["/Dest"][0].get_object())
                across.add((k >= second, goal >= second))
    assert {(False, False), (True, False)} <= across


def test_a_lecture_is_slides(site: Path, tmp_path: Path) -> None:
    """Wide sheets, one for each figure besides the title and the chapters."""
    out = tmp_path / "slides.pdf"
    command = [sys.executable, ROOT / "site" / "print_edition.py", out, "--lecture", "5", "--site", site]
    subprocess.run(command, check=True)
    slides = pypdf.PdfReader(out).pages
    text = (site / "lecture-05.html").read_text(encoding="utf-8")
    assert len(slides) == 1 + text.count("<h2><a") + text.count("<img alt=")
    assert all(slide.mediabox.width > 1.5 * slide.mediabox.height for slide in slides)
    assert "2.3 Predict" in slides[3].extract_text()


def test_solutions_are_on_paper_and_drawing_is_not(texts: list[str]) -> None:
    whole = "\n".join(texts)
    assert "Solution" in whole and "∎" in whole.replace("■", "∎")
    assert "Show source" not in whole and "Hide content" not in whole
    assert "import matplotlib" not in whole
