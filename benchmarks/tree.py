"""The suite ``tree``: quadtrees and octrees beside discretize, and meshes from them.

*Build.* A size that grows from a point is asked where the method wants to, the tree is divided, balanced
across faces, edges and corners, and its leaves are listed. TreeMesh of `discretize` is not asked for the
size: it is given the leaves before balance, centers and levels, as arrays, and builds and balances
(``insert_cells(..., finalize=False)``). Rows have a checksum of all leaves, so that the report can tell
whether they are the same.

*Locate.* The leaves that contain a million random points, in trees of a million leaves. discretize has been
finalized before, and our table been made.

*Conforming.* Triangles or tetrahedra by templates, from the leaves to a mesh with checked arrays.

*Growth.* As build, from ten thousand to ten million leaves: a row for each decade.

*Boundary*, *stuffing*, *fields* and *hexahedra*. Meshes of regions and bodies: `tree_meshes`, `stuffing`,
`tree_cubes`.
"""

from __future__ import annotations

from typing import Any, NamedTuple
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from . import stuffing, tree_cubes, tree_meshes
from .meshers import Mesher, several
from .run import Workers, measured

Array = NDArray[np.float64]
# work -> kind -> the rough numbers of leaves
PLAN: dict[str, dict[str, tuple[int, ...]]] = {
    "build": {kind: (1_000_000,) for kind in ("plane", "space")},
    "growth": {kind: (10_000, 100_000, 1_000_000, 10_000_000) for kind in ("plane", "space")},
    "locate": {kind: (1_000_000,) for kind in ("plane", "space")},
    "conforming": {"plane": (100_000, 1_000_000), "space": (10_000, 100_000)},  # 12.6 tetrahedra to a leaf
    **tree_meshes.PLAN,
    **stuffing.PLAN,
    **tree_cubes.PLAN,
}
# the modules of works that are not in this one
MODULES: dict[str, Any] = {
    work: module for module in (tree_meshes, stuffing, tree_cubes) for work in module.PLAN
}
ONCE = {"fields"}  # works whose rows are about what is made, not about its time
DIMENSION = {"plane": 2, "space": 3}
CENTER = np.array([0.3, 0.4, 0.45])
NEAREST = 0.02  # the size at the center, in units of its growth
LEAVES = {"plane": 31.6, "space": 82.0}  # times the growth to minus the dimension: the number of leaves
QUERIES = 1_000_000
FEW = 1_000  # leaves, and points, of tasks that load compiled code
PEER_MOST = 3_000_000  # leaves: beyond, discretize takes minutes
__all__ = ["MESHERS", "PLAN", "Planted", "measures", "run", "task", "warm_up"]


class Planted(NamedTuple):
    """A task: a size over the unit square or cube; and, where it is needed, what has been built before."""

    dimension: int
    growth: float
    tree: Any = None
    peer: Any = None
    points: Array | None = None

    @property
    def box(self) -> Array:
        """Two corners of the root."""
        return np.array([[0.0] * self.dimension, [1.0] * self.dimension])

    def size(self, x: Array) -> Array:
        """The wanted edge length."""
        square = np.zeros(len(x))
        for column, middle in zip(x.T, CENTER):
            square += (column - middle) ** 2
        return self.growth * (NEAREST + np.sqrt(square))


def _plant(given: Planted, balance: str | None) -> Any:
    from unstruct import octree, quadtree

    return (quadtree if given.dimension == 2 else octree)(given.box, given.size, balance=balance)


# ---------------------------------------------------------------------- the contestants


def _built(given: Planted) -> Any:
    tree = _plant(given, "corners")
    assert len(tree.leaves.keys) == len(tree)
    return tree, None


def _inserted(given: Planted) -> Any:
    """A TreeMesh that is not finalized."""
    import discretize

    before = given.tree
    side = 1 << before.depth
    mesh = discretize.TreeMesh([np.full(side, 1.0 / side)] * given.dimension, diagonal_balance=True)
    mesh.insert_cells(np.array(before.centers), before.levels.astype(np.int64), finalize=False)
    return mesh


def _built_by_discretize(given: Planted) -> Any:
    return _inserted(given), None


def _located(given: Planted) -> Any:
    return given.tree, given.tree.locate(given.points)


