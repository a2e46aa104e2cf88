"""The works that the book cites (`works.toml`), and where its chapters cite them."""

from __future__ import annotations

import re
import tomllib
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import quote

from chapters import Chapter, chapters

BOOK = Path(__file__).parent
# A year, but not a page of "2005–2039", nor a number of digits more
YEAR = re.compile(r"(?<![\d–\-.,])(1[6-9]\d\d|20[0-2]\d)(?:[a-z]\b)?(?![\d–\-]|,\d)")


@dataclass(frozen=True)
class Work:
    """One work; ``source`` if the source chapter cites it."""

    authors: tuple[str, ...]
    year: str  # with a letter, where an author has several
    title: str
    where: str = ""
    editors: bool = False
    doi: str = ""
    link: str = ""
    link_name: str = ""
    about: str = ""
    slip: str = ""  # of the source chapter's list
    source: bool = False

    @property
    def families(self) -> tuple[str, ...]:
        return tuple(name.split(",")[0] for name in self.authors)

    @property
    def key(self) -> str:
        return "-".join([plain(self.families[0]).replace(" ", "-"), self.year])


@cache
def data() -> dict[str, Any]:
    return tomllib.loads((BOOK / "works.toml").read_text(encoding="utf-8"))


def works() -> list[Work]:
    """All works, by their authors and years."""
    found = [Work(**{**row, "authors": tuple(row["authors"])}) for row in data()["work"]]
    return sorted(
        found,
        key=lambda work: (
            [plain(name) for name in work.authors],
            work.year,
            work.title,
        ),
    )


def plain(text: str) -> str:
    """A text in lower case, without accents, marks of formulas, and punctuation."""
    letters = unicodedata.normalize("NFKD", text.replace("ø", "o").replace("ł", "l"))
    letters = "".join(c for c in letters if not unicodedata.combining(c)).lower()
    return re.sub(r"[^a-z0-9]+", " ", letters).strip()


def entry(work: Work, cited_in: Sequence[Chapter] = ()) -> str:
    """A line of Markdown for the list of references, with links to the sources of chapters that cite it."""
    names = list(work.authors)
    joined = names[0] if len(names) == 1 else ", ".join(names[:-1]) + ", and " + names[-1]
    title = work.title if work.title.endswith(("?", "!")) else f"{work.title}."
    parts = [
        f"{joined}{' (eds.)' if work.editors else ''} ({work.year}). {title}",
        work.where,
    ]
    parts += [
        f"({work.about}.)" if work.about else "",
        f"*{work.slip}*" if work.slip else "",
    ]
    if work.doi:
        shown = work.doi.replace("<", "&lt;").replace(">", "&gt;")
        parts.append(f"[doi:{shown}](https://doi.org/{quote(work.doi, safe='/:;.-_')})")
    if work.link:
        parts.append(f"[{work.link_name}]({work.link})")
    if cited_in:
        parts.append("Cited in " + ", ".join(f"[{c.number}]({c.file}#Sources)" for c in cited_in) + ".")
    return " ".join(part for part in parts if part)


def units(chapter: Chapter) -> Iterator[tuple[str, bool]]:
    """The paragraphs and entries of lists of a chapter, and whether they stand among its sources."""
    inside = False
    for text in chapter.texts:
        for part in re.split(r"\n(?=- )|\n\s*\n", text):
            heading = re.search(r"^## +(.*)", part, flags=re.M)
            inside = "source" in heading[1].lower() if heading else inside
            yield part, inside


def named(work: Work, words: str) -> int:
    """How many of a work's authors a text (made plain) names; 0 if it does not name the first one."""
    found = [f" {plain(name)} " in words for name in work.families]
    return sum(found) if found[0] else 0


def cited(unit: str, known: Sequence[Work]) -> tuple[list[Work], list[str]]:
    """The works that a paragraph cites, and the years in it that no work accounts for.

    Names stand before their year and after the year before it. Where none stands there, those of the whole
    paragraph count ("Thue (1892, 1910)"), and behind a year those with "ibid.".
    """
    found: list[Work] = []
    loose = []
    unit, start = without_links(unit), 0
    marks = list(YEAR.finditer(unit))
    for mark, after in zip(marks, [*marks[1:], None]):
        same = [work for work in known if work.year[:4] == mark[1]]
        here = fitting(unit[start : mark.start()], same) or fitting(unit, same)
        rest = unit[mark.end() : after.start() if after else None]
        if "ibid" in rest:
            here += [work for work in fitting(rest, same) if work not in here]
        found += here
        loose += [] if here else [mark[1]]
        start = mark.end()
    return found, loose


def fitting(text: str, same: Sequence[Work]) -> list[Work]:
    """Which of some works of one year a text names: by the title, else by all authors (or "et al.")."""
    words = f" {plain(text)} "
    full = [w for w in same if named(w, words) and (" et al " in words or named(w, words) == len(w.authors))]
    sure = [w for w in full if plain(w.title)[:24] in words]
    largest = [w for w in full if not any(set(w.families) < set(v.families) for v in full)]
    if sure:
        return sure + [
            w for w in largest if w not in sure and not any(w.families[0] in s.families for s in sure)
        ]
    return largest


def without_links(text: str) -> str:
    return re.sub(r"\]\([^)]*\)", "]", text)


# In the text a citation is a name and a year in parentheses, or "Name 1987"; other years are not citations.
IN_TEXT = re.compile(
    r"([A-Z][\w’'-]+(?:(?:, | and | & )[A-Z][\w’'-]+)*(?: et al\.)?)(?:'s)? \((1[6-9]\d\d|20[0-2]\d)\)"
)


def citations(chapter: Chapter, known: Sequence[Work]) -> tuple[set[Work], list[str]]:
    """The works that a chapter cites, and its citations that are of no known work."""
    found: set[Work] = set()
    unknown = []
    for unit, among_sources in units(chapter):
        if among_sources:
            for phrase in data()["no_works"]:
                unit = unit.replace(phrase, "")
            here, loose = cited(unit, known)
            found |= set(here)
            if "Liseikin" not in unit:  # what is said of the source's own references
                unknown += [f"{year} in: {unit.strip()[:160]}" for year in loose]
        for names, year in IN_TEXT.findall(without_links(unit)) if not among_sources else []:
            here, loose = cited(f"{names} ({year})", known)
            found |= set(here)
            unknown += [f"{names} ({year})"] if loose else []
    return found, unknown


def places() -> dict[Work, list[Chapter]]:
    """For each work the chapters that cite it."""
    known = works()
    found: dict[Work, list[Chapter]] = {work: [] for work in known}
    for chapter in chapters():
        for work in citations(chapter, known)[0]:
            found[work].append(chapter)
    return found
