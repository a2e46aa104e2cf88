"""The map of the chapters, ways through them, and lectures (`chapters.toml`), for the pages with them."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Sequence
from functools import cache
from html import escape
from pathlib import Path
from typing import Any

from chapters import Chapter, chapters

BOOK = Path(__file__).parent
WIDE, HIGH = 100, 92  # of a place on the map, in pixels
BOX = 94, 64
FILLED = {"first": "#dcebf7", "second": "#ffffff"}
WORDS = 95  # a minute, where a chapter does not say how many minutes it takes


@cache
def data() -> dict[str, Any]:
    return tomllib.loads((BOOK / "chapters.toml").read_text(encoding="utf-8"))


def cards() -> list[tuple[Chapter, dict[str, Any]]]:
    """The chapters, with what `chapters.toml` says of each."""
    rows = {row["number"]: row for row in data()["chapter"]}
    return [(chapter, rows[chapter.number]) for chapter in chapters()]


def named(number: str) -> list[Chapter]:
    """The chapter of a number, or those whose numbers begin with it."""
    exact = [chapter for chapter in chapters() if chapter.number == number]
    return exact or [chapter for chapter in chapters() if chapter.number.startswith(number)]


def all_named(numbers: Sequence[str]) -> list[Chapter]:
    return [chapter for number in numbers for chapter in named(number)]


def minutes(chapter: Chapter) -> int:
    """How long it takes to read: as it says, else by the number of its words."""
    words = sum(len(text.split()) for text in chapter.texts)
    return chapter.minutes or 5 * round(words / WORDS / 5)


def depth() -> dict[str, int]:
    """For each chapter, how many must be read one after the other before it: its row on the map."""
    needs = {chapter.number: [need.number for need in all_named(card["needs"])] for chapter, card in cards()}

    def row(number: str, after: tuple[str, ...] = ()) -> int:
        if number in after:
            raise ValueError(f"chapters.toml: {' needs '.join([*after, number])}")
        return 1 + max((row(need, (*after, number)) for need in needs[number]), default=-1)

    return {number: row(number) for number in needs}


def drawn_map() -> str:
    """The map as SVG: a box for each chapter, which is a link, and a line from each one that it needs."""
    rows = depth()
    place = {
        chapter.number: (
            (card["column"] + 0.6) * WIDE,
            (rows[chapter.number] + 0.45) * HIGH,
        )
        for chapter, card in cards()
    }
    size = (8.2 * WIDE, (max(rows.values()) + 0.9) * HIGH)
    lines, boxes = [], []
    for chapter, card in cards():
        x, y = place[chapter.number]
        for need in all_named(card["needs"]):
            x0, y0 = place[need.number]
            start, end = y0 + BOX[1] / 2, y - BOX[1] / 2
            bend = (start + end) / 2
            lines.append(f"M{x0:.0f} {start:.0f}C{x0:.0f} {bend:.0f} {x:.0f} {bend:.0f} {x:.0f} {end:.0f}")
        reading = "first" if card["reading"] == 1 else "second"
        texts = [f'<text x="{x:.0f}" y="{y - 13:.0f}" font-weight="bold">{chapter.number}</text>']
        for k, words in enumerate(card["short"].split("\n")):
            texts.append(f'<text x="{x:.0f}" y="{y + 5 + 14 * k:.0f}" font-size="12">{escape(words)}</text>')
        wide, high = BOX
        corner = f'x="{x - wide / 2:.0f}" y="{y - high / 2:.0f}" width="{wide}" height="{high}" rx="8"'
        dashes = "" if reading == "first" else ' stroke-dasharray="5 3"'
        name = escape(f"{chapter.number} {chapter.title}, {reading} reading", quote=True)
        boxes.append(
            f'<a href="{chapter.file}" aria-label="{name}"><rect {corner} stroke="#1f4e79" '
            f'stroke-width="1.3" fill="{FILLED[reading]}"{dashes}/>{"".join(texts)}</a>'
        )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size[0]:.0f} {size[1]:.0f}" role="group" '
        f'aria-label="Map of the chapters" width="{size[0]:.0f}" text-anchor="middle" font-size="14" '
        f'font-family="DejaVu Sans, Verdana, sans-serif" fill="#111111">'
        f'<rect width="100%" height="100%" fill="#fff"/>'
        f'<path d="{"".join(lines)}" fill="none" stroke="#77828c" stroke-width="1.3"/>{"".join(boxes)}</svg>'
    )


def link(chapter: Chapter) -> str:
    return f"[{chapter.number}]({chapter.file})"


def table() -> str:
    """The chapters in Markdown: title, question, what they need, minutes, reading, names of the library."""
    lines = [
        "| chapter, and its question | needs | minutes | reading | in the library |",
        "| --- " * 5 + "|",
    ]
    for chapter, card in cards():
        needs = ", ".join(link(need) for need in all_named(card["needs"])) or "–"
        reading = "first" if card["reading"] == 1 else "second"
        title = f"[{chapter.number} {chapter.title}]({chapter.file})<br>{card['question']}"
        cells = [title, needs, str(minutes(chapter)), reading, card["library"]]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def total(some: Sequence[Chapter]) -> str:
    hours = sum(map(minutes, some)) / 60
    return f"about {hours:.0f} hours"


def course() -> str:
    """The lectures in Markdown, one a line."""
    lines = []
    for number, lecture in enumerate(data()["lecture"], start=1):
        parts = ", ".join(link(chapter) for chapter in all_named(lecture["chapters"]))
        lines.append(f"{number}. {lecture['title']}: {parts}")
    return "\n".join(lines)


def path(number: int) -> str:
    """A way through the book in Markdown."""
    row = data()["path"][number]
    some = all_named(row["chapters"])
    steps = " → ".join(f"[{chapter.number} {chapter.title}]({chapter.file})" for chapter in some)
    others = ", ".join(f"[{page_title(name)}]({name}.ipynb)" for name in row["pages"])
    return (
        f"{row['about']}\n\n{steps}\n\nThen, when you need them: {others}. The chapters take {total(some)}."
    )


def page_title(name: str) -> str:
    return Chapter(BOOK / f"{name}.ipynb").texts[0].splitlines()[0].removeprefix("# ")


def lectures() -> Iterator[str]:
    """Each lecture in Markdown: what is read, what students can do afterwards, what is shown, what is set."""
    for number, lecture in enumerate(data()["lecture"], start=1):
        some = all_named(lecture["chapters"])
        reads = ", ".join(f"[{chapter.number} {chapter.title}]({chapter.file})" for chapter in some)
        time = f"{sum(map(minutes, some))} minutes of reading"
        lines = [f"**Lecture {number}: {lecture['title']}.** {reads} ({time}).", ""]
        lines += [f"- Afterwards students can {lecture['aim']}."]
        shown = [(chapter, figures(chapter)) for chapter in some]
        for chapter, found in shown:
            lines += [
                f"- To show ({chapter.number}): {text} [{place.title}]({place.link})" for text, place in found
            ]
        tasks = ", ".join(
            f"[{chapter.number}]({chapter.file}#Exercises)" for chapter in some if has_exercises(chapter)
        )
        lines += [f"- Homework: two of the exercises of {tasks}."]
        lines += [f"- To leave: {lecture['leave']}."] if lecture["leave"] else []
        yield "\n".join(lines)


def has_exercises(chapter: Chapter) -> bool:
    return any(title == "Exercises" for _, title in chapter.headings())


def figures(chapter: Chapter, most: int = 3) -> list[tuple[str, Any]]:
    """The first pictures of the sections that carry a lecture, by their texts, with their places."""
    wanted = ("", "by hand", "theorem", "real regions", "in earnest")
    found: list[tuple[str, Any]] = []
    for text, place in chapter.figures():
        title = place.title.lower() if place.target else ""
        new = all(place.title != other.title for _, other in found)
        if new and any(title == word or (word and word in title) for word in wanted):
            found.append((text, place))
    return found[:most]
