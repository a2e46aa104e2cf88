"""quadtree and octree: from a box or a domain, and rules, to a tree.

See the book, chapter 4a.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_count, as_flags, finite, positive
from ...base.arrays import as_points, frozen
from ...base.errors import IncompleteWarning, InputError
from ...domain.domain import Domain
from ...sizing.field import as_size
from ..tree.balancing import balanced
from ..tree.cells import as_across
from ..tree.contacts import Boundary
from ..tree.criteria import Rule, by_boundary, by_count, by_distance, by_function, by_size
from ..tree.growing import MOST_LEAVES, Growth, Limits, deepest_level, grow
from ..tree.keys import keys_of
from ..tree.linear import leaves_of
from ..tree.lookup import cells_of
from ..tree.turning import bending_of, by_turning
from .enclosing import bounded, domain_of, root_of
from .tree import Tree

__all__ = ["octree", "quadtree"]

Array = NDArray[np.float64]
SMOOTH_LEVEL = 6  # curves are first cut for cells of this level, and again if there are smaller ones
DIRECT_LEVEL = 14  # if no cell can be smaller than those of this level, they are cut for it at once
DEVIATION_BITS = 6  # chords deviate from curves by this many halvings less than the side of the smallest cell
FINEST_BITS = 30  # and by no fewer halvings than this of the root
CUTS_OF_CURVES = 5  # how often they are cut, at most
CHORDS_PER_ANGLE = 8  # a chord turns by at most this part of the angle that is asked for


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
    growth: float | None = None,
    turning: float | None = None,
    divide: Callable[[Array, Array], Any] | None = None,
    box: ArrayLike | None = None,
    budget: int = MOST_LEAVES,
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
        Cells that the boundary of the domain cuts are divided while their longest edge exceeds this. Inner
        pieces do not count: for cells along these see `sizing.lines`.
    growth : float, optional
        With it all cells are divided whose longest edge exceeds `boundary_size` plus `growth` times their
        distance from the boundary. For other sizes by distance see `sizing.sources`.
    turning : float, optional
        Degrees: cells are divided in which the boundary turns by more than this, if any two normals in them
        show it, that is, by more than twice this in any case. At a sharper corner this never ends, so
        that it needs a `max_level`.
    divide : callable, optional
        Called with the centers (k, 2) and the longest edges (k,) of all cells of a level; returns k bools.
        For sizes from an error indicator see `sizing.from_error`, and `Tree.refined`.
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
    Whether the boundary meets a cell is exact for straight pieces. Curves are cut into chords that are nearer
    to them than 1/64 of the smallest cell (and of no less than 1/64 of a cell of level 24); if cells become
    smaller than was foreseen, curves are cut, and the tree is grown, again.

    O(n log n) for n leaves; rules are called once a level. Ten million leaves that a size asks for take
    0.13 GB while the tree grows, 27 MB when it is finished (11 in space), and 17 bytes for each leaf when
    they are first asked for. Sources: R. A. Finkel, J. L. Bentley, *Quad trees*, Acta Informatica 4, 1974;
    H. Sundar, R. S. Sampath, G. Biros, *Bottom-up construction and 2:1 balance refinement of linear octrees
    in parallel*, SIAM J. Sci. Comput. 30, 2008. Book: 4a.
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
    growth: float | None = None,
    turning: float | None = None,
    divide: Callable[[Array, Array], Any] | None = None,
    box: ArrayLike | None = None,
    budget: int = MOST_LEAVES,
    progress: bool = False,
) -> Tree:
    """An octree over a box or over the box around a body: `quadtree` in space.

    Parameters
    ----------
    domain_or_box : Domain in space, Mesh of triangles that close, or array_like of shape (2, 3)
    balance : "corners", "edges", "faces" or None
    max_level : int, optional
        At most 20.
    size, min_level, points, most_points, boundary_size, growth : see `quadtree`
    turning, divide, box, budget, progress : see `quadtree`
        With three coordinates. Where triangles stand for a smooth surface, that is, where
        they turn by at most 40 degrees at an edge, `turning` is that of the surface.

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
    as_flags(progress=options["progress"])
    balance = options["balance"]
    if balance is not None:
        balance = as_across(balance, d, "balance")
    domain = domain_of(domain_or_box, d)
    root = root_of(domain_or_box, domain, options["box"], d)
    deepest = deepest_level(root[0], root[1] - root[0])
    most = deepest if options["max_level"] is None else as_count(options["max_level"], "max_level")
    least = as_count(options["min_level"], "min_level")
    if not least <= most <= deepest:
        raise InputError(
            f"min_level = {least} and max_level = {most} must satisfy min_level <= max_level <= {deepest}"
        )
    limits = Limits(least, most, as_count(options["budget"], "budget"))
    rules = _rules(d, root, deepest, size, options)
    if domain is None:
        for name in ("boundary_size", "growth", "turning"):
            if options[name] is not None:
                raise InputError(f"{name} needs a domain, not a box")
        boundary, growth = None, grow(root, rules, limits, progress=options["progress"])
    else:
        boundary, growth = _grown_within(domain, root, rules, limits, options)
    linear = growth.tree if balance is None else balanced(growth.tree, balance)
    tree = Tree(linear, root, balance)
    tree.domain, tree.boundary = domain, boundary
    return _told(tree, growth)


