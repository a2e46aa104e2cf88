"""What a mesh lacks of a body, or fills beside it: by distance, and by how its boundary is connected.

Both methods in space that see a body at the vertices of a lattice only, stuffing and cut cubes, give this
account. See the book, chapter 4c.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.triangle_tree import TriangleTree
from ...mesh import topology
from ...predicates.batch import power_of_two
from .ending import pinched_vertices

__all__ = ["FAR_FROM_MESH", "connected_otherwise", "lost_or_filled"]

Array = NDArray[np.float64]
Surface = tuple[Array, NDArray[np.integer]]
FAR_FROM_MESH = 0.8  # of a cell: a crease or a corner that is cut off is nearer (see the tests)
LOST_OR_FILLED = "the body, or the gap beside it, is thinner than a {}, and lost or filled"
FACES_OF_COMPONENT = 64  # by so many faces of a component of the boundary it is told what it is near to


def lost_or_filled(
    samples: tuple[Array, Array],
    shell: Surface,
    mesh: tuple[Array, NDArray[np.int32], NDArray[np.int64]],
    unit: str,
) -> tuple[dict[int, str], float]:
    """The cells beside which the surface of the body is far from the mesh's boundary, and why.

    Parameters
    ----------
    samples : (x, side)
        Points of the surface (k, 3), and the sides of the leaves there (k,).
    shell : (points, triangles)
        The body's surface.
    mesh : (points, faces, cell)
        The vertices of the mesh, its boundary faces, and their cells.
    unit : str
        What the side is one of: "cell" or "leaf".

    Returns
    -------
    dict of cell to reason
        The reasons tell the place. For each component of the surface beside which the boundary is connected
        in another way, the cell nearest to its farthest place says so.
    float
        The largest distance of a sample from the mesh's boundary, in sides.

    Notes
    -----
    Distances tell parts that are lost and gaps that are filled by more than `FAR_FROM_MESH`; edges and
    corners that are cut off at right angles are nearer. Euler characteristics and numbers of components tell
    bodies in pieces, lost cavities, tunnels and handles, and narrow gaps in which only vertices are free.
    O(n log n).
    """
    points, faces, cell = mesh
    which, gap = _gaps(samples, points[faces])
    far = np.flatnonzero(gap > FAR_FROM_MESH)
    far = far[np.argsort(gap[far], kind="stable")]
    farthest = dict(zip(cell[which[far]].tolist(), far.tolist(), strict=True))  # the last one of each counts
    lost, units = LOST_OR_FILLED.format(unit), "leaves" if unit == "leaf" else f"{unit}s"
    reasons = {row: f"{lost},{_near(samples[0][i], gap[i], units)}" for row, i in farthest.items()}
    differ = connected_otherwise(shell, (points, faces))
    if differ:
        label = _components(shell[1])
        of_sample = label[TriangleTree(shell[0][shell[1]]).nearest(samples[0])[0]]
        for component, why in differ.items():
            here = np.flatnonzero(of_sample == component)
            here = np.arange(len(gap)) if len(here) == 0 else here
            i = int(here[np.argmax(gap[here])])
            row = int(cell[which[i]])
            text = f"{why}; the farthest place is{_near(samples[0][i], gap[i], units)}"
            reasons[row] = f"{reasons[row]}; {text}" if row in reasons else f"{lost}: {text}"
    return reasons, float(gap.max(initial=0.0))


def _near(place: Array, gap: Any, units: str) -> str:
    return f" near ({', '.join(f'{x:.6g}' for x in place)}), {gap:.2f} {units} away"


def _gaps(samples: tuple[Array, Array], corners: Array) -> tuple[NDArray[np.int64], Array]:
    """For each sample the nearest triangle, and how far that is, in sides."""
    x, side = samples
    which, weight = TriangleTree(corners).nearest(x)
    factor = power_of_two(x)  # squares in very small units would be zero
    away = (x - (weight[:, :, None] * corners[which]).sum(axis=1)) * factor
    return which, np.sqrt((away * away).sum(axis=1)) / (side * factor)


def _components(triangles: NDArray[np.integer]) -> NDArray[np.int64]:
    """The component of each triangle of a closed surface."""
    return topology.components(topology.neighbors(triangles.astype(np.int32)))[1].astype(np.int64)


def _eulers(triangles: NDArray[np.integer], label: NDArray[np.int64]) -> NDArray[np.int64]:
    """The Euler characteristics of the components: each vertex is in one of them only."""
    count = np.bincount(label)
    first = np.unique(triangles, return_index=True)[1]
    return np.bincount(label[first // 3], minlength=len(count)) - count // 2


def connected_otherwise(one: Surface, other: Surface) -> dict[int, str]:
    """Beside which components of a closed surface another one is connected in another way, and how.

    Nothing is said if one of them touches itself in edges or vertices.

    Parameters
    ----------
    one, other : (points, triangles)
        The body's surface, and the boundary of its mesh.

    Returns
    -------
    dict of int to str
        By the numbers of components of the first one. A component of the boundary belongs to that to which
        most of its faces are nearest.
    """
    for points, triangles in (one, other):
        if len(pinched_vertices(triangles.astype(np.int32), len(points))):
            return {}
    label, found = _components(one[1]), _components(other[1])
    wanted, euler = _eulers(one[1], label), _eulers(other[1], found)
    start = np.searchsorted(np.sort(found), np.arange(len(euler)))
    order = np.argsort(found, kind="stable")
    rank = np.arange(len(found)) - start[found[order]]
    size = np.bincount(found)[found[order]]
    asked = order[rank % np.maximum(1, size // FACES_OF_COMPONENT) == 0]
    middles = other[0][other[1][asked]].mean(axis=1)
    beside = label[TriangleTree(one[0][one[1]]).nearest(middles)[0]]
    table = np.zeros((len(euler), len(wanted)), dtype=np.int64)
    np.add.at(table, (found[asked], beside), 1)
    owner = table.argmax(axis=1)
    count = np.bincount(owner, minlength=len(wanted))
    total = np.zeros(len(wanted), dtype=np.int64)
    np.add.at(total, owner, euler)
    return {
        k: f"the boundary there has {count[k]} components and Euler characteristic {total[k]}, the body's "
        f"surface has 1 and {wanted[k]}"
        for k in np.flatnonzero((count != 1) | (total != wanted)).tolist()
    }
