"""Lint, types, and the rules of the house: floors, no Qhull, docstrings, words that must not appear."""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import re
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest
from book_files import ROOT, tracked

import unstruct

PACKAGE = ROOT / "unstruct"
MODULES = sorted(PACKAGE.rglob("*.py"))
# From the ground up: a file imports only from its own place and from places before it in this list. Files
# that stand beside the sub-rooms of a room come after them, but for those that are named here. `plain`, the
# oracle, stands low because it needs errors alone; only views and chapters take from it.
HOUSE = """
base plain predicates geometry mesh
connect/insertion connect/planar connect/spatial connect/surface connect/voronoi connect/wrapping
connect/baker connect
sizing
domain/arguments domain/plane domain/space domain
generate/volume generate/boundary generate/volume_points generate/refinement generate/centers
generate/improve generate/rebay generate/bodies generate/surface generate/advancing
generate/space_front generate/front generate/layers generate/prisms
generate/quads generate/tree generate/tree_regions generate/stuffing generate/hexahedra generate/planting
generate/parallel
assess examples
view/draw view/scenes view/widgets view
command __main__
""".split()
FACES = {
    "__init__",
    "compile",
    "errors",
    "simplex",
    "topology",
    "studies",
}  # files beside the rooms: they hand on names
HAND_ON = {"unstruct", *(f"unstruct.{room}" for room in "predicates sizing examples view".split())}
DOORS = {
    "unstruct.view:plot_domain",
    "unstruct.connect.insertion.delaunay:delaunay",
    "unstruct.view:plot",
    "unstruct.view:plot_tree",
    "unstruct.view:plot_voronoi",
}
# Files that import what is asked for by its name: the face, doors, kernels to be compiled, optional packages.
DYNAMIC = {f"unstruct/{name}.py" for name in ("__init__", "base/doors", "base/jit", "base/optional")}
# Kernels take at most eight arguments, a record counting as one. The exceptions are predicates, which take
# coordinates as numbers; this list may only shrink.
ARGUMENTS = 8
COMPILED = ("kernel", "lean", "inline", "inline_with_arrays", "lending")  # the decorators of kernels
MORE_ARGUMENTS = {
    "predicates/filters:filter_insphere": 15,
    "predicates/filters:filter_orient3": 12,
    "predicates/fixed:fixed_orient3": 9,
    "predicates/kernels:insphere": 15,
    "predicates/kernels:orient3": 12,
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


def test_older_pages_are_as_wide_as_files() -> None:
    """What book/ruff.toml takes out of the narrow format, until it is rewritten."""
    excluded = tomllib.loads((ROOT / "book" / "ruff.toml").read_text(encoding="utf-8"))["format"]["exclude"]
    older = sorted({relative(path) for pattern in excluded for path in (ROOT / "book").glob(pattern)})
    for command in (["check", "--no-cache"], ["format", "--no-cache", "--check"]):
        result = run("ruff", *command, "--config", "pyproject.toml", *older)
        assert result.returncode == 0, result.stdout + result.stderr


def test_types() -> None:
    result = run("mypy")
    assert result.returncode == 0, result.stdout + result.stderr


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(part for part in parts if part != "__init__")


KNOWN_MODULES = {module_name(path) for path in MODULES}


@cache
def parsed(path: Path) -> ast.Module:
    """The tree of a file, made once for all tests."""
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def nodes_of(path: Path) -> list[ast.AST]:
    """All nodes of this tree."""
    return list(ast.walk(parsed(path)))


@cache
def imports(path: Path) -> set[str]:
    """Absolute names that a file of the package imports, wherever it does: in functions and for types too."""
    package = path.relative_to(ROOT).with_suffix("").parts[:-1]
    nodes = nodes_of(path)
    names = {alias.name for n in nodes if isinstance(n, ast.Import) for alias in n.names}
    for node in nodes:
        if isinstance(node, ast.ImportFrom):
            base = ".".join(package[: len(package) + 1 - node.level]) if node.level else ""
            base = ".".join(part for part in (base, node.module or "") if part)
            names |= {f"{base}.{alias.name}" for alias in node.names} | {base}
    return names


@cache
def inner_imports(path: Path) -> set[str]:
    """The modules of the package that a file imports, without the rooms on the way to them."""
    found = imports(path) & KNOWN_MODULES
    return {n for n in found if not any(o.startswith(f"{n}.") for o in found)} - {module_name(path)}


def floor(module: str) -> int:
    """The place of a module in the house: the longest entry that leads to it."""
    inner = module.removeprefix("unstruct.").replace(".", "/")
    fits = [place for place in HOUSE if inner == place or inner.startswith(f"{place}/")]
    assert fits, f"give {module} a place in the house"
    return HOUSE.index(max(fits, key=len))


def test_no_qhull() -> None:
    for path in MODULES:
        found = [name for name in imports(path) if re.match(r"scipy\.spatial\b", name)]
        forbidden = {"Delaunay", "ConvexHull", "Voronoi", "HalfspaceIntersection", "qhull", "_qhull"}
        assert not forbidden & {part for name in found for part in name.split(".")}, (
            f"{relative(path)}: {found}"
        )
        source = path.read_text(encoding="utf-8")
        assert not re.search(r"spatial\.(Delaunay|ConvexHull|Voronoi)\(", source), relative(path)


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_imports_go_down(path: Path) -> None:
    own = module_name(path)
    if own == "unstruct" or own.removeprefix("unstruct.") in FACES:
        return
    inner = inner_imports(path)
    faces = {name for name in inner if name.removeprefix("unstruct.") in FACES | {"unstruct"}}
    assert not faces, f"the house does not enter by its own door: {faces}"
    up = {name for name in inner if floor(name) > floor(own)}
    assert not up, f"imports upward: {up}"
    if own.startswith("unstruct.plain"):  # the oracle shares nothing with what it judges
        assert all(re.match(r"unstruct\.(plain\b|base\.errors$)", name) for name in inner), inner
    elif not own.startswith("unstruct.view"):
        assert not any(name.startswith("unstruct.plain") for name in inner), "judged by its oracle alone"


def test_no_circle() -> None:
    """Counting every import. Files without arrows to what is left are taken away until none is left."""
    left = {module_name(path): inner_imports(path) for path in MODULES}
    while free := [name for name, inner in left.items() if not inner & set(left)]:
        for name in free:
            del left[name]
    assert not left, f"files that import each other in a circle are among {sorted(left)}"


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_imports_stand_at_the_top(path: Path) -> None:
    """An import of the package's own inside a function is a door, and doors have a form of their own."""
    wrong = hidden_imports(parsed(path))
    if relative(path) in DYNAMIC:
        wrong = [text for text in wrong if "importlib" not in text]
    assert not wrong, wrong


def hidden_imports(tree: ast.Module) -> list[str]:
    """Imports of the package in functions or under conditions, and ways to import what has no fixed name."""
    top, found = {id(node) for node in tree.body}, []
    for node in ast.walk(tree):
        names: list[str] = []
        if isinstance(node, ast.ImportFrom):
            names = ["unstruct"] if node.level else [node.module or ""]
            names = [] if names == ["importlib.metadata"] else names  # it imports nothing
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.Name) and node.id == "__import__":
            names = ["importlib"]
        for name in {name.split(".")[0] for name in names}:
            if name in ("importlib", "runpy") or (name == "unstruct" and id(node) not in top):
                found.append(ast.unparse(node))
    return found


