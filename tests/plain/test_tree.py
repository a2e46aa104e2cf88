"""The plain trees: by hand, and their laws."""

from __future__ import annotations

from fractions import Fraction as F
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct.plain import tree
from unstruct.plain.tree_states import contains, meets, state
from unstruct.plain.tree_templates import corners, hanging, tetrahedra, triangles, vertices

SQUARE = [((F(1, 4), F(1, 4)), (F(3, 4), F(1, 4))), ((F(3, 4), F(1, 4)), (F(3, 4), F(3, 4)))]
SQUARE += [((F(3, 4), F(3, 4)), (F(1, 4), F(3, 4))), ((F(1, 4), F(3, 4)), (F(1, 4), F(1, 4)))]


def holds(cell: tuple[int, ...], x: tuple[F, ...]) -> bool:
    low, high = tree.box(cell)
    return all(a <= c < b for a, c, b in zip(low, x, high, strict=True))


def toward(x: tuple[F, ...], level: int) -> set[tuple[int, ...]]:
    return tree.build(len(x), lambda cell: holds(cell, x), level)


def test_children_and_keys() -> None:
    assert tree.children((0, 0, 0)) == [(1, 0, 0), (1, 1, 0), (1, 0, 1), (1, 1, 1)]
    assert all(tree.parent(child) == (1, 1, 0, 1) for child in tree.children((1, 1, 0, 1)))
    cells = [c for a in tree.children((0, 0, 0, 0)) for c in tree.children(a)]
    assert [tree.key(cell, 2) for cell in cells] == list(range(64))
    assert tree.box((2, 1, 3)) == ((F(1, 4), F(3, 4)), (F(1, 2), F(1)))


@pytest.mark.parametrize("d", [2, 3])
def test_counts(d: int) -> None:
    leaves = toward((F(1, 3),) * d, 5)
    assert len(leaves) == 1 + (2**d - 1) * 5 and len(tree.nodes(leaves)) == 1 + 2**d * 5
    assert tree.counts(leaves) == [0, *[2**d - 1] * 4, 2**d] and tree.depth(leaves) == 5
    assert sum(F(1, 2 ** (d * cell[0])) for cell in leaves) == 1
    assert len({tree.key(cell, 5) for cell in leaves}) == len(leaves)


@pytest.mark.parametrize("across", ["faces", "edges", "corners"])
@pytest.mark.parametrize("d", [2, 3])
def test_balance_is_the_least(d: int, across: str) -> None:
    """Balanced; and every cell that it divides must be: some smaller cell would be out of balance."""
    leaves = toward(tuple(F(7, 15) for _ in range(d)), 5)
    balanced = tree.balance(leaves, across)
    assert not tree.is_balanced(leaves, across) and tree.is_balanced(balanced, across)
    assert tree.balance(balanced, across) == balanced
    divided, had = tree.nodes(balanced) - balanced, tree.nodes(leaves) - leaves
    assert had <= divided
    for cell in divided - had:  # undo one division: the children must be leaves, and something is violated
        children = set(tree.children(cell))
        if children <= balanced:
            undone = balanced - children | {cell}
            assert any(abs(cell[0] - o[0]) > 1 for o in tree.neighbors(undone, cell, across))


def test_locate() -> None:
    leaves = toward((F(1, 3), F(2, 3)), 4)
    for i, j in product(range(17), repeat=2):
        x = (F(i, 16), F(j, 16))
        found = tree.locate(leaves, x)
        assert found in leaves
        low, high = tree.box(found)
        assert all(a <= c and (c < b or b == 1) for a, c, b in zip(low, x, high, strict=True))
    assert tree.locate(leaves, (F(-1), F(0))) is None and tree.locate(leaves, (F(0), F(17, 16))) is None


def test_neighbors() -> None:
    leaves = {(1, 1, 0), (1, 0, 1), (1, 1, 1), *tree.children((1, 0, 0))}
    assert tree.neighbors(leaves, (1, 1, 0)) == {(2, 1, 0), (2, 1, 1), (1, 1, 1)}
    assert tree.neighbors(leaves, (1, 1, 1)) == {(1, 1, 0), (1, 0, 1)}
    assert tree.neighbors(leaves, (1, 1, 1), "corners") == {(1, 1, 0), (1, 0, 1), (2, 1, 1)}
    assert tree.covering(leaves, (3, 7, 7)) == (1, 1, 1) and tree.covering(leaves, (1, 0, 0)) is None
    assert tree.covering(leaves, (1, 2, 0)) is None


def area2(p: tuple, q: tuple, r: tuple) -> F:
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


def volume6(p: tuple, q: tuple, r: tuple, s: tuple) -> F:
    (a, b, c), (d, e, f), (g, h, i) = ([y - x for x, y in zip(p, o, strict=True)] for o in (q, r, s))
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


@given(st.tuples(*[st.integers(0, 30)] * 2))
def test_triangles_have_angles_of_45_and_90_degrees(x: tuple[int, int]) -> None:
    leaves = tree.balance(toward(tuple(F(c, 31) for c in x), 5), "faces")
    cells = triangles(leaves)
    assert sum(area2(*t) for t in cells) == 2
    for t in cells:
        lengths = sorted(sum((a - b) ** 2 for a, b in zip(t[k], t[k - 1], strict=True)) for k in range(3))
        assert lengths[0] == lengths[1] and lengths[2] == 2 * lengths[0] and area2(*t) > 0
    sides = [frozenset(s) for t in cells for s in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))]
    for side in set(sides):  # conforming: a side has two triangles, or lies on the outline
        p, q = side
        rim = any(p[a] == q[a] and p[a] in (0, 1) for a in range(2))
        assert sides.count(side) == (1 if rim else 2)
    assert hanging(leaves) <= vertices(leaves)
    assert all(v in {c for cell in leaves for c in corners(cell)} for v in hanging(leaves))


def test_tetrahedra_are_conforming() -> None:
    leaves = tree.balance(toward((F(7, 15), F(8, 15), F(1, 3)), 3), "edges")
    cells = tetrahedra(leaves)
    assert sum(volume6(*t) for t in cells) == 6 and all(volume6(*t) > 0 for t in cells)
    faces = [frozenset(t[:k] + t[k + 1 :]) for t in cells for k in range(4)]
    for face in set(faces):
        rim = any(len({p[a] for p in face}) == 1 and next(iter(face))[a] in (0, 1) for a in range(3))
        assert faces.count(face) == (1 if rim else 2)


def test_states() -> None:
    assert state(SQUARE, (2, 1, 1)) == "inside" and state(SQUARE, (2, 0, 1)) == "outside"
    assert state(SQUARE, (1, 0, 0)) == "cut"
    assert contains(SQUARE, (F(1, 2), F(1, 2))) and not contains(SQUARE, (F(1, 8), F(1, 2)))
    low, high = (0, 0, 0), (1, 1, 1)
    assert not meets([(1, 0, 0), (1, 1, 0), (1, 0, 1)], low, high)  # in a face
    assert not meets([(2, 0, 0), (0, 2, 0), (0, 0, 0)], low, high)
    assert meets([(3, 0, 0), (0, 3, 0), (0, 0, F(1, 100))], low, high)
    assert not meets([(3, 0, 0), (0, 3, 0), (0, 0, 3)], low, high)  # the corner (1, 1, 1) alone