def _grown_within(
    domain: Domain, root: Array, rules: list[Rule], limits: Limits, options: dict[str, Any]
) -> tuple[Boundary, Growth]:
    """The tree over a domain; if it has curves, with chords that are short enough for the smallest cells."""
    side = float((root[1] - root[0]).max())
    angle = options["turning"]
    turn = np.inf if angle is None else float(np.deg2rad(min(positive(angle, "turning"), 360.0)))
    level = limits.most if limits.most <= DIRECT_LEVEL else SMOOTH_LEVEL
    for _ in range(CUTS_OF_CURVES):
        bits = min(level + DEVIATION_BITS, FINEST_BITS)
        boundary = bounded(domain, root, side / (1 << bits), turn / CHORDS_PER_ANGLE)
        inner = [*rules, *_rules_of_boundary(boundary, domain, turn, options)]
        growth = grow(root, inner, limits, boundary=boundary, progress=options["progress"])
        if not boundary.deviation or bits == FINEST_BITS or growth.tree.depth <= level:
            break
        level = growth.tree.depth
    return boundary, growth


def _rules(d: int, root: Array, deepest: int, size: Any, options: dict[str, Any]) -> list[Rule]:
    """The rules that need no boundary."""
    rules: list[Rule] = []
    if size is not None:
        rules.append(by_size(as_size(size)))
    if options["points"] is not None:
        rules.append(_counted(d, root, deepest, options["points"], options["most_points"]))
    as_count(options["most_points"], "most_points")
    if options["divide"] is not None:
        if not callable(options["divide"]):
            raise InputError(f"divide must be a function, not {type(options['divide']).__name__}")
        rules.append(by_function(options["divide"]))
    return rules


def _rules_of_boundary(
    boundary: Boundary, domain: Domain, turn: float, options: dict[str, Any]
) -> list[Rule]:
    """The rules that the boundary decides."""
    rules: list[Rule] = []
    wanted, growth = options["boundary_size"], options["growth"]
    if wanted is not None:
        wanted = positive(wanted, "boundary_size")
        rules.append(by_boundary(wanted))
    if growth is not None:
        if wanted is None:
            raise InputError("growth goes with boundary_size, the size at the boundary")
        if finite(growth, "growth") < 0:
            raise InputError(f"growth must be at least 0, not {growth!r}")
        rules.append(by_distance(boundary, wanted, float(growth)))
    if turn < np.inf:
        rules.append(by_turning(bending_of(boundary, domain), boundary, turn))
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


def _told(tree: Tree, growth: Growth) -> Tree:
    """The tree, which knows what was refused."""
    if not growth.refused:
        return tree
    first = np.concatenate(
        [keys << np.uint64(tree.dimension * (tree.depth - level)) for level, keys in growth.refused.items()]
    )
    tree.complete, tree.reason = False, f"further divisions were refused: {growth.reason}"
    leaves = leaves_of(tree.linear)
    tree.unfinished = frozen(np.sort(np.searchsorted(leaves.first, first)))
    warn(
        f"{len(tree.unfinished):,} leaves are not divided as asked: {growth.reason}",
        IncompleteWarning,
        stacklevel=4,
    )
    return tree