@pytest.mark.parametrize(
    "source",
    [
        "def f():\n    from ..view import plot",
        "def f():\n    import unstruct.view",
        "def f():\n    from unstruct.view import plot",
        "if TYPE_CHECKING:\n    from .mesh import Mesh",
        "import importlib",
        "from importlib import import_module as find",
        "view = __import__('unstruct.view')",
    ],
)
def test_hidden_imports_are_found(source: str) -> None:
    assert hidden_imports(ast.parse(source))


def test_doors() -> None:
    """All doors are listed here, and each of them opens."""
    found = {}
    for path in MODULES:
        for node in nodes_of(path):
            if isinstance(node, ast.Call) and called(node.func) == "door":
                found[ast.literal_eval(node.args[0])] = relative(path)
            elif isinstance(node, ast.ImportFrom):
                renamed = [a.asname for a in node.names if a.name in ("door", *COMPILED) and a.asname]
                assert not renamed, f"{relative(path)} hides what it calls: {renamed}"
    assert set(found) == DOORS, found
    for target in DOORS:
        module, _, name = target.partition(":")
        assert callable(getattr(importlib.import_module(module), name))


def test_rooms_say_what_they_are() -> None:
    """Each room has one sentence; only the faces hand on names."""
    for path in MODULES:
        if path.name == "__init__.py":
            tree = parsed(path)
            assert ast.get_docstring(tree), f"{relative(path)} does not say what the room is for"
            if module_name(path) not in HAND_ON:
                assert len(tree.body) == 1, f"{relative(path)} holds more than its sentence"


