"""TreeCells: arrays of leaves, and the laws of trees made of trees."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from trees import in_order, leaves, planted, unpacked

from unstruct import Domain, InputError, Tree, octree, quadtree
from unstruct.generate.tree.cells import TreeCells, as_across
from unstruct.plain import tree as plain

SMALL = settings(max_examples=30)


def trees(d: int) -> st.SearchStrategy[Tree]:
    return leaves(d, deepest=4, targets=3).map(lambda cells: planted(cells, d))


def divided(tree: Tree) -> set:
    return plain.nodes(unpacked(tree)) - unpacked(tree)


@pytest.mark.parametrize("d", [2, 3])
def test_arrays(d: int) -> None:
    @SMALL
    @given(leaves(d))
    def check(cells: frozenset) -> None:
        tree = planted(cells, d)
        n = len(cells)
        assert len(tree) == n and tree.counts.tolist() == plain.counts(cells) and tree.counts.sum() == n
        assert tree.depth == plain.depth(cells) == tree.levels.max() and tree.dimension == d
        low, high = tree.corners
        assert (high - low == 0.5 ** tree.levels[:, None].astype(float)).all()
        assert (tree.sides == (high - low)[:, 0]).all() and (tree.centers == (low + high) / 2).all()
        assert (high - low).prod(axis=1).sum() == 1.0
        assert tree.keys.tolist() == [
            plain.key((level, *i), level)
            for level, i in zip(
                tree.levels.tolist(), (low * 2.0 ** tree.levels[:, None]).astype(int).tolist()
            )
        ]

    check()


def test_arrays_are_read_only_and_lengths_fit() -> None:
    tree = quadtree(Domain.disc(), boundary_size=0.2)
    n = len(tree)
    for name in (
        "levels",
        "keys",
        "coordinates",
        "centers",
        "sides",
        "states",
        "counts",
        "unfinished",
        "box",
    ):
        array = getattr(tree, name)
        assert not array.flags.writeable, name
        if name not in ("counts", "unfinished", "box"):
            assert len(array) == n
    for array in (*tree.corners, *tree.nodes):
        assert not array.flags.writeable


def arrays_of(value) -> list[np.ndarray]:
    """All arrays in tuples."""
    if isinstance(value, tuple):
        return [array for entry in value for array in arrays_of(entry)]
    return [value] if isinstance(value, np.ndarray) else []


@pytest.mark.parametrize("d", [2, 3])
def test_no_array_of_a_record_can_be_written(d: int) -> None:
    """Kernels trust them: a key of a leaf that was written over ended the process."""
    domain = Domain.disc() if d == 2 else Domain.box()
    make = quadtree if d == 2 else octree
    tree = make(domain, boundary_size=0.3)
    _ = tree.leaves, tree.grid, tree.nodes, tree.corners, tree.hanging
    unbalanced = make(domain, boundary_size=0.3, balance=None)
    others = [tree.refined([0]), tree.coarsened([0]), tree.prefix(2), tree.union(tree), unbalanced]
    for one in (tree, *others, pickle.loads(pickle.dumps(tree)), copy.deepcopy(tree), copy.copy(tree)):
        names = ("linear", "leaves", "grid", "nodes", "boundary", "corners", "hanging")
        for name in names:
            arrays = arrays_of(getattr(one, name))
            assert arrays and not any(array.flags.writeable for array in arrays), name


def test_pickling() -> None:
    for tree in (quadtree([(0, 0), (1, 1)], 0.3), quadtree(Domain.disc(), boundary_size=0.2)):
        _ = tree.centers, tree.states
        other = pickle.loads(pickle.dumps(tree))
        assert other == tree and other.balance == tree.balance and not other.centers.flags.writeable
        np.testing.assert_array_equal(other.states, tree.states)
        np.testing.assert_array_equal(other.refined([0]).states, tree.refined([0]).states)


@pytest.mark.parametrize("d", [2, 3])
def test_refined(d: int) -> None:
    @SMALL
    @given(trees(d), st.randoms(use_true_random=False))
    def check(tree: Tree, random) -> None:
        rows = [i for i in range(len(tree)) if random.random() < 0.3]
        finer = tree.refined(rows)
        assert len(finer) == len(tree) + (2**d - 1) * len(rows)
        assert divided(finer) == divided(tree) | {in_order(tree)[i] for i in rows}
        mask = np.zeros(len(tree), dtype=bool)
        mask[rows] = True
        assert tree.refined(mask) == finer
        assert finer.union(tree) == finer and finer.intersection(tree) == tree

    check()


@pytest.mark.parametrize("d", [2, 3])
def test_coarsened(d: int) -> None:
    """Cells whose children are all leaves and all chosen become leaves; nothing else changes."""

    @SMALL
    @given(trees(d), st.randoms(use_true_random=False))
    def check(tree: Tree, random) -> None:
        chosen = {cell for cell in in_order(tree) if random.random() < 0.8}
        coarser = tree.coarsened([cell in chosen for cell in in_order(tree)])
        gone = {cell for cell in divided(tree) if set(plain.children(cell)) <= chosen}
        assert divided(coarser) == divided(tree) - gone
        everything = tree.coarsened(np.ones(len(tree), dtype=bool))
        assert everything.depth == max(tree.depth - 1, 0) and everything.intersection(tree) == everything

    check()


@pytest.mark.parametrize("d", [2, 3])
def test_union_and_intersection(d: int) -> None:
    @SMALL
    @given(trees(d), trees(d), trees(d))
    def check(a: Tree, b: Tree, c: Tree) -> None:
        assert divided(a.union(b)) == divided(a) | divided(b)
        assert divided(a.intersection(b)) == divided(a) & divided(b)
        assert a.union(b) == b.union(a) and a.union(a) == a == a.intersection(a)
        assert a.union(b).union(c) == a.union(b.union(c))
        assert a.intersection(b.union(c)) == a.intersection(b).union(a.intersection(c))
        assert a.union(a.intersection(b)) == a
        low, high = a.union(b), a.intersection(b)
        x = a.centers
        assert (low.levels[low.locate(x)] >= high.levels[high.locate(x)]).all()

    check()


def test_balanced_trees_stay_so() -> None:
    tree = quadtree([(0, 0), (1, 1)], lambda x: 0.01 + 0.3 * np.abs(x[:, 0] - 0.3))
    for other in (tree.refined([0, 5]), tree.coarsened(tree.levels > 3), tree.union(quadtree(tree.box, 0.2))):
        assert other.balance == "corners" and other.is_balanced()
    loose = tree.coarsened(np.zeros(len(tree), dtype=bool))
    assert loose == tree


@given(trees(2))
def test_prefixes_are_the_history(tree: Tree) -> None:
    for level in range(tree.depth + 2):
        first = tree.prefix(level)
        assert divided(first) == {cell for cell in divided(tree) if cell[0] < level}
        assert first.depth == min(level, tree.depth)
    assert tree.prefix(0).counts.tolist() == [1] and tree.prefix(tree.depth) == tree


def test_equality() -> None:
    tree = quadtree([(0, 0), (1, 1)], 0.3)
    assert tree == quadtree([(0, 0), (1, 1)], 0.26) and tree != quadtree([(0, 0), (1, 2)], 0.3)
    assert tree != quadtree([(0, 0), (1, 1)], 0.2) and tree != 3
    with pytest.raises(TypeError, match="unhashable"):
        hash(tree)


def test_trees_over_different_domains_do_not_go_together() -> None:
    """Unions over a disc and a square compared as equal, and had meshes of different area."""
    disc = quadtree(Domain.disc(), 0.2)
    square = quadtree(Domain.rectangle((-0.5, -0.5), (0.5, 0.5)), 0.2, box=disc.box)
    bare = quadtree(disc.box, 0.2)
    for combine in (Tree.union, Tree.intersection):
        with pytest.raises(InputError, match="only trees over one domain, or one and its box"):
            combine(disc, square)
        one, two = combine(disc, bare), combine(bare, disc)
        assert one == two and one.domain is two.domain is disc.domain
        assert one.mesh("fitted").volume == two.mesh("fitted").volume
        assert combine(disc, quadtree(Domain.disc(), 0.2)) == disc
    assert bare.union(disc) != bare.union(square)


def test_text() -> None:
    assert repr(quadtree([(0, 0), (1, 1)], 0.3)) == "<quadtree: 16 leaves, depth 2, balanced across corners>"
    assert repr(planted({(0, 0, 0, 0)}, 3)) == "<octree: 1 leaves, depth 0, not balanced>"


TREE = planted(plain.build(2, lambda cell: cell[1:] == (0, 0), 3), 2)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: TREE.locate([1.0, 2.0, 3.0]), r"x must have shape \(\.\.\., 2\), not \(3,\)"),
        (lambda: TREE.locate([[0, 0], [np.nan, 1]]), r"x\[1\]"),
        (lambda: TREE.locate("x"), "x must be"),
        (lambda: TREE.locate(["1", "2"]), "x must be real numbers"),
        (lambda: TREE.nearest(np.ma.array([0.1, 0.2], mask=[True, False])), "x has masked entries"),
        (lambda: TREE.in_box([0, 0], [[1, 1], [2, 2]]), r"low and high must have shape \(2,\)"),
        (lambda: TREE.in_box([1, 0], [0, 1]), r"low\[0\] = 1.0 exceeds high\[0\] = 0.0"),
        (lambda: TREE.nearest([0, 0], among=[99]), r"among\[0\] = 99 is no leaf; there are 10"),
        (lambda: TREE.nearest([0, 0], among=[-1]), r"among\[0\] = -1 is no leaf"),
        (lambda: TREE.nearest([0, 0], among=[0.5]), "among must be one bool per leaf"),
        (lambda: TREE.nearest([0, 0], among=[True]), "among must be one bool per leaf"),
        (lambda: TREE.refined([[1]]), "which must be one bool per leaf"),
        (lambda: TREE.refined("x"), "which must be one bool per leaf"),
        (lambda: TREE.coarsened([10]), r"which\[0\] = 10 is no leaf"),
        (lambda: TREE.neighbors("edges"), "across must be 'faces' or 'corners', not 'edges'"),
        (lambda: TREE.neighbors(["faces"]), "across must be"),
        (lambda: TREE.balanced(None), "across must be"),
        (lambda: TREE.is_balanced(1), "across must be"),
        (lambda: TREE.union(3), "a Tree is needed, not int"),
        (lambda: TREE.union(quadtree([(0, 0), (1, 2)])), "only trees over one box can be combined"),
        (lambda: TREE.intersection(planted({(0, 0, 0, 0)}, 3)), "only trees over one box"),
        (lambda: TREE.prefix(-1), "level = -1 must be a whole number"),
        (lambda: TREE.prefix(1.5), "level = 1.5 must be a whole number"),
    ],
)
def test_errors(call, says: str) -> None:
    with pytest.raises(InputError, match=says):
        call()


def test_the_smallest_leaves_are_not_divided() -> None:
    with pytest.warns(match="level 30"):
        tree = quadtree([(0, 0), (1, 1)], points=[(0.3, 0.3)] * 2)
    with pytest.raises(InputError, match=r"leaf \d+ cannot be divided: its level is 30, the deepest"):
        tree.refined(tree.levels == 30)
    assert tree.refined(tree.levels == 29).depth == 30


def test_shapes_of_queries() -> None:
    assert TREE.locate([0.9, 0.9]).shape == () and TREE.locate(np.zeros((2, 3, 2))).shape == (2, 3)
    assert TREE.locate(np.zeros((0, 2))).shape == (0,) and TREE.nearest(np.zeros((0, 2))).shape == (0,)
    assert isinstance(TREE, TreeCells) and as_across("corners", 2) == "corners"
    assert len(TREE.refined([])) == len(TREE)
