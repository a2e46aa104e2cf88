"""quadtree and octree: from a box or a domain, and rules, to a tree.

See the book, chapter 4a.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_count, positive
from ...base.arrays import as_points, frozen
from ...base.errors import IncompleteWarning, InputError
from ...domain.domain import Domain, as_domain
from ...domain.plane.sample import Sampled
from ...mesh.mesh import Mesh
from ...sizing.field import as_size
from ..tree.balancing import balanced
from ..tree.cells import as_across
from ..tree.contacts import boundary_of
from ..tree.criteria import Rule, by_boundary, by_count, by_function, by_size, by_turning
from ..tree.growing import MOST_CELLS, Growth, Limits, as_box, deepest_level, grow
from ..tree.keys import keys_of
from ..tree.linear import leaves_of
from ..tree.lookup import cells_of
from .tree import Tree

__all__ = ["octree", "quadtree"]

Array = NDArray[np.float64]
MARGIN = 1.0 / 64  # of the extent of a domain, between it and the sides of the root


def quadtree(
    domain_or_box: Any,
    size: Any = None,
    *,
    balance: str | None = "corners",
    min_level: int = 0,
    max_level: int | None = None,
    points: ArrayLike | None = None,
    most_points: int = 1,
    boundary_size: float | None = None,
    turning: float | None = None,
    divide: Callable[[Array, Array], Any] | None = None,
    box: ArrayLike | None = None,
    budget: int = MOST_CELLS,
    progress: bool = False,
) -> Tree:
    """A quadtree over a box or over the box around a planar domain.

    A cell is divided into four equal ones if any of the following asks for it.

    Parameters
    ----------
    domain_or_box : Domain, or array_like of shape (2, 2)
        What is to be covered, or two opposite corners of the box. Of a domain only the cells that meet its
        inside are divided, and the box is a square around it, unless `box` is given.
    size : number, function (k, 2) -> (k,), or size field, optional
        A cell is divided while its longest edge exceeds the size wanted in it. A field with a known growth
        is bounded over the whole cell. Other functions are asked at centers, and in the first four levels at
        as many places as the fourth has cells: see `min_level` for details that are smaller.
    balance : "corners", "faces" or None
        Across what leaves may differ by one level only.
    min_level : int
        All cells above this level are divided.
    max_level : int, optional
        No cell of this level is divided. By default, the deepest for which keys and doubles have room: 30.
    points : array_like, shape (k, 2), optional
        Cells with more than `most_points` of these are divided. Points that coincide never part:
        their cell ends at the deepest level, and is reported.
    most_points : int
    boundary_size : float, optional
        Cells that the boundary of the domain cuts are divided while their longest edge exceeds this.
    turning : float, optional
        Degrees: cells are divided in which the boundary turns by more than about this. At a corner this never
        ends, so that it needs a `max_level`.
    divide : callable, optional
        Called with the centers (k, 2) and the longest edges (k,) of all cells of a level; returns k bools. An
        error indicator, for example.
    box : array_like, shape (2, 2), optional
        The root, for a domain. Several trees can be combined only over the same box.
    budget : int
        The largest number of leaves before balancing.
    progress : bool

    Returns
    -------
    Tree
        ``tree.complete`` is False if a rule would divide leaves further: ``tree.unfinished``.

    Raises
    ------
    InputError
        For arguments of wrong shape or type, and sizes that are not positive and finite.

    Notes
    -----
    O(n log n) for n leaves; rules are called once a level. Sources: R. A. Finkel, J. L. Bentley,
    *Quad trees*, Acta Informatica 4, 1974; H. Sundar, R. S. Sampath, G. Biros, *Bottom-up construction and
    2:1 balance refinement of linear octrees in parallel*, SIAM J. Sci. Comput. 30, 2008. Book: 4a.
    """
    return _planted(2, **locals())


def octree(
    domain_or_box: Any,
    size: Any = None,
    *,
    balance: str | None = "corners",
    min_level: int = 0,
    max_level: int | None = None,
    points: ArrayLike | None = None,
    most_points: int = 1,
    boundary_size: float | None = None,
    turning: float | None = None,
    divide: Callable[[Array, Array], Any] | None = None,
    box: ArrayLike | None = None,
    budget: int = MOST_CELLS,
    progress: bool = False,
) -> Tree:
    """An octree over a box or over the box around a body: `quadtree` in space.

    Parameters
    ----------
    domain_or_box : Domain in space, Mesh of triangles that close, or array_like of shape (2, 3)
    balance : "corners", "edges", "faces" or None
    max_level : int, optional
        At most 20.
    size, min_level, points, most_points, boundary_size, turning, divide, box, budget, progress
        As for `quadtree`, with three coordinates.

    Returns
    -------
    Tree

    Raises
    ------
    InputError
        As for `quadtree`; DomainError for surfaces that are no domain.

    Notes
    -----
    See `quadtree`. Book: 4a.
    """
    return _planted(3, **locals())


def _planted(d: int, domain_or_box: Any, size: Any, **options: Any) -> Tree:
    """A tree in d dimensions; the options are those of `quadtree`."""
    balance = options["balance"]
    if balance is not None:
        balance = as_across(balance, d, "balance")
    domain, pieces = _domain_of(domain_or_box, d, size)
    if domain is None or pieces is None:
        if options["box"] is not None:
            raise InputError("box goes with a domain; here the first argument is the box")
        root, boundary = as_box(domain_or_box, d), None
    else:
        root = as_box(_around(domain) if options["box"] is None else options["box"], d)
        boundary = boundary_of(pieces.points, pieces.corners, root, domain.contains)
        if not ((pieces.points >= root[0]).all() and (pieces.points <= root[1]).all()):
            raise InputError(
                f"the box {root.tolist()} does not contain the domain, with bounds {domain.bounds.tolist()}"
            )
    low, side = root[0], root[1] - root[0]
    deepest = deepest_level(low, side)
    most = deepest if options["max_level"] is None else as_count(options["max_level"], "max_level")
    least = as_count(options["min_level"], "min_level")
    if not least <= most <= deepest:
        raise InputError(
            f"min_level = {least} and max_level = {most} must satisfy min_level <= max_level <= {deepest}"
        )
    rules = _rules(d, root, deepest, size, pieces, options)
    limits = Limits(least, most, as_count(options["budget"], "budget"))
    growth = grow(root, rules, limits, boundary=boundary, progress=options["progress"])
    linear = growth.tree if balance is None else balanced(growth.tree, balance)
    tree = Tree(linear, root, balance)
    tree.domain, tree.boundary = domain, boundary
    return _told(tree, growth)


class Pieces(NamedTuple):
    """What bounds the domain: points, segments or triangles, and the test of points beside them."""

    points: Array
    corners: NDArray[np.int64]
    contains: Callable[[Any], NDArray[np.bool_]]


def _domain_of(value: Any, d: int, size: Any) -> tuple[Domain | None, Pieces | None]:
    """The domain with its straight pieces; (None, None) if a box is given."""
    if isinstance(value, Mesh) and value.points.shape[1] == 3 and value.dimension == 2:
        value = Domain.surface(value)
    if not isinstance(value, Domain | Sampled):
        return None, None
    domain = as_domain(value, d)
    if d == 3:
        shell = domain.triangulated
        return domain, Pieces(shell.points, shell.bounding.astype(np.int64), domain.contains)
    straight = domain if not domain.curves else as_domain(domain.sampled(size))
    return domain, Pieces(straight.points, straight.facets.astype(np.int64), straight.contains)


def _around(domain: Domain) -> Array:
    """A square or a cube around the domain, with a margin."""
    low, high = domain.bounds
    middle, half = low + 0.5 * (high - low), (0.5 + MARGIN) * float((high - low).max())
    return np.stack([middle - half, middle + half])


def _rules(
    d: int, root: Array, deepest: int, size: Any, pieces: Pieces | None, options: dict[str, Any]
) -> list[Rule]:
    """The rules that the options ask for."""
    rules: list[Rule] = []
    if size is not None:
        rules.append(by_size(as_size(size)))
    if options["points"] is not None:
        rules.append(_counted(d, root, deepest, options["points"], options["most_points"]))
    if options["divide"] is not None:
        if not callable(options["divide"]):
            raise InputError(f"divide must be a function, not {type(options['divide']).__name__}")
        rules.append(by_function(options["divide"]))
    for name in ("boundary_size", "turning"):
        if options[name] is not None and pieces is None:
            raise InputError(f"{name} needs a domain, not a box")
    if options["boundary_size"] is not None:
        rules.append(by_boundary(positive(options["boundary_size"], "boundary_size")))
    if options["turning"] is not None and pieces is not None:
        angle = positive(options["turning"], "turning")
        rules.append(by_turning(_normals(pieces), float(np.deg2rad(min(angle, 360.0)))))
    return rules


def _counted(d: int, root: Array, deepest: int, points: ArrayLike, most: Any) -> Rule:
    x = as_points(points)
    if x.shape[1] != d:
        raise InputError(f"points must have shape (k, {d}), not {x.shape}")
    outside = ((x < root[0]) | (x > root[1])).any(axis=1)
    if outside.any():
        row = int(np.argmax(outside))
        raise InputError(f"points[{row}] = {x[row].tolist()} lies outside of the box {root.tolist()}")
    return by_count(
        np.sort(keys_of(cells_of(x, root[0], root[1] - root[0], deepest))),
        deepest,
        as_count(most, "most_points"),
    )


def _normals(pieces: Pieces) -> Array:
    """Unit normals of segments or triangles."""
    x = pieces.points[pieces.corners]
    first = x[:, 1] - x[:, 0]
    if x.shape[2] == 2:
        normal = np.stack([first[:, 1], -first[:, 0]], axis=1)
    else:
        normal = np.cross(first, x[:, 2] - x[:, 0])
    return normal / np.sqrt((normal * normal).sum(axis=1))[:, None]


def _told(tree: Tree, growth: Growth) -> Tree:
    """The tree, which knows what was refused."""
    if not growth.refused:
        return tree
    first = np.concatenate(
        [keys << np.uint64(tree.dimension * (tree.depth - level)) for level, keys in growth.refused.items()]
    )
    tree.complete, tree.reason = False, f"further divisions were refused: {growth.reason}"
    leaves = leaves_of(tree.linear)
    tree.unfinished = frozen(np.flatnonzero(np.isin(leaves.first, first)))
    warn(
        f"{len(tree.unfinished):,} leaves are not divided as asked: {growth.reason}",
        IncompleteWarning,
        stacklevel=4,
    )
    return tree
