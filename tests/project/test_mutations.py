"""Mutations fit their cells, claims of new chapters have some, and the runner tells red from green.

`python tests/mutations/mutate.py` runs them all; here one cheap one is run, and a small notebook of our own.
"""

from __future__ import annotations

import re
from pathlib import Path

import nbformat
import pytest
from book_files import CLAIM, NEW_CHAPTERS, code_cells, ledger, tags
from mutate import Mutation, Wrong, changed, code_of, files, read, run

FILES = [pytest.param(path, notebook, id=path.stem) for path, notebook in files()]
WITHOUT_MUTATION = {"historical", "unverified"}
CELLS = [
    "import inspect\nlimit = 3",
    "def f():\n    return limit",
    "%time\nassert f() <= 3\nlimit = 9",
    "assert limit == 9",
]


@pytest.mark.parametrize(("path", "notebook"), FILES)
def test_every_mutation_fits_its_cell(path: Path, notebook: Path) -> None:
    mutations = read(path)
    assert mutations and len(set(mutations)) == len(mutations)
    known = {row["id"] for row in ledger()}
    cells = code_of(notebook)
    for mutation in mutations:
        changed(mutation, cells)
        assert mutation.claim in known and len(mutation.why) >= 15, mutation


@pytest.mark.parametrize("notebook", NEW_CHAPTERS)
def test_every_claim_of_a_new_chapter_has_a_mutation(notebook: Path) -> None:
    path = Path(__file__).parents[1] / "mutations" / f"{notebook.stem.split('-')[0]}.toml"
    verdicts = {row["id"]: row["verdict"] for row in ledger()}
    claims = {tag for cell in code_cells(notebook) for tag in tags(cell) if CLAIM.fullmatch(tag)}
    claims = {name for name in claims if verdicts.get(name) not in WITHOUT_MUTATION}
    mutated = {mutation.claim for mutation in read(path)} if path.exists() else set()
    assert claims <= mutated, f"{path.name} has no mutation of {sorted(claims - mutated)}"


def test_a_cheap_one_is_red() -> None:
    """Of the first file: its mutations in the first cell that has some, run as the command runs them."""
    path, notebook = next(files())
    cells = code_of(notebook)
    first = min(changed(m, cells)[0] for m in read(path))
    results = list(run(notebook, [m for m in read(path) if changed(m, cells)[0] == first]))
    assert results and all(result.red for result in results), results


@pytest.fixture
def small(tmp_path: Path) -> Path:
    cells = [nbformat.v4.new_code_cell(source) for source in CELLS]
    cells[2].metadata["tags"], cells[3].metadata["tags"] = ["C12.9-01"], ["C12.9-02"]
    nbformat.write(nbformat.v4.new_notebook(cells=cells), tmp_path / "9-x.ipynb")
    return tmp_path / "9-x.ipynb"


def mutation(find: str, replace: str, claim: str = "C12.9-01", **more: str) -> Mutation:
    return Mutation(claim, find, replace, "a test of the runner", **more)


def test_red_green_and_other_errors_are_told_apart(small: Path) -> None:
    kinds = [
        mutation("f() <= 3", "f() <= 2"),
        mutation("f() <= 3", "f() <= 4"),
        mutation("f() <= 3", "g() <= 3"),
        mutation("f() <= 3", "g() <= 3", raises="NameError"),
        mutation("assert f() <= 3", "import os; os._exit(3)"),
        mutation("assert f() <= 3", "import sys; sys.exit(3)"),
        mutation("limit = 9", "limit = 8"),  # the next cell must not see this
        mutation("limit == 9", "'return limit' not in inspect.getsource(f)", claim="C12.9-02"),
    ]
    results = list(run(small, kinds))
    assert [result.red for result in results] == [True, False, False, True, False, False, False, True]
    assert [result.told for result in results] == [
        "AssertionError: ",
        "it passes",
        "NameError: name 'g' is not defined (not AssertionError)",
        "NameError: name 'g' is not defined",
        "the process ended",
        "SystemExit: 3 (not AssertionError)",
        "it passes",
        "AssertionError: ",
    ]


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (mutation("f() <= 4", "f()"), "'f() <= 4' stands 0 times in its cell"),
        (mutation("3", "4", claim="C12.9-03"), "C12.9-03: no cell has this tag"),
        (mutation("f()", "f()"), "'f()' is replaced by itself"),
        (mutation("i", "j"), "stands 3 times"),
        (mutation("f() <= 3", "f() <="), "makes no Python"),
    ],
)
def test_what_does_not_fit_is_named(small: Path, wrong: Mutation, said: str) -> None:
    with pytest.raises(Wrong, match=re.escape(said)):
        list(run(small, [wrong]))
