"""Pages made from the chapters: references, theorems, glossary, index, map, lectures; nothing is missing."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from types import ModuleType

import nbformat
import pytest
from book_files import BOOK, code_cells, notebook

PAGES = ("theorems", "glossary", "index-of-terms", "references", "teaching")


@pytest.fixture(scope="module")
def book() -> dict[str, ModuleType]:
    """The modules beside the notebooks, which their cells import."""
    sys.path.insert(0, str(BOOK))
    try:
        import chapters
        import maps
        import terms
        import works
    finally:
        sys.path.remove(str(BOOK))
    return {"chapters": chapters, "maps": maps, "terms": terms, "works": works}


def shown(page: str) -> str:
    """What the cells of a page put out."""
    outputs = [output for cell in code_cells(BOOK / f"{page}.ipynb") for output in cell.outputs]
    return "\n".join(
        o.get("text", "") or o.data.get("text/markdown", "") or o.data.get("text/html", "") for o in outputs
    )


def small(folder: Path, module: ModuleType, *texts: str) -> object:
    path = folder / "9.1-x.ipynb"
    cells = [nbformat.v4.new_markdown_cell(text) for text in texts]
    nbformat.write(nbformat.v4.new_notebook(cells=cells), path)
    return module.Chapter(path)


# References


def test_every_citation_of_a_chapter_is_a_known_work(book: dict[str, ModuleType]) -> None:
    known = book["works"].works()
    unknown = [
        f"{chapter.number}: {text}"
        for chapter in book["chapters"].chapters()
        for text in book["works"].citations(chapter, known)[1]
    ]
    assert not unknown, "put into book/works.toml: \n" + "\n".join(unknown)


def test_works_are_complete(book: dict[str, ModuleType]) -> None:
    places = book["works"].places()
    assert len({(w.authors, w.year) for w in places}) == len(places), "a work twice"
    for work in places:
        assert re.fullmatch(r"1[6-9]\d\d|20\d\d[ab]?|19\d\d[ab]", work.year), work
        assert all(re.fullmatch(r"[^,]+, .+", name) for name in work.authors), work
        assert work.where or work.link, work
        assert places[work] or work.source or work.about, f"cited nowhere, and not said what for: {work}"
    named = {(work.families, work.year) for work in places}
    assert {(("Holmes", "Snyder"), "1988"), (("Baker",), "1994"), (("Liseikin",), "2017")} <= named
    assert sum(work.source for work in places) >= 95


def test_the_page_of_references(book: dict[str, ModuleType]) -> None:
    """Each work once; each DOI is the address of its own link. Nothing is looked up."""
    text, places = shown("references"), book["works"].places()
    assert len(re.findall(r"^- ", text, flags=re.M)) == len(places)
    for work, chapters in places.items():
        assert text.count(book["works"].entry(work, chapters)) == 1, work
    dois = [work.doi for work in places if work.doi]
    assert len(set(dois)) == len(dois) == text.count("https://doi.org/") == text.count("[doi:10.")
    assert f"{len(places)} works, {len(dois)} with a DOI" in text


@pytest.mark.parametrize(
    ("source", "found", "unknown"),
    [
        ("- A. Bowyer, *The Computer Journal* 24 (1981) 162–166, and D. F. Watson, ibid. 167–172.", 2, 0),
        ("- S. Pirzadeh, one, *AIAA Journal* 32 (1994) 1; another, ibid. 34 (1996) 43.", 2, 0),
        ("- A. Thue (1892, 1910); L. Fejes Tóth, *Mathematische Zeitschrift* 46 (1940).", 3, 0),
        ("- M. V. Anglada (1997). J. R. Shewchuk and B. C. Brown, fast (2015): both.", 2, 0),
        ("- N. P. Weatherill, O. Hassan, *Journal* 37 (1994) 2005–2039.", 1, 0),
        ("- L. P. Chew, *Guaranteed-quality triangular meshes*, TR 89-983 (1989).", 1, 0),
        ("- N. Body, *Journal* 37 (1994) 1–2.", 0, 1),
        ("- S. Rebay, *Journal* 37 (1994) 1–2.", 0, 1),
        ("- V. D. Liseikin, 3rd edition, Springer 2017. It names a work of 1985.", 1, 0),
    ],
)
def test_citations_are_recognized(
    book: dict[str, ModuleType], tmp_path: Path, source: str, found: int, unknown: int
) -> None:
    chapter = small(tmp_path, book["chapters"], "# 9.1 A title", f"## Sources\n\n{source}")
    here, loose = book["works"].citations(chapter, book["works"].works())
    assert (len(here), len(loose)) == (found, unknown), (here, loose)


def test_citations_in_the_text_are_recognized(book: dict[str, ModuleType], tmp_path: Path) -> None:
    texts = ("# 9.1 As Rebay (1993) says", "In Sibson's (1980) way, as in Nobody (1990) and the year 1999.")
    here, loose = book["works"].citations(small(tmp_path, book["chapters"], *texts), book["works"].works())
    assert {work.families[0] for work in here} == {"Rebay", "Sibson"}
    assert loose == ["Nobody (1990)"]


# Theorems


def test_every_anchor_of_a_statement_is_in_the_list(book: dict[str, ModuleType]) -> None:
    text = shown("theorems")
    for chapter in book["chapters"].chapters():
        whole = "\n".join(chapter.texts)
        anchors = re.findall(r'<a id="((?:theorem|lemma|corollary|proposition|definition)-[^"]+)"', whole)
        assert [s.place.target for s in chapter.statements()] == anchors, chapter.file
        for anchor in anchors:
            assert text.count(f"({chapter.file}#{anchor})") == 1, anchor


def test_first_words_are_whole(book: dict[str, ModuleType]) -> None:
    first = book["chapters"].first_words
    assert first("*One two. " + "Three " * 9 + "four. Five.*") == "One two. " + "Three " * 9 + "four."
    assert first("Let $a + b$ be given. Then $$ a $$ and more.") == "Let $a + b$ be given. Then …"
    assert first("a " * 33 + "$b c d e$ " * 3) == "a " * 33 + "$b c d e$ …"
    assert first("By [Theorem 1](x.ipynb#y) all.") == "By Theorem 1 all."
    for chapter in book["chapters"].chapters():
        for statement in chapter.statements():
            words = statement.words
            assert words.count("$") % 2 == 0 and len(words) > 20, statement


# Glossary


def test_terms_are_defined_and_introduced(book: dict[str, ModuleType]) -> None:
    terms = book["terms"].terms()
    assert len(terms) >= 120
    forms = [form.lower() for term in terms for form in term.forms[:1]]
    assert len(set(forms)) == len(forms), "a term twice"
    assert len({term.anchor for term in terms}) == len(terms)
    lost = [term.name for term in terms if not book["terms"].introduced(term)]
    assert not lost, f"no chapter has {lost}"
    text = shown("glossary")
    for term in terms:
        assert term.means.endswith(".") and 5 <= len(term.means.split()) <= 60, term
        assert f'<a id="{term.anchor}"></a>**{term.name}**: {term.means}' in text, term.name


def test_what_is_introduced_in_bold_is_in_the_glossary(book: dict[str, ModuleType]) -> None:
    known = {form.lower() for term in book["terms"].terms() for form in term.forms}
    known |= {word.lower() for word in book["terms"].glossary()["stressed"]}
    missing = {
        f"{words} ({chapter.number})"
        for chapter, words in book["terms"].in_bold()
        if not {words.lower(), words.lower().removesuffix("s"), f"{words.lower()}s"} & known
    }
    assert not missing, (
        f"put into book/glossary.toml, as terms or among the stressed words: {sorted(missing)}"
    )


def test_bold_words_are_found(
    book: dict[str, ModuleType], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (
        "A **sliver cell** is flat.\n\n**Opens** a paragraph.\n- **entry**: of a list\n"
        "| **cell** | of a table |\n\n> **Theorem.** It is **not at all like it**, **3.1**, **$x$**; *a*."
    )
    chapter = small(tmp_path, book["chapters"], text)
    pieces = [(chapter, *piece) for piece in chapter.pieces()]
    monkeypatch.setattr(book["terms"], "pieces", lambda: pieces)
    assert [words for _, words in book["terms"].in_bold()] == ["sliver cell"]


# Index


def test_the_index(book: dict[str, ModuleType]) -> None:
    entries = book["terms"].entries()
    kinds = {
        kind: [e.name for e in entries if e.kind == kind] for kind in ("term", "person", "function", "other")
    }
    assert len(entries) >= 250 and all(len(names) >= 50 for names in kinds.values())
    names = [entry.name for entry in entries]
    assert len({(entry.name, entry.kind) for entry in entries}) == len(names)
    assert {"Rebay, S.", "sliver", "voronoi_segment", "terrain"} <= set(names)
    authors = {name for work, cited in book["works"].places().items() if cited for name in work.authors}
    assert set(kinds["person"]) == authors
    text = shown("index-of-terms")
    assert text.count("<li>") == len(entries)
    for entry in entries:
        assert f"<li>{entry.shown}: " in text, entry.name
        assert book["terms"].places(entry) or entry.see in names, f"{entry.name}: no place"


# Map, ways, lectures


def test_every_chapter_is_on_the_map(book: dict[str, ModuleType]) -> None:
    maps, chapters = book["maps"], book["chapters"].chapters()
    numbers = [chapter.number for chapter in chapters]
    known = {row["number"]: row for row in maps.data()["chapter"]}
    assert set(numbers) <= set(known), f"not in chapters.toml: {sorted(set(numbers) - set(known))}"
    assert set(known) - set(numbers) <= {"2.2", "2.2a", "2.2b"}, "rows of chapters that are gone"
    rows = maps.depth()
    places = {(card["column"], rows[chapter.number]) for chapter, card in maps.cards()}
    assert len(places) == len(chapters), "two boxes in one place"
    for chapter, card in maps.cards():
        assert card["reading"] in (1, 2) and card["question"].endswith("?"), chapter.number
        assert maps.all_named(card["needs"]) or chapter.number == "1"
        assert 10 <= maps.minutes(chapter) <= 180, f"{chapter.number}: {maps.minutes(chapter)} minutes"


def test_what_a_chapter_needs_is_on_the_map(book: dict[str, ModuleType]) -> None:
    """A chapter of which the first cell says "You need ..." is below those that it links to first."""
    maps, rows = book["maps"], book["maps"].depth()
    by_file = {chapter.file: chapter.number for chapter in book["chapters"].chapters()}

    def before(number: str) -> set[str]:
        needs = {need.number for name in [number] for need in maps.all_named(cards[name]["needs"])}
        return needs.union(*(before(need) for need in needs))

    cards = {chapter.number: card for chapter, card in maps.cards()}
    for chapter, _ in maps.cards():
        said = re.search(r"You need (.*?)[.]\s", chapter.texts[0] + " ", flags=re.S)
        if said:
            link = re.search(r"\]\(([\w.-]+\.ipynb)", said[1])
            assert link and by_file[link[1]] in before(chapter.number), f"{chapter.number} needs {said[1]}"
    assert max(rows.values()) >= 5


def test_ways_and_lectures(book: dict[str, ModuleType]) -> None:
    maps = book["maps"]
    lectures, paths = maps.data()["lecture"], maps.data()["path"]
    assert len(lectures) == 12 and len(paths) == 2
    seen: list[str] = []
    for lecture in lectures:
        some = maps.all_named(lecture["chapters"])
        assert some, lecture["title"]
        seen += [chapter.number for chapter in some]
    assert len(set(seen)) == len(seen), "a chapter in two lectures"
    for row in paths:
        assert all(maps.named(number) for number in row["chapters"])
        assert all((BOOK / f"{page}.ipynb").is_file() for page in row["pages"])
    front = shown("index")
    for chapter, card in maps.cards():
        assert f"[{chapter.number} {chapter.title}]({chapter.file})<br>{card['question']}" in front
    first = notebook(BOOK / "index.ipynb").cells[0].source
    assert "Liseikin" in first and "Springer" in first and "chapter 12" in first


def test_questions_have_folded_solutions() -> None:
    texts = [c.source for c in notebook(BOOK / "teaching.ipynb").cells if c.cell_type == "markdown"]
    questions = [text for text in texts if text.startswith("### Question")]
    assert len(questions) >= 12
    for number, text in enumerate(questions, start=1):
        assert re.match(rf"### Question {number}: .* \(\d+ minutes(?:, open)?\)\n", text)
        solution = re.search(
            r"^<details><summary>Solution</summary>\n\n(.+)\n\n</details>", text, re.M | re.S
        )
        assert solution and len(solution[1].split()) >= 15, text[:60]
    assert sum("prove" in text.lower() for text in questions) >= 3
    assert sum("find the bug" in text.lower() for text in questions) >= 1


def test_links_lead_to_headings_and_anchors() -> None:
    """In the notebooks; on the website the test of dead links sees them."""
    for page in PAGES:
        text = shown(page)
        links = re.findall(r'(?:href="|\]\()([\w.-]+\.ipynb)(?:#([^")]+))?', text)
        assert len(links) > 40
        for file, target in set(links):
            assert (BOOK / file).is_file(), file
            if target and not target.startswith("term-"):
                whole = "\n".join(c.source for c in notebook(BOOK / file).cells if c.cell_type == "markdown")
                title = re.escape(target.replace("&#x27;", "'")).replace("\\-", "[- ]")
                assert re.search(rf'^#+ +{title}$|<a id="{title}"', whole, flags=re.M), (
                    f"{page}: {file}#{target}"
                )


@pytest.mark.parametrize("path", sorted(BOOK.glob("*.ipynb")), ids=lambda path: path.stem.split("-")[0])
def test_links_in_the_text_lead_to_headings_and_anchors(path: Path) -> None:
    """Written as JupyterLab wants them, with capitals; the website's slugs are made from these."""
    for cell in notebook(path).cells:
        if cell.cell_type == "markdown":
            for file, target in re.findall(r"\]\(([\w.-]+\.ipynb)?#([^)\s]+)\)", cell.source):
                where = BOOK / (file or path.name)
                texts = "\n".join(c.source for c in notebook(where).cells if c.cell_type == "markdown")
                titles = {
                    title.replace(" ", "-") for title in re.findall(r"^#+ +(.*?)\s*$", texts, flags=re.M)
                }
                assert target in titles or f'<a id="{target}"' in texts, f"{cell.id}: {where.name}#{target}"
