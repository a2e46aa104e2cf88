"""The same on every processor: meshes bit for bit, and what the chapters print that solve something.

For input equal bit for bit the meshes of all methods are equal on every setting: `mesh_hashes.py` says which,
and holds what is stored for all machines. Excepted are sizes from computed solutions (second derivatives,
error estimates, systems solved by linear algebra), whose last bits depend on the processor, and functions of
the caller that are more than + - * / and square roots. Chapters that use such print what is stable, and
assert the rest within bounds. Two of the settings run here and in `test_oldest_processor.py`;
`book/processors.py` has all of them, for every notebook.
"""

from __future__ import annotations

import ast
import json
import sys
from collections.abc import Callable

import mesh_hashes
import pytest
from book_files import BOOK
from on_processors import named, print_the_same

sys.path.append(str(BOOK))
import processors

OF_MATRICES = {"det", "eig", "eigh", "inv", "lstsq", "qr", "solve", "svd"}
DECIDE = [
    *("connect/insertion", "connect/planar", "connect/spatial", "generate"),
    *(f"domain/space/{name}.py" for name in "bodies cutting flat repair rings splitting swept".split()),
]
BODIES = [
    *(
        f"domain/space/{name}.py"
        for name in "bodies by_part cutting flat parts repair rings splitting swept".split()
    ),
    *(f"sizing/{name}.py" for name in "apart space_features space_table surface".split()),
    *("generate/bodies", "generate/volume/rounder.py", "generate/volume/filling.py"),
]
ROUNDED_DIFFERENTLY = set(
    "sin cos tan arcsin arccos arctan arctan2 asin acos atan atan2 hypot exp exp2 expm1 log log2 log10 log1p "
    "power pow cbrt sinh cosh tanh".split()
)
STORED = json.loads(mesh_hashes.STORED.read_text(encoding="utf-8"))


def is_blas(node: ast.AST) -> bool:
    """Whether this is a product or a norm that BLAS adds, in an order that depends on the processor."""
    if isinstance(node, ast.BinOp | ast.AugAssign):
        return isinstance(node.op, ast.MatMult)
    if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
        return False
    if node.func.attr == "norm":  # of rows it is added in their order
        return all(keyword.arg != "axis" for keyword in node.keywords)
    return node.func.attr in {"dot", "vdot", "inner", "matmul", "tensordot", "einsum", *OF_MATRICES}


def is_dispatched(node: ast.AST) -> bool:
    """Whether numpy or the C library computes this, in last bits that depend on the processor."""
    if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
        return False
    library = isinstance(node.func.value, ast.Name) and node.func.value.id in ("np", "math")
    return library and node.func.attr in ROUNDED_DIFFERENTLY


def places_of(asked: Callable[[ast.AST], bool], room: str) -> list[str]:
    """Files and lines of a room where something of the kind stands."""
    place = BOOK.parent / "unstruct" / room
    return [
        f"{path.relative_to(BOOK.parent)}:{node.lineno}"
        for path in ([place] if place.suffix else sorted(place.rglob("*.py")))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if asked(node)
    ]


@pytest.mark.parametrize("room", BODIES)
def test_bodies_have_functions_of_the_library_itself(room: str) -> None:
    found = places_of(is_dispatched, room)
    assert not found, f"{found}: use base.elementary, or geometry.edge_vectors.lengths for hypot"


def test_functions_of_numpy_are_found() -> None:
    for text in ("np.hypot(a, b)", "math.sin(x)", "np.arctan2(y, x)"):
        assert any(map(is_dispatched, ast.walk(ast.parse(text))))
    assert not any(map(is_dispatched, ast.walk(ast.parse("np.sqrt(a) + sines(b) + np.round(c)"))))


@pytest.mark.parametrize("room", DECIDE)
def test_what_decides_meshes_adds_in_a_fixed_order(room: str) -> None:
    found = places_of(is_blas, room)
    assert not found, f"{found}: write sums of products, (a * b).sum(axis=-1), or geometry.edge_vectors"


@pytest.mark.parametrize("text", ["a @ b", "a @= b", "np.dot(a, b)", "np.linalg.norm(a)", "np.linalg.det(a)"])
def test_linear_algebra_is_found(text: str) -> None:
    assert any(map(is_blas, ast.walk(ast.parse(text))))
    assert not any(map(is_blas, ast.walk(ast.parse("np.linalg.norm(a, axis=1) + (a * b).sum(axis=1)"))))


def test_every_setting_governs_what_it_should() -> None:
    settings = processors.settings()
    assert {"as it is", "one thread", "oldest", "generic code"} <= set(settings)
    for setting in settings.values():
        assert set(setting) <= set(processors.MANAGED)
    assert set(processors.environment({})) & set(processors.MANAGED) == set()


def test_the_hashes_are_those_of_the_methods() -> None:
    assert list(STORED) == list(mesh_hashes.CASES)


@pytest.mark.parametrize("setting", ["as it is", "oldest"])
def test_meshes_are_equal_bit_for_bit(setting: str) -> None:
    found = processors.hashes(named(setting))
    differ = [name for name in STORED if found[name] != STORED[name]]
    assert not differ, f"{differ} differ; if that is meant: python tests/helpers/mesh_hashes.py --write"


def test_what_chapters_print_that_solve_something() -> None:
    print_the_same("another")
