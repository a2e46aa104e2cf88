"""What a mesh of cut cubes lacks of a body, or fills beside it: by distance, and by how it is connected.

See the book, chapter 4c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.triangle_tree import TriangleTree
from ...mesh import topology
from ..stuffing.ending import FAR_FROM_MESH, missing_parts, nearest_on, pinched_vertices
from ..tree.cells import TreeCells
from ..tree.contacts import CUT
from ..tree.lookup import located

__all__ = ["connected_otherwise", "lost_or_filled"]

Array = NDArray[np.float64]
LOST_OR_FILLED = "the body, or the gap beside it, is thinner than the leaves, and lost or filled"
PLACES_IN_LEAF = (0.25, 0.75)  # of a leaf along each axis: together a lattice of half the side


def lost_or_filled(
    tree: TreeCells,
    shell: tuple[Array, NDArray[np.integer]],
    mesh: tuple[Array, NDArray[np.int32], NDArray[np.int64]],
) -> tuple[dict[int, str], float]:
    """The cells beside which the surface of the body is far from the mesh's boundary, and why.

    Parameters
    ----------
    tree : TreeCells
        An octree.
    shell : (points, triangles)
        The body's surface.
    mesh : (points, faces, cell)
        The vertices of the mesh, its boundary faces, and their cells.

    Returns
    -------
    dict of cell to reason
        The reasons tell the place. If the boundary is not connected as the surface is, the cell nearest to
        the farthest place says so.
    float
        The largest distance of a place of the surface from the mesh's boundary, in sides of the leaf there.

    Notes
    -----
    The surface is looked at in all its vertices, and in its places nearest to 8 places of each leaf that it
    meets. Distances tell parts that are lost and gaps that are filled by more than 0.8 of a leaf, as in
    `isosurface_stuffing`; edges and corners that are cut off at right angles are nearer. Euler
    characteristics and numbers of components tell also bodies in pieces, and narrow gaps in which only
    vertices are free. O(n log n).
    """
    x, side = _samples(tree, *shell)
    points, faces, cell = mesh
    missing, most = missing_parts((x, side), points, faces, cell, FAR_FROM_MESH)
    reasons = {row: f"{LOST_OR_FILLED},{_near(*found)}" for row, found in missing.items()}
    why = connected_otherwise(shell, (points, faces))
    if why:
        farthest, _ = missing_parts((x, side), points, faces, cell, -1.0)
        row = max(farthest, key=lambda k: farthest[k][0])
        reasons.setdefault(row, f"{LOST_OR_FILLED}: {why}; the farthest place is{_near(*farthest[row])}")
    return reasons, most


def _near(gap: float, place: Array) -> str:
    return f" near ({', '.join(f'{x:.6g}' for x in place)}), {gap:.2f} leaves away"


def _samples(tree: TreeCells, points: Array, triangles: NDArray[np.integer]) -> tuple[Array, Array]:
    """Places of the surface, and the sides of the leaves that they are in."""
    met = tree.states == CUT
    low, high = (np.asarray(ends)[met] for ends in tree.corners)
    steps = np.stack(np.meshgrid(*[PLACES_IN_LEAF] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    lattice = (low[:, None] + steps * (high - low)[:, None]).reshape(-1, 3)
    corners = points[triangles]
    which, _ = TriangleTree(corners).nearest(lattice)
    x = np.concatenate([points[np.unique(triangles)], nearest_on(lattice, corners, which)])
    leaf = located(tree.grid, np.clip(x, tree.box[0], np.nextafter(tree.box[1], tree.box[0])))
    return x, np.asarray(tree.sides)[leaf]


def connected_otherwise(one: tuple[Array, NDArray], other: tuple[Array, NDArray]) -> str:
    """Why two closed surfaces are not connected in the same way, or "" if they seem to be.

    Nothing is said if the first one touches itself in edges or vertices: cells part there.
    """
    if len(pinched_vertices(one[1].astype(np.int32), len(one[0]))):
        return ""
    parts, euler = zip(*(_connection(faces) for _, faces in (one, other)), strict=True)
    if parts == parts[::-1] and euler == euler[::-1]:
        return ""
    return (
        f"the boundary has {parts[1]} components and Euler characteristic {euler[1]}, the body's surface has "
        f"{parts[0]} and {euler[0]}"
    )


def _connection(triangles: NDArray[np.integer]) -> tuple[int, int]:
    """The number of components and the Euler characteristic of a closed surface."""
    faces = triangles.astype(np.int32)
    count, _ = topology.components(topology.neighbors(faces))
    return count, len(np.unique(faces)) - len(faces) // 2
