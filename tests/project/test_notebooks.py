"""Every notebook is stored executed, clean and within its limits; every chapter has all its parts.

nbval, which runs the notebooks, passes one whose outputs were stripped, and does not compare
pictures: so what is stored is checked here.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
import tomllib
from itertools import pairwise
from pathlib import Path

import pytest
from book_files import ROOT, chapters, code_cells, headings, notebook, notebooks, tags

import unstruct

ALL = [pytest.param(path, id=path.stem) for path in notebooks()]
HOW_TO = (
    "geojson-to-gmsh",
    "airfoil-to-su2",
    "boundary-conditions",
    "sizes",
    "refine-again",
    "three-dimensions",
    "mesh-a-body",
    "heat-in-a-body",
)
# beside the pages, whose cells import them
MODULES = ("chapters.py", "claims.py", "maps.py", "terms.py", "works.py")
METHOD_CHAPTERS = [
    pytest.param(path, id=path.stem) for path in chapters() if re.match(r"\d+[.a-z]", path.name)
]
WIDGET = "application/vnd.jupyter.widget-view+json"
PICTURES = ("image/png", "image/svg+xml", "image/jpeg")
# "In earnest" is what chapters call their real regions until they are rewritten.
REAL = "real regions|in earnest"
PARTS = ("predict", "by hand", "algorithm", "theorem", "break", REAL, "exercises", "sources")
FOLDED = {"hide-cell", "hide-input"}


def restored(path: Path) -> str:
    """For a notebook that `book/execute.py` did not store: often one was only read."""
    return (
        f"{path.name} is not as book/execute.py stores it. If you have run or saved it in JupyterLab, "
        f"`git restore book/{path.name}` brings it back (and `python book/read.py` opens a copy to read); "
        f"if you have edited it, run `python book/execute.py {path.stem}`."
    )


def has_picture(cell) -> bool:
    """Whether a cell shows a picture; a widget brings its own text and a still picture of itself."""
    shown = [output.get("data", {}) for output in cell.outputs]
    return any(kind in data for data in shown if WIDGET not in data for kind in PICTURES)


def without_magics(source: str) -> str:
    return "\n".join(line for line in source.splitlines() if not line.startswith(("%", "!")))


def must_show(source: str) -> bool:
    """Whether a cell certainly has an output: it prints, shows a picture, or ends with a name."""
    statements = ast.parse(without_magics(source)).body
    calls = [s.value for s in statements if isinstance(s, ast.Expr) and isinstance(s.value, ast.Call)]
    shown = {"print", "plt.show", "display"} & {ast.unparse(call.func) for call in calls}
    last_is_name = bool(statements) and isinstance(statements[-1], ast.Expr)
    last_is_name = last_is_name and isinstance(statements[-1].value, ast.Name | ast.Attribute | ast.Tuple)
    return bool(shown) or (last_is_name and not source.rstrip().endswith(";"))


def test_there_is_a_book() -> None:
    names = {path.stem for path in notebooks()}
    pages = {"index", "ledger", "errata", "references", "reference", "benchmarks", "teaching"}
    pages |= {"theorems", "glossary", "index-of-terms"}
    pages |= {f"benchmarks-{what}" for what in ("planar", "front", "volume")}
    pages |= {f"howto-{task}" for task in HOW_TO}
    assert pages <= names, f"missing pages: {sorted(pages - names)}"
    for section in (
        "1-",
        *(f"2.{n}-" for n in ("0", "1", "2a", "2b", "3", "4a", "4b", "5", "6a", "6b", "6c", "6d", "7", "8a")),
        "2.8c-",
        "2.8d-",
        *(f"3.{n}-" for n in ("1", "2", "3", "4", "5")),
        "4a-",
        "4b-",
        "4c-",
        "5-",
    ):
        assert any(name.startswith(section) for name in names), f"no chapter {section.rstrip('-')}"


@pytest.mark.parametrize("path", ALL)
def test_stored_executed(path: Path) -> None:
    cells = code_cells(path)
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1)), restored(path)
    for cell in cells:
        for output in cell.outputs:
            assert output.output_type != "error", f"{cell.id} stores an error"
            assert output.get("name") != "stderr", (
                f"{cell.id} writes to stderr: {output.get('text', '')[:200]}"
            )
        if must_show(cell.source):
            assert cell.outputs, f"{cell.id} shows something, but its output is not stored"
        if re.search(r"^plt\.show\(\)", cell.source, flags=re.M):
            assert has_picture(cell), f"{cell.id} shows a picture that is not stored"


@pytest.mark.parametrize("path", ALL)
def test_metadata_is_clean(path: Path) -> None:
    assert set(notebook(path).metadata) == {"kernelspec"}, restored(path)
    assert notebook(path).metadata.kernelspec.name == "python3"
    for number, cell in enumerate(notebook(path).cells):
        assert cell.id == f"c{number:03d}", restored(path)
        assert set(cell.metadata) <= {"tags", "mystnb", "jupyter"}, restored(path)
        for output in cell.get("outputs", []):
            allowed = {"widget"} if WIDGET in output.get("data", {}) else set()
            stored = set(output.get("metadata", {}))
            assert stored == allowed, restored(path)


@pytest.mark.parametrize("path", ALL)
def test_limits(path: Path) -> None:
    cells = notebook(path).cells
    prose = [cell.source for cell in cells if cell.cell_type == "markdown"]
    read = [re.sub(r"<details.*?</details>", "", source, flags=re.DOTALL) for source in prose]
    figures = sum(has_picture(cell) for cell in code_cells(path))
    assert len(cells) <= 130
    assert sum(len(source.split()) for source in read) <= 6000  # what is open when one reads on
    assert sum(len(source.split()) for source in prose) <= 6600  # with proofs for a second reading, solutions
    assert figures <= 30
    assert path.stat().st_size <= 4_000_000
    for cell in code_cells(path):
        lines = len(cell.source.splitlines())
        assert lines <= (60 if FOLDED & set(tags(cell)) else 30), f"{cell.id} has {lines} lines"
        assert bool(cell.metadata.get("jupyter")) == bool(FOLDED & set(tags(cell))), restored(path)


@pytest.mark.parametrize("path", [p for p in ALL if p.id.startswith("howto-")])
def test_how_to_pages_are_short_and_say_what_they_are_for(path: Path) -> None:
    """One task, a picture, numbers that are asserted; no files but in temporary folders."""
    cells = notebook(path).cells
    assert len(cells) <= 15
    assert re.match(r"# How .*\n\n\*\*Task\.\*\* ", cells[0].source)
    assert any(has_picture(cell) for cell in code_cells(path))
    code = "\n".join(cell.source for cell in code_cells(path))
    assert len(re.findall(r"^\s*assert\b", code, flags=re.M)) >= 3
    if re.search(r"\.write(_text)?\(", code):
        assert "TemporaryDirectory" in code


@pytest.mark.parametrize("path", ALL)
def test_few_outputs_are_ignored_and_those_assert(path: Path) -> None:
    ignored = [cell for cell in code_cells(path) if "nbval-ignore-output" in tags(cell)]
    assert len(ignored) <= max(1, 0.15 * len(code_cells(path))), [cell.id for cell in ignored]
    for cell in ignored:
        assert re.search(r"^\s*assert\b", cell.source, flags=re.M), (
            f"{cell.id}: ignored by nbval, asserts nothing"
        )
    for cell in code_cells(path):
        others = {"nbval-skip", "skip-execution", "nbval-raises-exception", "raises-exception"} & set(
            tags(cell)
        )
        assert not others, f"{cell.id}: {others}"
        assert not re.search(r"#\s*NBVAL_", cell.source), f"{cell.id}: a comment that steers nbval"


@pytest.mark.parametrize("path", ALL)
def test_every_picture_has_a_text(path: Path) -> None:
    for cell in code_cells(path):
        if has_picture(cell):
            alt = cell.metadata.get("mystnb", {}).get("image", {}).get("alt", "")
            assert len(alt) >= 20, f"{cell.id}: a picture without alt text"
    for cell in notebook(path).cells:
        if cell.cell_type == "markdown":
            assert "![](" not in cell.source and "<img" not in cell.source, (
                f"{cell.id}: a picture without alt text"
            )


@pytest.mark.parametrize("path", ALL)
def test_every_widget_has_a_still_picture(path: Path) -> None:
    for cell in code_cells(path):
        for output in cell.outputs:
            if WIDGET in output.get("data", {}):
                assert "image/png" in output.data, f"{cell.id}: a line of text until the cell has run"


@pytest.mark.parametrize("path", ALL)
def test_headings(path: Path) -> None:
    levels = [level for level, _ in headings(path)]
    assert levels and levels[0] == 1 and levels.count(1) == 1, "one title, and it comes first"
    assert all(after <= before + 1 for before, after in pairwise(levels)), "a level is jumped"
    for cell in notebook(path).cells:
        if cell.cell_type == "markdown":
            for target in re.findall(r"\]\(([^)#:]+\.(?:ipynb|md|py|toml|cfg))(?:#[^)]*)?\)", cell.source):
                assert (path.parent / target).is_file(), f"{cell.id}: link to {target}, which does not exist"


@pytest.mark.parametrize("path", METHOD_CHAPTERS)
def test_method_chapters_have_all_parts(path: Path) -> None:
    second = [title.lower() for level, title in headings(path) if level == 2]
    missing = [part for part in PARTS if not any(re.search(part, title) for title in second)]
    assert not missing, f"no section on {missing} in {second}"


@pytest.mark.parametrize("path", METHOD_CHAPTERS)
def test_exercises_have_folded_executed_solutions(path: Path) -> None:
    numbers, solved = [], {}
    for cell in notebook(path).cells:
        if cell.cell_type == "markdown":
            numbers += [int(n) for n in re.findall(r"^###\s+Exercise (\d+)", cell.source, flags=re.M)]
        elif numbers and FOLDED & set(tags(cell)):
            solved[numbers[-1]] = cell.execution_count
    assert numbers == list(range(1, len(numbers) + 1)) and 4 <= len(numbers) <= 8, numbers
    assert sorted(solved) == numbers, f"without a folded solution: {sorted(set(numbers) - set(solved))}"


@pytest.mark.parametrize("path", ALL)
def test_notebooks_need_only_what_the_book_installs(path: Path) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    names = [*project["dependencies"], *extras["book"]]
    for name in extras["book"]:  # extras of the library's own stand for their packages
        for extra in re.findall(r"\w+", name.removeprefix("unstruct[")) if "unstruct[" in name else ():
            names += extras[extra]
    installed = {re.split(r"[<>=\[ ]", name)[0].replace("-", "_") for name in names}
    installed = {{"scikit_fem": "skfem"}.get(name, name) for name in installed}  # imported by another name
    allowed = installed | set(sys.stdlib_module_names)
    allowed |= {"unstruct", "benchmarks", "IPython", "mpl_toolkits", "traitlets"}
    allowed |= {name.removesuffix(".py") for name in MODULES}
    for cell in code_cells(path):
        for node in ast.walk(ast.parse(without_magics(cell.source))):
            modules = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            modules += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert {m.split(".")[0] for m in modules} <= allowed, f"{cell.id} imports {modules}"


NAMESPACES = {"predicates", "simplex", "topology", "sizing", "view", "plain", "examples", "studies"}


def library_names(tree: ast.AST, known: dict[str, str]) -> list[str]:
    """Absolute names of the library that code imports or reaches; ``known`` learns what its imports bind."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            pairs = [
                (alias.name, alias.asname or alias.name.split(".")[0], alias.asname) for alias in node.names
            ]
            known.update({bound: name if short else bound for name, bound, short in pairs})
            found += [name for name, _, _ in pairs]
        elif isinstance(node, ast.ImportFrom):
            pairs = [(f"{node.module}.{alias.name}", alias.asname or alias.name) for alias in node.names]
            known.update({bound: name for name, bound in pairs})
            found += [name for name, _ in pairs]
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and re.fullmatch(r"[\w.]+", text := ast.unparse(node)):
            root, _, rest = text.partition(".")
            found += [f"{known[root]}.{rest}"] if root in known else []
    return [name for name in found if name.startswith("unstruct.")]


@pytest.mark.parametrize("path", ALL)
def test_the_book_uses_the_face_alone(path: Path) -> None:
    """`unstruct`, its namespaces, the single algorithms in `plain`: no inner file, so that files can move."""
    known: dict[str, str] = {}
    for cell in code_cells(path):
        for name in library_names(ast.parse(without_magics(cell.source)), known):
            first, *rest = name.split(".")[1:]
            assert first in dir(unstruct) or first[:2] == "__", f"{cell.id}: {name} is not on the face"
            if first in NAMESPACES - {"plain"} and rest and rest[0][:2] != "__":
                space = getattr(unstruct, first)
                assert rest[0] in getattr(space, "__all__", dir(space)), f"{cell.id}: {name}"
                shown = not inspect.ismodule(getattr(space, rest[0])) or rest[0] in ("frames", "states")
                assert shown, f"{cell.id}: {name} is an inner file"
