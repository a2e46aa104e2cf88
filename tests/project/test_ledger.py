"""The ledger and the notebooks hold each other: every claim has its cell, every tag its row."""

from __future__ import annotations

import ast
import re
from collections import Counter, defaultdict

from book_files import BOOK, CLAIM, code_cells, ledger, notebooks, tags

VERDICTS = {"true", "needs-assumption", "false", "extension", "misprint", "vague", "historical", "unverified"}
EVIDENCE = {"derived", "exact", "property-tested", "counterexample", "measured", "cited"}
WITHOUT_CELL = {"historical", "unverified"}
# For an extension "correct" says what the book adds to the statement of the source.
NEEDS_CORRECTION = {"needs-assumption", "false", "extension", "misprint", "vague"}


def cells_of_claims() -> dict[str, list[str]]:
    """For each claim id that is a tag somewhere: the places (notebook and cell) that carry it."""
    found = defaultdict(list)
    for path in notebooks():
        for cell in code_cells(path):
            for tag in filter(CLAIM.fullmatch, tags(cell)):
                found[tag].append(f"{path.name} {cell.id}")
    return found


def test_rows_are_well_formed() -> None:
    keys = {"id", "section", "statement", "verdict", "correct", "evidence"}
    wrong = []
    for row in ledger():
        name = row.get("id", "(no id)")
        if not CLAIM.fullmatch(name):
            wrong.append(f"{name}: not an id like C12.2-01")
        if unknown := set(row) - keys:
            wrong.append(f"{name}: unknown keys {sorted(unknown)}")
        if row.get("section") != name.removeprefix("C").split("-")[0]:
            wrong.append(f"{name}: section {row.get('section')!r}")
        if row.get("verdict") not in VERDICTS:
            wrong.append(f"{name}: verdict {row.get('verdict')!r}")
        if row.get("evidence") not in EVIDENCE:
            wrong.append(f"{name}: evidence {row.get('evidence')!r}")
        if len(row.get("statement", "")) < 15:
            wrong.append(f"{name}: no statement")
        if row.get("verdict") in NEEDS_CORRECTION and len(row.get("correct", "")) < 15:
            wrong.append(f"{name}: {row['verdict']}, but what is correct is not said")
    assert not wrong, "\n".join(wrong)


def test_ids_are_unique() -> None:
    twice = [name for name, count in Counter(row["id"] for row in ledger()).items() if count > 1]
    assert not twice, twice


def test_rows_of_a_section_are_numbered_without_gaps() -> None:
    """A row that is taken away leaves a gap, or, as the last one, a tag without a row (tested below)."""
    sections = defaultdict(list)
    for row in ledger():
        sections[row["section"]].append(int(row["id"].split("-")[1]))
    gaps = {
        section: sorted(set(range(1, max(found) + 1)) - set(found)) for section, found in sections.items()
    }
    assert not any(gaps.values()), {section: missing for section, missing in gaps.items() if missing}


def test_an_extension_is_not_listed_as_an_error() -> None:
    source = code_cells(BOOK / "errata.ipynb")[0].source
    (kinds,) = re.findall(r"^KINDS = (\(.+\))$", source, flags=re.M)
    assert set(ast.literal_eval(kinds)) == {"false", "misprint", "needs-assumption"}


def test_every_claim_has_its_cell() -> None:
    tagged = cells_of_claims()
    bare = [row["id"] for row in ledger() if row["verdict"] not in WITHOUT_CELL and row["id"] not in tagged]
    assert not bare, f"no cell carries {bare}"


def test_every_tag_is_a_row() -> None:
    known = {row["id"] for row in ledger()}
    loose = {name: places for name, places in cells_of_claims().items() if name not in known}
    assert not loose, loose
    every = {tag for path in notebooks() for cell in code_cells(path) for tag in tags(cell)}
    misspelled = [tag for tag in every if re.match(r"C\d", tag) and not CLAIM.fullmatch(tag)]
    assert not misspelled, misspelled


def test_a_claim_is_asserted_where_it_is_tagged() -> None:
    wrong = []
    for path in notebooks():
        for cell in code_cells(path):
            claims = [tag for tag in tags(cell) if CLAIM.fullmatch(tag)]
            if claims and not re.search(r"^\s*assert\b", cell.source, flags=re.M):
                wrong.append(f"{path.name} {cell.id} {claims}: no assert")
            if len(claims) > 3:
                wrong.append(f"{path.name} {cell.id} {claims}: more than three claims")
    assert not wrong, "\n".join(wrong)
