"""quadtree and octree: what they take, what they refuse, by name; whole trees against recursion."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from trees import BOXES, unpacked

from unstruct import Domain, InputError, Mesh, Tree, UnstructError, octree, quadtree, sizing
from unstruct.plain import tree as plain


def raising(centers: np.ndarray, sides: np.ndarray) -> list[bool]:
    """A function that fails at some cells of level 3."""
    return [1 / (x - 0.5625) > 1e9 for x in centers[:, 0].tolist()]


UNIT = {2: [(0.0, 0.0), (1.0, 1.0)], 3: [(0.0, 0.0, 0.0), (1.0, 1.0, 1.0)]}
PLANT = {2: quadtree, 3: octree}


@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
@pytest.mark.parametrize("d", [2, 3])
@settings(max_examples=15)
@given(data=st.data())
def test_as_by_recursion(d: int, data: st.DataObject) -> None:
    """A size that grows from a point: built by dividing cell by cell, and balanced cell by cell."""
    at = np.array(data.draw(st.tuples(*[st.integers(0, 16)] * d))) / 16
    least, slope = data.draw(st.sampled_from([0.02, 0.07])), data.draw(st.sampled_from([0.3, 1.0]))
    across = data.draw(st.sampled_from(["faces", "corners", None]))

    def size(x: np.ndarray) -> np.ndarray:
        return least + slope * np.abs(x - at).max(axis=1)

    def wanted(cell: tuple) -> bool:
        low, high = np.array(plain.box(cell), dtype=float)
        count = 1 << max(4 - cell[0], 0)  # the first levels are asked at more places
        share = (np.arange(count) + 0.5) / count
        places = np.stack(np.meshgrid(*[share] * d, indexing="ij"), axis=-1).reshape(-1, d)
        return bool((size(low + (high - low) * places) < 0.5 ** cell[0]).any())

    deepest = 5 if d == 2 else 3
    tree = PLANT[d](UNIT[d], size, balance=across, max_level=30 if d == 2 and least > 0.05 else deepest)
    cells = plain.build(d, wanted, tree.depth + 1 if tree.complete else deepest)
    assert unpacked(tree) == (cells if across is None else plain.balance(cells, across))


@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
@pytest.mark.parametrize(("d", "box"), [(d, box) for d in (2, 3) for box in range(3)])
def test_boxes_of_any_corners(d: int, box: int) -> None:
    low, high = np.array(BOXES[d][box], dtype=float)
    at = low + 0.3 * (high - low)
    side = (high - low).max()

    def size(x: np.ndarray) -> np.ndarray:
        return 0.02 * side + 0.3 * np.abs(x - at).max(axis=1)

    tree = PLANT[d]([low, high], size)
    first, last = tree.corners
    assert tree.is_balanced() and (tree.sides <= size(tree.centers)).all()
    np.testing.assert_array_equal(tree.locate(tree.centers), np.arange(len(tree)))
    assert (first.min(axis=0) == low).all() and (last.max(axis=0) == low + (high - low)).all()


def test_the_root_of_a_domain_is_a_square_around_it() -> None:
    tree = quadtree(Domain.polygon([(0, 0), (4, 0), (4, 1), (0, 1)]), 0.5)
    low, high = tree.box
    np.testing.assert_allclose(high - low, 4 * (1 + 1 / 32))
    np.testing.assert_allclose(0.5 * (low + high), [2, 0.5])
    box = [[-1.0, -1.0], [4.0, 3.0]]
    assert quadtree(tree.domain, 0.5, box=box).box.tolist() == box
    sampled = tree.domain.sampled(0.3)
    assert quadtree(sampled, 0.5).keys.tolist() == tree.keys.tolist()
    ball = Domain.ball(size=0.5)
    surface = Mesh(ball.points, ball.facets)
    assert octree(surface, 0.5) == octree(ball, 0.5)


def test_outside_of_a_domain_nothing_is_divided() -> None:
    tree = quadtree(Domain.disc(), 0.05, balance=None)
    outside = tree.states == -1
    parents = tree.nodes.parents[tree.nodes.leaves >= 0]
    center = tree.nodes.centers[parents[outside]]
    half = tree.sides[outside]
    assert (np.abs(center).max(axis=1) - half < 1).all()  # their parents are cut
    assert quadtree(Domain.disc(), min_level=4, balance=None).counts.tolist() == [0, 0, 0, 0, 256]


def test_rules_together_divide_where_one_asks() -> None:
    domain, options = Domain.disc(), {"box": [(-1, -1), (1, 1)], "balance": None}
    points = np.random.default_rng(0).uniform(-0.6, 0.6, (20, 2))
    rules = [{"size": 0.4}, {"points": points}, {"boundary_size": 0.1}, {"turning": 20.0}]
    union = quadtree(domain, **options)
    for rule in rules:
        union = union.union(quadtree(domain, **rule, **options))
    together = quadtree(domain, **{name: value for rule in rules for name, value in rule.items()}, **options)
    assert together == union


SQUARE = Domain.polygon([(0, 0), (1, 0), (1, 1), (0, 1)])


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: quadtree(None), "two corners|a Domain or a box"),
        (lambda: quadtree(Domain.box()), "the domain has points of 3 coordinates"),
        (lambda: octree(SQUARE), "the domain has points of 2 coordinates"),
        (lambda: octree(UNIT[2]), r"shape \(2, 3\), not \(2, 2\)"),
        (lambda: quadtree(UNIT[2], -1), "size must be positive and finite"),
        (lambda: quadtree(UNIT[2], lambda x: x), "must return shape"),
        (lambda: quadtree(UNIT[2], lambda x: 0 * x[:, 0]), "size must be positive and finite: it is 0.0 at"),
        (lambda: quadtree(UNIT[2], balance="edges"), "balance must be 'faces' or 'corners', not 'edges'"),
        (lambda: octree(UNIT[3], balance="all"), "balance must be 'faces' or 'edges' or 'corners'"),
        (lambda: quadtree(UNIT[2], min_level=3, max_level=2), "min_level = 3 and max_level = 2 must satisfy"),
        (lambda: quadtree(UNIT[2], max_level=31), "max_level <= 30"),
        (lambda: octree(UNIT[3], max_level=21), "max_level <= 20"),
        (lambda: quadtree(UNIT[2], min_level=-1), "min_level = -1 must be a whole number"),
        (lambda: quadtree(UNIT[2], max_level=2.5), "max_level = 2.5 must be a whole number"),
        (lambda: quadtree(UNIT[2], budget=0.5), "budget = 0.5 must be a whole number"),
        (lambda: quadtree(UNIT[2], points=[(0, 0, 0)]), r"points must have shape \(k, 2\), not \(1, 3\)"),
        (lambda: quadtree(UNIT[2], points=[(0, 0), (2, 0)]), r"points\[1\] = \[2.0, 0.0\] lies outside of"),
        (lambda: quadtree(UNIT[2], points=[(0, 0), (0, np.nan)]), r"points\[1\]"),
        (lambda: quadtree(UNIT[2], points=[(0, 0)], most_points=-1), "most_points = -1 must be a whole"),
        (lambda: quadtree(UNIT[2], most_points="1"), "most_points = '1' must be a whole"),
        (lambda: quadtree(UNIT[2], divide=3), "divide must be a function, not int"),
        (lambda: quadtree(UNIT[2], box=UNIT[2]), "box goes with a domain"),
        (lambda: quadtree(SQUARE, box=[(0, 0), (0.5, 1)]), "does not contain the domain, with bounds"),
        (lambda: quadtree(UNIT[2], boundary_size=0.1), "boundary_size needs a domain, not a box"),
        (lambda: quadtree(UNIT[2], growth=0.1), "growth needs a domain, not a box"),
        (lambda: quadtree(UNIT[2], turning=10), "turning needs a domain, not a box"),
        (lambda: quadtree(SQUARE, boundary_size=0), "boundary_size = 0.0 must be positive"),
        (lambda: quadtree(SQUARE, growth=0.1), "growth goes with boundary_size"),
        (lambda: quadtree(SQUARE, boundary_size=0.1, growth=-1), "growth must be at least 0, not -1"),
        (lambda: quadtree(SQUARE, turning=-3), "turning = -3.0 must be positive"),
        (lambda: quadtree(SQUARE, turning=np.nan), "turning = nan must be positive"),
        (lambda: quadtree(SQUARE, progress=1), "progress must be True or False"),
        (lambda: octree(Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])), "."),
        (lambda: quadtree([["0", "0"], ["1", "1"]]), "a Domain or a box of two corners is needed, not list"),
        (lambda: quadtree([[False, False], [True, True]]), "a box of two corners is needed, not bools"),
        (lambda: quadtree(np.ma.array(UNIT[2], mask=[(1, 0), (0, 0)])), "the box has masked entries"),
        (lambda: quadtree(SQUARE, box=[[b"0", 0], [1, 1]]), "a box of two corners is needed, not list"),
        (lambda: quadtree(UNIT[2], divide=lambda c, s: 1 / 0), r"divide raised ZeroDivisionError \(division"),
        (lambda: quadtree(UNIT[2], divide=lambda c: c), r"divide raised TypeError .* takes centers \(k, 2\)"),
        (lambda: quadtree(UNIT[2], divide=lambda c, s: [[1], [1, 2]]), "divide raised ValueError"),
        (
            lambda: quadtree(UNIT[2], divide=lambda c, s: np.ma.array(s > 0, mask=s > 0)),
            "divide must return plain bools, not a masked array",
        ),
        (
            lambda: quadtree(UNIT[2], min_level=3, divide=raising),
            r"divide raised ZeroDivisionError .* for the cell about \[0\.5625, 0\.0625\], of side 0\.125",
        ),
    ],
)
def test_errors(call, says: str) -> None:
    with pytest.raises(UnstructError, match=says):
        call()


@pytest.mark.parametrize("none", [[], (), np.empty(0), np.empty((0, 2))])
def test_no_points_divide_nothing(none) -> None:
    assert len(quadtree(UNIT[2], points=none)) == 1
    with pytest.raises(InputError, match=r"shape \(k, 2\), not \(0, 3\)"):
        quadtree(UNIT[2], points=np.empty((0, 3)))


def test_an_open_surface_is_refused_by_name() -> None:
    ball = Domain.ball(size=0.5)
    with pytest.raises(UnstructError, match=r"odd|open|edge"):
        octree(Mesh(ball.points, ball.facets[:-1]))


def test_results_are_the_same_every_time_and_pickle() -> None:
    domain = Domain.disc()
    one, two = (quadtree(domain, sizing.clip(0.1, 0.05, 0.2), turning=20) for _ in range(2))
    assert one == two and isinstance(one, Tree)
    assert pickle.loads(pickle.dumps(one)) == two
    with pytest.raises(InputError):
        quadtree(domain, "x")


def test_a_few_cells_of_tiny_and_huge_boxes() -> None:
    for unit in (1e-300, 1e-9, 1e9, 1e300):
        tree = quadtree([(0, 0), (unit, unit)], 0.2 * unit)
        assert tree.counts.tolist() == [0, 0, 0, 64]
        square = Domain.polygon(np.array([(1, 1), (3, 1), (3, 2), (1, 2)]) * unit / 4)
        inside = quadtree(square, boundary_size=unit / 50)
        same = quadtree(Domain.polygon(np.array([(1, 1), (3, 1), (3, 2), (1, 2)]) / 4), boundary_size=1 / 50)
        if 1e-100 < unit < 1e100:
            assert abs(len(inside) - len(same)) < 0.1 * len(same)