def _located_by_discretize(given: Planted) -> Any:
    return given.peer, given.peer.get_containing_cells(given.points)


def _conforming(given: Planted) -> Any:
    from unstruct import Tree

    fresh = Tree(given.tree.linear, given.tree.box, given.tree.balance)
    return fresh, fresh.mesh("conforming")


MESHERS = [
    *(
        mesher
        for work in ("build", "growth")
        for mesher in (
            Mesher("unstruct", "unstruct", work, several(_built)),
            Mesher("discretize", "discretize", work, several(_built_by_discretize)),
        )
    ),
    Mesher("unstruct", "unstruct", "locate", several(_located)),
    Mesher("discretize", "discretize", "locate", several(_located_by_discretize)),
    Mesher("unstruct", "unstruct", "conforming", several(_conforming)),
    *tree_meshes.MESHERS,
    *stuffing.MESHERS,
    *tree_cubes.MESHERS,
]


# ---------------------------------------------------------------------- the run


def task(work: str, kind: str, n: int) -> Any:
    """What the contestants of a work are given."""
    if work in MODULES:
        return MODULES[work].task(work, kind, n)
    d = DIMENSION[kind]
    given = Planted(d, (LEAVES[kind] / n) ** (1 / d))
    if work in ("build", "growth"):
        return given._replace(tree=_plant(given, None)) if n < PEER_MOST else given
    given = given._replace(tree=_plant(given, "corners"))
    if work == "locate":
        x = np.random.default_rng(0).random((QUERIES if n > FEW else FEW, d))
        given = given._replace(points=x, peer=_finalized(given))
        given.tree.locate(x[:1])
    return given


def _finalized(given: Planted) -> Any:
    try:
        mesh = _inserted(given)
    except ImportError:
        return None
    mesh.finalize()
    return mesh


def warm_up(work: str) -> Any:
    """Small tasks of the same kind, in the plane and in space: compiled code is loaded."""
    if work in MODULES:
        return MODULES[work].warm_up(work)
    return [task(work, "plane", FEW), task(work, "space", FEW)]


def leaves_of(tree: Any) -> tuple[Array, NDArray[np.int64]]:
    """Centers and levels, sorted, of a Tree or of a TreeMesh."""
    if hasattr(tree, "locate"):
        centers, levels = tree.centers, tree.levels.astype(np.int64)
    else:
        if not tree.finalized:
            tree.finalize()
        centers = tree.cell_centers
        levels = np.asarray(tree.cell_levels_by_index(np.arange(tree.n_cells)), dtype=np.int64)
    order = np.lexsort(centers.T)
    return np.ascontiguousarray(centers[order]), levels[order]


def measures(result: Any, found: Any, work: str, given: Any) -> dict[str, Any]:
    """What was made, as numbers that must agree."""
    if work in MODULES:
        return MODULES[work].measures(result, found, work, given)
    if work in ("build", "growth"):
        if given.tree is None:  # nobody to compare with
            return {"cells": len(result)}
        centers, levels = leaves_of(result)
        return {"cells": len(levels), "checksum": crc32(centers.tobytes(), crc32(levels.tobytes()))}
    if work == "locate":
        centers = result.centers if hasattr(result, "locate") else result.cell_centers
        at = np.ascontiguousarray(centers[found])
        return {"cells": len(found), "leaves": len(centers), "checksum": crc32(at.tobytes())}
    least = "min_angle" if given.dimension == 2 else "min_dihedral"
    return {"cells": found.size, "leaves": len(result), "least": float(found.quality(least).min())}


def run(workers: Workers, largest: int, repeats: int) -> list[dict[str, Any]]:
    """All rows of the suite, up to ``largest`` leaves."""
    rows: list[dict[str, Any]] = []
    for work, kinds in PLAN.items():
        names = [mesher.name for mesher in MESHERS if mesher.work == work]
        for kind, sizes in kinds.items():
            for n in sizes:
                if n <= largest:
                    some = [name for name in names if name == "unstruct" or n < PEER_MOST]
                    case = {"suite": "tree", "work": work, "kind": kind, "n": n}
                    times = 1 if work in ONCE else repeats
                    rows += measured(workers, "meshed", case, dict.fromkeys(some, 0.0), times)
    return rows
