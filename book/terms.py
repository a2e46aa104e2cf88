"""The glossary (`glossary.toml`) and the index (`index.toml`): terms, and where chapters have them."""

from __future__ import annotations

import html
import re
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import works
from chapters import Chapter, Place, chapters

import unstruct

BOOK = Path(__file__).parent
BOLD = re.compile(r"(?<!\*)\*\*(?!\s)([^*\n]{2,60}?)\*\*(?!\*)")
# Before a bold word that opens a statement, an entry of a list or a table, or a paragraph
OPENS = re.compile(r"(?:^|\n\s*\n|^> ?|\n> ?|\n[-|\d]+[. ] *|\| *)(?:<a [^>]*></a>)?$")
PLACES = 3  # of an entry of the index
ASIDE = ("Exercises", "Sources")


@dataclass(frozen=True)
class Term:
    """A term of the glossary; ``also`` are other forms, ``within`` the beginning of chapters' numbers."""

    name: str
    means: str
    also: tuple[str, ...] = ()
    within: str = ""

    @property
    def anchor(self) -> str:
        return "term-" + re.sub(r"[^\w]+", "-", self.name.lower()).strip("-")

    @property
    def forms(self) -> list[str]:
        return [self.name, *self.also]

    @property
    def long_forms(self) -> list[str]:
        """The name, and other forms of several words, which mean nothing else."""
        return [self.name, *(form for form in self.also if re.search(r"[ –-]", form))]


@cache
def glossary() -> dict[str, Any]:
    return tomllib.loads((BOOK / "glossary.toml").read_text(encoding="utf-8"))


def terms() -> list[Term]:
    """The terms of the glossary by the alphabet."""
    found = [
        Term(row["name"], row["means"], tuple(row.get("also", ())), row.get("in", ""))
        for row in glossary()["term"]
    ]
    return sorted(found, key=lambda term: works.plain(term.name.replace("ε", "epsilon")))


def pattern(forms: Iterable[str]) -> re.Pattern[str]:
    """What finds any of some words, with a plural, whether or not a line is broken between them."""
    any_of = "|".join(re.escape(form).replace(r"\ ", r"\s+") for form in sorted(forms, key=len, reverse=True))
    return re.compile(rf"(?i:(?<![\w-])(?:{any_of})(?:e?s)?(?![\w-]))")


@cache
def pieces() -> list[tuple[Chapter, str, Place, bool]]:
    """The text of all chapters, cut at headings and statements, in order."""
    return [(chapter, *piece) for chapter in chapters() for piece in chapter.pieces()]


@cache
def pieces_of(chapter: Chapter) -> list[tuple[Chapter, str, Place, bool]]:
    return [piece for piece in pieces() if piece[0] is chapter]


@cache
def whole(chapter: Chapter, with_code: bool) -> str:
    return "\n\n".join(text for _, text, _, is_code in pieces_of(chapter) if with_code or not is_code)


@cache
def flat(chapter: Chapter) -> str:
    """All of a chapter in lower case and on one line, to see quickly that it does not have a word."""
    return " ".join(" ".join(text for _, text, _, _ in pieces_of(chapter)).lower().split())


@cache
def introduced(term: Term) -> Place | None:
    """Where a term, else another form of it, is set in bold, else in italics, else named for the first time.

    Exercises and sources come last.
    """
    found = None
    for marks in (r"(?<!\*)\*\*{}\*\*", r"(?<!\*)\*(?!\*){}\*(?!\*)", "{}"):
        for forms in ([term.name], term.forms):
            marked = re.compile(marks.replace("{}", pattern(forms).pattern))
            near = [each for each in chapters() if any(form.lower() in flat(each) for form in forms)]
            for chapter, text, place, is_code in (piece for each in near for piece in pieces_of(each)):
                if not is_code and chapter.number.startswith(term.within) and marked.search(text):
                    if place.title not in ASIDE:
                        return place
                    found = found or place
    return found


def in_bold() -> Iterator[tuple[Chapter, str]]:
    """Words that chapters set in bold within a sentence, where they may be terms: a few, in lower case."""
    for chapter, text, _, is_code in pieces():
        for mark in BOLD.finditer(text) if not is_code else ():
            words = mark[1].strip(" .,:;")
            few = re.fullmatch(r"[^\W\dA-Z_][\w’'–-]*(?: [\w’'–-]+){0,2}", words)
            if few and not OPENS.search(text[max(0, mark.start() - 60) : mark.start()]):
                yield chapter, words


def show_glossary(letters: str) -> str:
    """The entries of some letters in Markdown, each with its place."""
    lines = []
    for term in terms():
        place = introduced(term)
        if initial(term.name) in letters and place:
            link = f"[{place.number}: {place.title}]({place.link})"
            lines.append(f'- <a id="{term.anchor}"></a>**{term.name}**: {term.means} ({link})')
    return "\n".join(lines)


def initial(name: str) -> str:
    first = works.plain(name.replace("ε", "epsilon"))[:1].upper()
    return first if first.isalpha() else "0"


