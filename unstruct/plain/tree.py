"""Quadtrees and octrees, told plainly (section 4a of the book).

A cell is a tuple: its level, and its integer coordinates among the cells of that level: ``(level, i, j)`` in
the plane, ``(level, i, j, k)`` in space. The root ``(0, 0, 0)`` is the unit square or cube. A tree is the
set of its leaves. Points and corners are tuples of Fractions.

Sources: R. A. Finkel, J. L. Bentley, Acta Informatica 4 (1974) 1-9; D. Moore, Proc. 3rd ACM Symposium on
Solid Modeling (1995) 305-312.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from fractions import Fraction
from itertools import product

__all__ = [
    "balance", "box", "build", "center", "children", "counts", "covering", "depth", "is_balanced", "key",
    "locate", "neighbors", "nodes", "parent", "steps", "touch",
]  # fmt: skip

Cell = tuple[int, ...]
Point = tuple[Fraction, ...]
Leaves = set[Cell]
ALONG = {"faces": 1, "edges": 2, "corners": 3}  # how many coordinates may change between neighbors


def children(cell: Cell) -> list[Cell]:
    """The 2**d cells into which a cell is divided, in the order of their keys: the first coordinate changes
    first."""
    level, *at = cell
    sides = product((0, 1), repeat=len(at))
    return [(level + 1, *(2 * i + s for i, s in zip(at, reversed(side), strict=True))) for side in sides]


def parent(cell: Cell) -> Cell:
    """The cell of which this one is a child."""
    level, *at = cell
    return (level - 1, *(i // 2 for i in at))


def box(cell: Cell) -> tuple[Point, Point]:
    """The lower and the upper corner."""
    level, *at = cell
    low = tuple(Fraction(i, 2**level) for i in at)
    return low, tuple(x + Fraction(1, 2**level) for x in low)


def center(cell: Cell) -> Point:
    """The point in the middle."""
    low, high = box(cell)
    return tuple((a + b) / 2 for a, b in zip(low, high, strict=True))


def key(cell: Cell, deepest: int) -> int:
    """The Morton key of the first cell of the level `deepest` in a cell."""
    # The bits of the coordinates in turn, the lowest ones first.
    level, *at = cell
    bits = [(i << (deepest - level)) >> b & 1 for b in range(deepest) for i in at]
    return sum(bit << place for place, bit in enumerate(bits))


def build(dimension: int, wanted: Callable[[Cell], bool], deepest: int) -> Leaves:
    """Divide `wanted` cells from the root on, down to the level `deepest` at most."""
    leaves, waiting = set(), [(0,) * (1 + dimension)]
    while waiting:
        cell = waiting.pop()
        if cell[0] < deepest and wanted(cell):
            waiting += children(cell)
        else:
            leaves.add(cell)
    return leaves


def nodes(leaves: Collection[Cell]) -> set[Cell]:
    """The leaves and all cells that were divided."""
    found: set[Cell] = set()
    for cell in leaves:
        while cell not in found:
            found.add(cell)
            if cell[0] > 0:
                cell = parent(cell)
    return found


def depth(leaves: Collection[Cell]) -> int:
    """The level of the smallest leaves."""
    return max(cell[0] for cell in leaves)


def counts(leaves: Collection[Cell]) -> list[int]:
    """How many leaves each level has."""
    found = Counter(cell[0] for cell in leaves)
    return [found[level] for level in range(depth(leaves) + 1)]


# ---------------------------------------------------------------------- searches


def locate(leaves: Collection[Cell], x: Sequence[Fraction | float]) -> Cell | None:
    """The leaf that contains a point, from the root downward: of a face in common, the one above it."""
    if not all(0 <= c <= 1 for c in x):
        return None
    cell: Cell = (0,) * (1 + len(x))
    while cell not in leaves:
        above = [c >= m for c, m in zip(x, center(cell), strict=True)]
        cell = (cell[0] + 1, *(2 * i + s for i, s in zip(cell[1:], above, strict=True)))
    return cell


def covering(leaves: Collection[Cell], cell: Cell) -> Cell | None:
    """The leaf that contains a cell; None if it is divided, or outside of the root."""
    if not all(0 <= i < 2 ** cell[0] for i in cell[1:]):
        return None
    while cell not in leaves:
        if cell[0] == 0:
            return None
        cell = parent(cell)
    return cell


def touch(a: Cell, b: Cell, across: str = "corners") -> bool:
    """Whether two different leaves share a face; an edge at least; a corner at least."""
    (low, high), (other, top) = box(a), box(b)
    pairs = list(zip(low, high, other, top, strict=True))
    apart = sum(h == s or t == m for m, h, s, t in pairs)  # along these axes they only touch
    return all(m <= t and s <= h for m, h, s, t in pairs) and 1 <= apart <= ALONG[across]


def neighbors(leaves: Collection[Cell], cell: Cell, across: str = "faces") -> Leaves:
    """All leaves that touch one: each is tried."""
    return {other for other in leaves if other != cell and touch(cell, other, across)}


# ---------------------------------------------------------------------- balance


def steps(dimension: int, across: str) -> Iterator[tuple[int, ...]]:
    """From a cell to the cells of its level that are its neighbors."""
    for step in product((-1, 0, 1), repeat=dimension):
        if 1 <= sum(map(abs, step)) <= ALONG[across]:
            yield step


def balance(leaves: Collection[Cell], across: str = "corners") -> Leaves:
    """Divide leaves that have a neighbor two levels deeper, until none has one."""
    balanced, waiting = set(leaves), list(leaves)
    while waiting:
        cell = waiting.pop()
        if cell not in balanced:
            continue
        for step in steps(len(cell) - 1, across):
            beside = (cell[0], *(i + s for i, s in zip(cell[1:], step, strict=True)))
            larger = covering(balanced, beside)
            if larger is not None and larger[0] < cell[0] - 1:
                balanced.remove(larger)
                balanced.update(children(larger))
                waiting += [*children(larger), cell]
    return balanced


def is_balanced(leaves: Collection[Cell], across: str = "corners") -> bool:
    """Whether the levels of leaves that touch differ by at most one."""
    return all(abs(cell[0] - other[0]) <= 1 for cell in leaves for other in neighbors(leaves, cell, across))
