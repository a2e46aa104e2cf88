"""Lint, types, and the rules of the house: floors, no Qhull, docstrings, words that must not appear."""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import pytest
from book_files import ROOT, tracked

import unstruct

PACKAGE = ROOT / "unstruct"
MODULES = sorted(PACKAGE.rglob("*.py"))
# A module imports, at its top, only from its own floor or from floors below.
FLOORS = {
    **dict.fromkeys(["errors", "jit", "progress"], 0),
    **dict.fromkeys(["arrays", "edge_vectors", "close", "curves", "elementary", "exact", "filters"], 1),
    **dict.fromkeys(["simplex", "topology", "ordering", "report"], 1),
    **dict.fromkeys(["cells", "marked_edges", "predicates"], 2),
    **dict.fromkeys(["mesh", "measures", "card", "files", "locate", "embedding", "manifold"], 3),
    **dict.fromkeys(["gmsh_files", "segment_pairs", "signs", "sweep"], 3),
    **dict.fromkeys(
        ["domain_constructors", "domain_corners", "domain_faults", "domain_files", "domain_input"], 4
    ),
    **dict.fromkeys(["domain_inside", "domain_repair", "domain_sample", "domain_shapes"], 4),
    **dict.fromkeys(["domain", "sizing", "distance", "statistics"], 4),
    **dict.fromkeys(
        [f"size_{kind}" for kind in "background boundary field limit solution sources table".split()], 4
    ),
    **dict.fromkeys(["check", "check_brute", "check_cells", "check_domain", "curve_distance"], 4),
    "delaunay": 5,
    **dict.fromkeys(["example_regions", "examples", "structured", "point_sets"], 6),
    "view": 7,
}


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", *command], cwd=ROOT, capture_output=True, text=True)


def relative(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def test_lint() -> None:
    result = run("ruff", "check", "--no-cache", ".")
    assert result.returncode == 0, result.stdout + result.stderr


def test_format() -> None:
    result = run("ruff", "format", "--no-cache", "--check", ".")
    assert result.returncode == 0, result.stdout + result.stderr


def test_types() -> None:
    result = run("mypy")
    assert result.returncode == 0, result.stdout + result.stderr


def imports(path: Path, *, top_level: bool) -> set[str]:
    """Absolute names of the modules that a file of the package imports."""
    package = path.relative_to(ROOT).with_suffix("").parts[:-1]
    tree = ast.parse(path.read_text(encoding="utf-8"))
    nodes = list(ast.walk(tree))
    if top_level:
        nodes = [
            n for n in nodes if getattr(n, "col_offset", 1) == 0
        ]  # in functions and under TYPE_CHECKING: free
    names = {alias.name for n in nodes if isinstance(n, ast.Import) for alias in n.names}
    for node in nodes:
        if isinstance(node, ast.ImportFrom):
            base = ".".join(package[: len(package) + 1 - node.level]) if node.level else ""
            base = ".".join(part for part in (base, node.module or "") if part)
            names |= {f"{base}.{alias.name}" for alias in node.names} | {base}
    return names


def test_no_qhull() -> None:
    for path in MODULES:
        found = [name for name in imports(path, top_level=False) if re.match(r"scipy\.spatial\b", name)]
        forbidden = {"Delaunay", "ConvexHull", "Voronoi", "HalfspaceIntersection", "qhull", "_qhull"}
        assert not forbidden & {part for name in found for part in name.split(".")}, (
            f"{relative(path)}: {found}"
        )
        source = path.read_text(encoding="utf-8")
        assert not re.search(r"spatial\.(Delaunay|ConvexHull|Voronoi)\(", source), relative(path)


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_imports_go_down(path: Path) -> None:
    own = path.relative_to(PACKAGE).with_suffix("").parts[0]
    inner = {name.split(".")[1] for name in imports(path, top_level=True) if name.startswith("unstruct.")}
    if own == "plain":  # the oracle shares nothing with what it judges
        assert inner <= {"plain", "errors"}, inner
    elif own != "__init__":
        assert own in FLOORS, f"give {own} a floor in this test"
        up = {name for name in inner if name == "plain" or FLOORS.get(name, 99) > FLOORS[own]}
        assert not up, f"imports upward: {up}"


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_sizes(path: Path) -> None:
    source = path.read_text(encoding="utf-8")
    assert len(source.splitlines()) <= 400
    limit = 30 if path.parent.name == "plain" else 80
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef):
            body = node.body
            if ast.get_docstring(node):  # a long account of shapes and errors is no long function
                body = body[1:]
            lines = body[-1].end_lineno - body[0].lineno + 1 if body else 0
            assert lines <= limit, f"{node.name} has {lines} lines"