def test_private_names_stay_in_their_file() -> None:
    for path in MODULES:
        for node in nodes_of(path):
            if isinstance(node, ast.ImportFrom) and node.level and path != PACKAGE / "__init__.py":
                private = [
                    alias.name for alias in node.names if alias.name[0] == "_" and alias.name[1] != "_"
                ]
                assert not private, f"{relative(path)} imports {private}"


def test_nothing_at_the_top_is_called_like_a_public_function() -> None:
    places = {path.stem for path in PACKAGE.iterdir()}
    functions = {name for name, value in vars(unstruct).items() if inspect.isfunction(value)}
    assert not places & functions


def test_the_face() -> None:
    shown = {name for name in dir(unstruct) if name[0] != "_"}
    assert set(unstruct.__all__) <= shown
    given = {name for name, value in vars(unstruct).items() if name[0] != "_" and callable(value)}
    assert given <= set(unstruct.__all__), f"imported, but not in __all__: {given - set(unstruct.__all__)}"
    for name in shown:
        assert getattr(unstruct, name) is not None
    assert not {name for name in shown if inspect.ismodule(getattr(unstruct, name))} - {
        *"errors examples plain predicates simplex sizing studies topology view".split()
    }


def test_names_of_earlier_versions_resolve() -> None:
    for name in unstruct._MOVED:
        with pytest.warns(DeprecationWarning, match=rf"unstruct\.{name} is now unstruct\.\w+") as told:
            value = getattr(unstruct, name)
        assert value is not None and len(told) == 1
        here = re.search(r"is now (\S+)", str(told[0].message)).group(1)
        parent, _, leaf = here.rpartition(".")
        assert getattr(importlib.import_module(parent), leaf) is value
        assert name not in dir(unstruct)
    with pytest.raises(AttributeError, match="no attribute 'no_such_name'"):
        _ = unstruct.no_such_name


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_sizes(path: Path) -> None:
    source = path.read_text(encoding="utf-8")
    assert len(source.splitlines()) <= 400
    limit = 30 if path.parent.name == "plain" else 80
    for node in nodes_of(path):
        if isinstance(node, ast.FunctionDef):
            body = node.body
            if ast.get_docstring(node):  # a long account of shapes and errors is no long function
                body = body[1:]
            lines = body[-1].end_lineno - body[0].lineno + 1 if body else 0
            assert lines <= limit, f"{node.name} has {lines} lines"


