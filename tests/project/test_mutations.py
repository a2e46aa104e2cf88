"""Mutations fit their cells, claims have some, and the runner tells red from green.

`python tests/mutations/mutate.py --jobs 2` runs all; `test_mutations_*_half.py` run a tenth;
here small notebooks of our own are run.
"""

from __future__ import annotations

import re
from pathlib import Path

import nbformat
import pytest
from book_files import BOOK, CLAIM, ROOT, chapters, code_cells, ledger, tags
from mutate import Mutation, Wrong, changed, code_of, files, read, run, run_here, tenth
from mutated import FILES
from slices import needed

WITHOUT_MUTATION = {"historical", "unverified"}
CELLS = [
    "import inspect\nlimit = 3",
    "def f():\n    return limit",
    "%time\nassert f() <= 3\nlimit = 9",
    "assert limit == 9",
]


def mutations_of(notebook: Path) -> Path:
    return ROOT / "tests" / "mutations" / f"{notebook.stem.split('-')[0]}.toml"


def stored_text(notebook: Path) -> str:
    return "".join(output.get("text", "") for cell in code_cells(notebook) for output in cell.outputs)


@pytest.mark.parametrize(("path", "notebook"), FILES)
def test_every_mutation_fits_its_cell(path: Path, notebook: Path) -> None:
    mutations = read(path)
    assert mutations and len(set(mutations)) == len(mutations)
    known = {row["id"] for row in ledger()}
    cells = code_of(notebook)
    for mutation in mutations:
        changed(mutation, cells)
        assert mutation.claim in known and len(mutation.why) >= 15, mutation


@pytest.mark.parametrize("notebook", chapters())
def test_every_claim_of_a_chapter_has_a_mutation(notebook: Path) -> None:
    path = mutations_of(notebook)
    verdicts = {row["id"]: row["verdict"] for row in ledger()}
    claims = {tag for cell in code_cells(notebook) for tag in tags(cell) if CLAIM.fullmatch(tag)}
    claims = {name for name in claims if verdicts.get(name) not in WITHOUT_MUTATION}
    mutated = {mutation.claim for mutation in read(path)} if path.exists() else set()
    assert claims <= mutated, f"{path.name} has no mutation of {sorted(claims - mutated)}"


def test_the_tenth_is_a_tenth_and_hangs_on_each_mutation_alone() -> None:
    many = [mutation(f"{k} <= 3", "4", claim=f"C12.9-{k:02d}") for k in range(1, 61)]
    chosen = tenth(many)
    assert len(chosen) == 6 and tenth(many[::-1]) == chosen[::-1]
    others = [m for m in many if m not in chosen]
    assert set(tenth([*chosen, *others[:-1]])) <= {*chosen}
    assert len(tenth(many[:4])) == 1 and len(tenth(many[:16])) == 2
    assert max(chosen, key=many.index) not in many[:6], "not the first ones"


def test_rows_without_a_mutation() -> None:
    """Only rows that need no cell may be without; the ledger counts them."""
    mutated = {mutation.claim for path, _ in files() for mutation in read(path)}
    bare = {row["id"] for row in ledger() if row["verdict"] not in WITHOUT_MUTATION} - mutated
    assert not bare, f"no mutation: {sorted(bare)}"
    (printed,) = re.findall(r"^(\d+) rows have no mutation", stored_text(BOOK / "ledger.ipynb"), flags=re.M)
    assert int(printed) == len(bare), "run book/execute.py ledger"


SLICED = [
    "a = [1]",
    "b = 2",
    "import os\na.append(3)",
    "c = [b for a in (1, 2)]",
    "def f():\n    return a",
    "f()",
]


def test_a_slice_has_what_binds_and_changes_names() -> None:
    assert needed(SLICED, [5]) == {0, 2, 4, 5}
    assert needed(SLICED, [3]) == {0, 1, 2, 3}  # a name of a comprehension counts as used
    assert needed([*SLICED, "os.path.exists('')", "os.sep"], [7]) == {0, 2, 7}
    assert needed(SLICED, []) == set()


def test_where_a_slice_is_not_enough_all_cells_run(tmp_path: Path) -> None:
    """What a function does to its arguments is not seen."""
    cells = ["a = []", "def put(x):\n    x.append(1)", "put(a)", "assert a == [1]"]
    made = [nbformat.v4.new_code_cell(source) for source in cells]
    made[3].metadata["tags"] = ["C12.9-01"]
    path = tmp_path / "9-x.ipynb"
    nbformat.write(nbformat.v4.new_notebook(cells=made), path)
    kinds = [mutation("a == [1]", "a == [2]"), mutation("a == [1]", "a")]
    with pytest.raises(Wrong, match="unchanged: AssertionError"):
        list(run(path, kinds[:1], sliced=True))
    assert [result.red for result in run_here(path, kinds, sliced=True)] == [True, False]


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