@dataclass(frozen=True)
class Entry:
    """An entry of the index: its name, what finds its places, and another entry that it refers to."""

    name: str
    finds: str
    kind: str  # term, person, function, other
    within: str = ""
    see: str = ""
    hint: str = ""  # in lower case; where it is not, there is no place

    @property
    def shown(self) -> str:
        name = html.escape(self.name, quote=False)
        return f"<code>{name}</code>" if self.kind == "function" else name


@cache
def entries() -> list[Entry]:
    """Terms of the glossary, authors and names of the library in chapters, and what `index.toml` adds."""
    found = [Entry(t.name, pattern(t.long_forms).pattern, "term", t.within) for t in terms()]
    found += people() + functions()
    extra = tomllib.loads((BOOK / "index.toml").read_text(encoding="utf-8"))["entry"]
    known = {entry.name for entry in found}
    for row in extra:
        finds = row.get("find", pattern([row["name"]]).pattern)
        found += [Entry(row["name"], finds, "other", row.get("in", ""), row.get("see", ""))]
        if row["name"] in known:
            raise ValueError(f"index.toml: {row['name']!r} is in the index without it")
    found = [entry for entry in found if entry.see or entry.kind == "other" or places(entry)]
    return sorted(
        found,
        key=lambda entry: (
            works.plain(entry.name.replace("ε", "epsilon")),
            entry.name,
        ),
    )


def people() -> list[Entry]:
    """The authors of works that chapters cite; where two have one family name, the initial decides."""
    names = {name for work, cited in works.places().items() if cited for name in work.authors}
    families = Counter(name.split(",")[0] for name in names)
    found = []
    for name in sorted(names):
        family, given = name.split(", ", 1)
        finds = rf"\b{re.escape(family)}\b".replace("\\ ", " ")
        if families[family] > 1:
            finds = rf"\b{re.escape(given[0])}\.[^,;]{{0,8}}{finds}"
        found.append(Entry(name, finds, "person", hint=family.lower()))
    return found


def functions() -> list[Entry]:
    """Names of the library's face and of its studies, as they stand in code."""
    spaces = {
        "predicates",
        "simplex",
        "topology",
        "sizing",
        "view",
        "plain",
        "examples",
        "studies",
    }
    face = [(name, "unstruct") for name in unstruct.__all__ if name not in spaces]
    return [
        Entry(
            name if space == "unstruct" else f"{space}.{name}",
            rf"(?<![\w.])(?:{space}\.)?{name}\b(?=[(`.])",
            "function",
            hint=name.lower(),
        )
        for name, space in [
            *face,
            *((name, "studies") for name in unstruct.studies.__all__),
        ]
    ]


@cache
def places(entry: Entry) -> list[Place]:
    """The best few places of an entry, at most one of a chapter, the most important one first."""
    if not entry.finds:
        return []
    finds = re.compile(entry.finds.replace(" ", r"\s+"))
    weights: Counter[Place] = Counter()
    for chapter in chapters():
        near = chapter.number.startswith(entry.within) and entry.hint in flat(chapter)
        if not near or not finds.search(whole(chapter, entry.kind == "function")):
            continue
        for _, text, place, is_code in pieces_of(chapter):
            count = len(finds.findall(text)) if not is_code or entry.kind == "function" else 0
            if count:
                bold = sum(bool(finds.fullmatch(mark[1].strip(" .,:;"))) for mark in BOLD.finditer(text))
                less = place.title in ASIDE and entry.kind != "person"
                titled = 4 * bool(finds.search(place.title))
                weights[place] += (count + 8 * bold + titled) * (0.3 if less else 1)
    ranked = [place for place, _ in sorted(weights.items(), key=lambda item: -item[1])]
    known = {term.name: term for term in terms()}
    if entry.kind == "term" and (first := introduced(known[entry.name])):
        ranked.insert(0, first)
    chosen: list[Place] = []
    for place in ranked:
        if all(place.number != other.number for other in chosen) and len(chosen) < PLACES:
            chosen.append(place)
    return chosen


def show_index(letters: str) -> str:
    """Entries in HTML: the place that matters most in bold, then others in the order of the book."""
    some = [entry for entry in entries() if initial(entry.name) in letters]
    order = [chapter.number for chapter in chapters()]
    known = {term.name: term for term in terms()}
    lines = []
    for entry in some:
        found = places(entry)
        links = []
        for place in sorted(found, key=lambda place: order.index(place.number)):
            title = html.escape(f"{place.number} {place.title}", quote=False)
            link = f'<a href="{html.escape(place.link)}">{title}</a>'
            links.append(f"<b>{link}</b>" if place == found[0] and len(found) > 1 else link)
        if entry.kind == "term":
            links.append(f'<a href="glossary.ipynb#{known[entry.name].anchor}">glossary</a>')
        if entry.see:
            links.append(f"see {html.escape(entry.see, quote=False)}")
        lines.append(f"<li>{entry.shown}: {' · '.join(links)}</li>")
    return '<ul class="index-of-terms">\n' + "\n".join(lines) + "\n</ul>"