def public() -> list[tuple[str, object]]:
    """The library's public face: what the package exports, and the exports of its public modules."""
    found = {f"unstruct.{name}": value for name, value in vars(unstruct).items() if name[0] != "_"}
    for info in pkgutil.walk_packages(unstruct.__path__, "unstruct."):
        module = importlib.import_module(info.name)
        for name in getattr(module, "__all__", []):
            found.setdefault(f"{info.name}.{name}", getattr(module, name))
    return [
        (name, value) for name, value in found.items() if inspect.isfunction(value) or inspect.isclass(value)
    ]


PUBLIC = [pytest.param(name, value, id=name) for name, value in public()]
FACE = [p for p in PUBLIC if re.match(r"unstruct\.((predicates|simplex|view)\.)?\w+$", p.id)]


@pytest.mark.parametrize(("name", "value"), PUBLIC)
def test_public_names_are_documented(name: str, value: object) -> None:
    assert inspect.getdoc(value), f"{name} has no docstring"
    if inspect.isclass(value):
        for member, method in vars(value).items():
            if member[0] != "_" and (inspect.isfunction(method) or isinstance(method, property)):
                assert inspect.getdoc(method), f"{name}.{member} has no docstring"


@pytest.mark.parametrize(("name", "value"), FACE)
def test_the_face_is_documented_in_full(name: str, value: object) -> None:
    if inspect.isfunction(value):
        text, signature = inspect.getdoc(value) or "", inspect.signature(value)
        if signature.parameters:
            assert re.search(r"^Parameters\n-{10}$", text, flags=re.M), f"{name}: no Parameters"
            for parameter in signature.parameters:
                assert re.search(rf"^.*\b{parameter}\b.* : ", text, flags=re.M), (
                    f"{name}: {parameter} not explained"
                )
        if signature.return_annotation not in (None, "None"):
            assert re.search(r"^Returns\n-{7}$", text, flags=re.M), f"{name}: no Returns"


@pytest.mark.parametrize(("name", "value"), PUBLIC)
def test_public_functions_have_types(name: str, value: object) -> None:
    if inspect.isfunction(value):
        signature = inspect.signature(value)
        bare = [p.name for p in signature.parameters.values() if p.annotation is p.empty]
        assert not bare and signature.return_annotation is not signature.empty, (
            f"{name}: {bare or 'return'} untyped"
        )


def test_words_that_do_not_belong_here() -> None:
    # Written so that this file does not contain them itself.
    halves = "/wor-k/ /tm-p/ /hom-e/ /roo-t/ /op-t/ pypi.o-rg npmjs-. pythonhos-ted TO-DO FIX-ME local-host:"
    halves += " DESIGN-.md BOOK-.md CLAIMS-.md BRIEF-.md"
    words = [half.replace("-", "") for half in halves.split()] + ["index" + "-url"]
    found = []
    for path in tracked():
        if path.suffix not in (".png", ".csv", ".npz"):
            text = path.read_text(encoding="utf-8")
            text = re.sub(r'"image/png": "[^"]*"', "", text)  # base64 spells any short word sooner or later
            found += [f"{relative(path)}: {word}" for word in words if word in text]
    assert not found, "\n".join(found)


def test_no_test_is_left_out() -> None:
    files = {path.name: path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*.py")}
    tests = {name: text for name, text in files.items() if name.startswith("test_")}
    for name, text in tests.items():
        assert re.search(r"^(def|class) [tT]est", text, flags=re.M), f"{name} holds no test"
    for name in set(files) - set(tests) - {"__init__.py", "conftest.py"}:
        assert not re.search(r"^def test_", files[name], flags=re.M), f"{name} is not collected"
        stem = name.removesuffix(".py")
        assert any(re.search(rf"\bimport.*\b{stem}\b|from (tests\.)?{stem}\b", t) for t in tests.values()), (
            f"{name} is unused"
        )


def test_no_module_is_beyond_the_tests() -> None:
    """Each is imported by a test, or by a module that is."""
    parts = {path: path.relative_to(ROOT).with_suffix("").parts for path in MODULES}
    dotted = {path: ".".join(part for part in names if part != "__init__") for path, names in parts.items()}
    tests = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").glob("test_*.py"))
    reached, fresh = set(), [PACKAGE / "__init__.py"]
    for path, name in dotted.items():
        parent, _, stem = name.rpartition(".")
        if re.search(rf"{re.escape(name)}\b|from {re.escape(parent)} import[^\n]*\b{stem}\b", tests):
            fresh.append(path)
    while fresh:
        path = fresh.pop()
        reached.add(path)
        inner = imports(path, top_level=False)
        fresh += [other for other, name in dotted.items() if name in inner and other not in reached]
    left = [name for path, name in dotted.items() if path not in reached and path.read_text().strip()]
    assert not left, f"no test reaches {left}"