def called(node: ast.expr) -> str:
    """The last name of what is called, or of what decorates: "door" for `door`, `doors.door`, `door(...)`."""
    if isinstance(node, ast.Call):
        return called(node.func)
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def kernels(tree: ast.Module) -> list[tuple[str, int]]:
    """Names of the kernels in a file, and how many arguments they take, however those are given."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and any(called(d) in COMPILED for d in node.decorator_list):
            a = node.args
            count = len(a.posonlyargs + a.args + a.kwonlyargs) + (9 if a.vararg or a.kwarg else 0)
            found.append((node.name, count))
    return found


def compiled_otherwise(tree: ast.Module) -> list[str]:
    """Kernels that are made without the decorator, and other ways to numba."""
    found = []
    decorators = {id(d) for n in ast.walk(tree) if isinstance(n, ast.FunctionDef) for d in n.decorator_list}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else [node.module or ""]
            if any(name.split(".")[0] == "numba" for name in names):
                found.append(ast.unparse(node))
        elif isinstance(node, ast.Name | ast.Attribute) and called(node) in COMPILED:
            if id(node) not in decorators:
                found.append(ast.unparse(node))
    return found


INSIDE = ("inside_builtins", "inside_libraries", "inside_numba")  # what is used of numba's inside


def test_kernels_are_decorated() -> None:
    """A kernel that another function makes would not be cached, and its arguments would not be counted."""
    for path in MODULES:
        if path.parent != PACKAGE / "base" or path.stem not in (*INSIDE, "jit", "kernel_cache"):
            found = compiled_otherwise(parsed(path))
            assert not found, f"{relative(path)}: {found}"
    nine = "a, b, c, d, /, e, f, g, *, h, i"
    for source in (
        f"@kernel\ndef f({nine}): ...",
        f"@jit.lean\ndef f({nine}): ...",
        "@inline\ndef f(*x): ...",
    ):
        assert kernels(ast.parse(source))[0][1] > ARGUMENTS
    for source in ("g = kernel(partial(f, 1))", "from numba import njit", "make = jit.kernel"):
        assert compiled_otherwise(ast.parse(source))


def test_kernels_take_records() -> None:
    found = {}
    for path in MODULES:
        place = path.relative_to(PACKAGE).with_suffix("").as_posix()
        found |= {f"{place}:{name}": n for name, n in kernels(parsed(path)) if n > ARGUMENTS}
    more = {name: count for name, count in found.items() if count > MORE_ARGUMENTS.get(name, ARGUMENTS)}
    assert not more, f"hand these a record (a NamedTuple of arrays): {more}"
    gone = {name: found.get(name, 0) for name in MORE_ARGUMENTS if found.get(name) != MORE_ARGUMENTS[name]}
    assert not gone, f"these take fewer now: lower their numbers, or take them from the list: {gone}"


def assigned(path: Path) -> set[str]:
    """The constants of a file: names in capitals that are assigned at its top."""
    found: set[str] = set()
    for node in parsed(path).body:
        targets = node.targets if isinstance(node, ast.Assign) else []
        if isinstance(node, ast.AnnAssign):
            targets = [node.target]
        for target in targets:
            names = target.elts if isinstance(target, ast.Tuple) else [target]
            found |= {
                n.id for n in names if isinstance(n, ast.Name) and re.fullmatch(r"[A-Z][A-Z0-9_]*", n.id)
            }
    return found


def test_a_constant_has_one_meaning() -> None:
    """What means the same is imported from one place; what does not, has another name."""
    places: dict[str, list[str]] = {}
    for path in MODULES:
        if path.parent != PACKAGE / "plain":  # the oracle shares nothing with what it judges
            for name in assigned(path):
                places.setdefault(name, []).append(relative(path))
    twice = {name: found for name, found in places.items() if len(found) > 1}
    assert not twice, twice


def test_private_attributes_stay_in_their_file() -> None:
    """What another file reads has a public name; `jit` and `INSIDE` alone look into numba."""
    for path in MODULES:
        if path in [PACKAGE / "base" / f"{name}.py" for name in (*INSIDE, "jit")]:
            continue
        nodes = nodes_of(path)
        own = {node.name for node in nodes if isinstance(node, ast.FunctionDef)} | {"_replace"}
        read = set()
        for node in nodes:
            if isinstance(node, ast.Attribute) and re.match(r"_[a-z]", node.attr):
                if isinstance(node.value, ast.Name) and node.value.id in ("self", "cls"):
                    own.add(node.attr)
                else:
                    read.add(node.attr)
        assert not read - own, f"{relative(path)} reads {read - own}"


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
    files = {path: path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*.py")}
    tests = {path: text for path, text in files.items() if path.name.startswith("test_")}
    for path, text in tests.items():
        assert re.search(r"^(def|class) [tT]est", text, flags=re.M), f"{relative(path)} holds no test"
    for path in set(files) - set(tests):
        assert not re.search(r"^def test_", files[path], flags=re.M), f"{relative(path)} is not collected"
        if path.name != "conftest.py":
            uses = rf"\bimport.*\b{path.stem}\b|from (tests\.)?{path.stem}\b"
            assert any(re.search(uses, text) for text in tests.values()), f"{relative(path)} is unused"


def test_tests_mirror_the_rooms() -> None:
    """Each place of the house has tests of its own, named after its files: test_<file>[_more].py."""
    rooms = {
        path.relative_to(ROOT / "tests").as_posix() for path in (ROOT / "tests").rglob("*") if path.is_dir()
    }
    places = {p.relative_to(PACKAGE).as_posix() for p in PACKAGE.rglob("*") if (p / "__init__.py").is_file()}
    apart = {"helpers", "mutations", "project"}
    bare = {p.parent for p in MODULES if not (p.parent / "__init__.py").is_file()}
    assert not bare, f"folders without __init__.py, and so without a sentence and tests: {bare}"
    stray = {room for room in rooms if not room.endswith("__pycache__")} - places - apart
    assert not stray, f"no rooms of these names: {stray}"
    for place in sorted(places):
        stems = {path.stem for path in (PACKAGE / place).glob("*.py")} - {"__init__"}
        tests = sorted((ROOT / "tests" / place).glob("test_*.py"))
        assert tests or not stems, f"tests/{place} holds no test"
        for test in tests:
            rest = test.stem.removeprefix("test_")
            assert any(rest == stem or rest.startswith(f"{stem}_") for stem in stems), (
                f"{relative(test)} is named after no file of unstruct/{place}"
            )


def test_no_module_is_beyond_the_tests() -> None:
    """Each is imported by a test, or by a module that is."""
    parts = {path: path.relative_to(ROOT).with_suffix("").parts for path in MODULES}
    dotted = {path: ".".join(part for part in names if part != "__init__") for path, names in parts.items()}
    texts = [path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("test_*.py")]
    tests = "\n".join({line for text in texts for line in text.splitlines() if "unstruct" in line})
    reached, fresh = set(), [PACKAGE / "__init__.py"]
    for path, name in dotted.items():
        parent, _, stem = name.rpartition(".")
        if re.search(rf"{re.escape(name)}\b|from {re.escape(parent)} import[^\n]*\b{stem}\b", tests):
            fresh.append(path)
    while fresh:
        path = fresh.pop()
        reached.add(path)
        inner = imports(path)
        fresh += [other for other, name in dotted.items() if name in inner and other not in reached]
    left = [name for path, name in dotted.items() if path not in reached and path.name != "__init__.py"]
    assert not left, f"no test reaches {left}"


def test_no_file_is_hidden_by_a_name_of_its_room() -> None:
    """`import unstruct.sizing.limit as l` gives the file, not a function that the room hands on."""
    for path in MODULES:
        name = module_name(path)
        parent, _, leaf = name.rpartition(".")
        if path.name != "__init__.py":
            assert getattr(importlib.import_module(parent), leaf) is importlib.import_module(name), name
