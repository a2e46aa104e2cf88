"""The chapters as the pages beside them read them: titles, headings, numbered statements, places of words.

Everything is read from the notebooks, so that these pages never hang on a number written by hand.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

BOOK = Path(__file__).parent
STATEMENTS = ("theorem", "lemma", "corollary", "proposition", "definition")
ANCHOR = re.compile(
    rf'<a id="((?:{"|".join(STATEMENTS)})-[\w-]+)"></a>\s*(?:> ?)?'
    r"\*\*(\w+) ([\w.]+\d)(?: \(([^)]*(?:\([^)]*\))?[^)]*)\))?\.?\*\*\.?\s*"
)
HEADING = re.compile(r"^(#{1,3}) +(.*?)\s*$", flags=re.M)
CODE = re.compile(r"^(```|~~~).*?^\1", flags=re.M | re.S)


@dataclass(frozen=True)
class Place:
    """A heading or a statement that can be linked to; ``target`` is what stands behind the #."""

    file: str
    number: str  # of the chapter
    title: str
    target: str

    @property
    def link(self) -> str:
        return f"{self.file}#{self.target}" if self.target else self.file


@dataclass(frozen=True)
class Statement:
    """A numbered theorem, lemma, definition, ...: its kind, number, name, first words and place."""

    kind: str
    number: str
    name: str
    words: str
    place: Place


@dataclass(frozen=True)
class Chapter:
    """A notebook whose name begins with the number of a section."""

    path: Path

    @property
    def file(self) -> str:
        return self.path.name

    @property
    def number(self) -> str:
        return self.path.stem.split("-")[0]

    @cached_property
    def cells(self) -> list[dict[str, Any]]:
        found = json.loads(self.path.read_text(encoding="utf-8"))["cells"]
        return [{**cell, "source": "".join(cell["source"])} for cell in found]

    @cached_property
    def texts(self) -> list[str]:
        return [cell["source"] for cell in self.cells if cell["cell_type"] == "markdown"]

    @property
    def title(self) -> str:
        """Its title without the number."""
        return re.sub(r"^# +\S+ +", "", self.texts[0].splitlines()[0])

    @property
    def minutes(self) -> int | None:
        """How long reading takes, as its first cell says."""
        said = re.search(r"\b(\d+) minutes\b", self.texts[0])
        return int(said[1]) if said else None

    def pieces(self) -> Iterator[tuple[str, Place, bool]]:
        """The text in order, cut at headings and statements: each part, its place, and whether it is code.

        Exercises belong to their common heading, and so does what follows a statement in other cells.
        """
        titles = [title for _, title in self.headings()]
        here = heading = Place(self.file, self.number, self.title, "")
        exercises = False
        for cell in self.cells:
            if cell["cell_type"] == "code":
                yield cell["source"], here, True
                continue
            text, start, here = cell["source"], 0, heading
            marks = [*HEADING.finditer(blank(text)), *ANCHOR.finditer(text)]
            for mark in sorted(marks, key=lambda mark: mark.start()):
                yield text[start : mark.start()], here, False
                start = mark.start()
                if mark.re is ANCHOR:
                    here = Place(self.file, self.number, f"{mark[2]} {mark[3]}", mark[1])
                    continue
                level, title = len(mark[1]), mark[2]
                exercises = title.lower().startswith("exercises") if level == 2 else exercises and level == 3
                inner = exercises and level == 3
                if (
                    level > 1
                    and not inner
                    and titles.count(title) == 1
                    and not re.search(r"[$*`\[\]<>]", title)
                ):
                    here = heading = Place(self.file, self.number, title, title.replace(" ", "-"))
            yield text[start:], here, False

    def figures(self) -> Iterator[tuple[str, Place]]:
        """The text that stands for each picture, and the picture's place."""
        where = [place for _, place, is_code in self.pieces() if is_code]
        for cell, place in zip((cell for cell in self.cells if cell["cell_type"] == "code"), where):
            text = cell["metadata"].get("mystnb", {}).get("image", {}).get("alt", "")
            if text:
                yield text, place

    def headings(self) -> list[tuple[int, str]]:
        found = [HEADING.findall(blank(text)) for text in self.texts]
        return [(len(marks), title) for pairs in found for marks, title in pairs]

    def statements(self) -> Iterator[Statement]:
        """Its numbered statements, with their first words."""
        for text in self.texts:
            for mark in ANCHOR.finditer(text):
                rest = re.split(r"\n\s*(?:> ?)?\s*\n|\n(?!>)", text[mark.end() :], maxsplit=1)[0]
                rest = re.sub(r"\s+", " ", re.sub(r"^> ?", "", rest, flags=re.M)).strip()
                place = Place(self.file, self.number, f"{mark[2]} {mark[3]}", mark[1])
                yield Statement(mark[2], mark[3], mark[4] or "", first_words(rest), place)


def blank(text: str) -> str:
    """A text of the same length with its blocks of code blanked, whose comments are no headings."""
    return CODE.sub(lambda block: re.sub(r"[^\n]", " ", block[0]), text)


def first_words(text: str, least: int = 12, most: int = 34) -> str:
    """The first sentences, at least ``least`` words, cut before a displayed formula or after ``most``."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    if re.match(r"\*[^*]", text):  # set in italics as a whole
        text = re.sub(r"(?<!\*)\*$", "", text[1:])
    shown, display, _ = text.partition("$$")
    words = shown.split()
    for count in range(1, len(words) + 1):
        part = " ".join(words[:count])
        whole = part.count("$") % 2 == 0 and part.count("*") % 2 == 0
        if whole and count >= least and re.search(r"\w[).$]*\.$", part):
            return part
        if whole and count >= most and count < len(words):
            return f"{part} …"
    return " ".join(words) + (" …" if display or not shown.endswith(".") else "")


@cache
def chapters() -> list[Chapter]:
    """The chapters in the order of the book."""
    return [Chapter(path) for path in sorted(BOOK.glob("*.ipynb")) if path.name[0].isdigit()]


def theorems() -> str:
    """All numbered statements by chapter, in Markdown."""
    lines = []
    for chapter in chapters():
        found = list(chapter.statements())
        if found:
            lines.append(f"\n**[{chapter.number} {chapter.title}]({chapter.file})**\n")
        for statement in found:
            link = f"[{statement.kind} {statement.number}]({statement.place.link})"
            name = f" *({statement.name})*" if statement.name else ""
            lines.append(f"- {link}{name}: {statement.words}")
    return "\n".join(lines)
