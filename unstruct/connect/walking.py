"""The cells of a planar mesh that contain points: by a walk from cell to cell, else by the tree."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..base.jit import kernel
from ..geometry.ordering import hilbert_order
from ..mesh.mesh import Mesh, is_planar
from ..predicates.batch import orient_rows, scaled
from ..predicates.kernels import orient2

__all__ = ["cells_at"]

STEPS_OF_WALK = 200  # of a walk between queries that follow each other along a curve, before it is given up
FEW_QUERIES = 1000  # up to so many queries the tree finds as soon


@kernel
def _walk(xy, simplices, neighbors, rows, found):
    """For each row a closed triangle that contains it; -1 where the walk is long or ends at the boundary."""
    t = np.int64(0)
    for i in range(rows.shape[0]):
        x, y, last, steps = rows[i, 0], rows[i, 1], np.int64(-1), 0
        while True:
            out = np.int64(-1)
            for k in range(3):
                u = neighbors[t, k]
                if u == last and u >= 0:
                    continue
                a, b = simplices[t, (k + 1) % 3], simplices[t, (k + 2) % 3]
                if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], x, y) < 0:
                    out = u if u >= 0 else np.int64(-2)
                    break
            if out < 0 or steps == STEPS_OF_WALK:
                found[i] = t if out == -1 else -1
                break
            last, t, steps = t, out, steps + 1


def cells_at(mesh: Mesh, rows: NDArray[np.float64]) -> NDArray[np.int32]:
    """A closed cell that contains each point, -1 outside of the mesh; exact.

    Parameters
    ----------
    mesh : Mesh
        Positively oriented triangles of the plane; for other meshes `Mesh.find_simplex` is called.
    rows : (q, d) array
        Finite coordinates.

    Notes
    -----
    In a Delaunay mesh a walk cannot return to a triangle. In others, and where there are holes, a walk that
    ends nowhere costs a look into the tree.
    """
    found = np.full(len(rows), -1, dtype=np.int32)
    if len(rows) > FEW_QUERIES and is_planar(mesh):
        xy, exact = scaled(mesh.points)
        factor = float(np.abs(xy).max() / np.abs(mesh.points).max()) if exact else 1.0
        with np.errstate(over="ignore", under="ignore"):
            near = rows * factor
            good = exact & (np.abs(near) <= 1.0).all(axis=1) & (near / factor == rows).all(axis=1)
        chosen = np.flatnonzero(good)
        if len(chosen):
            chosen = chosen[hilbert_order(near[chosen])]
            place = np.empty(len(chosen), dtype=np.int32)
            _walk(xy, mesh.simplices, mesh.neighbors, near[chosen], place)
            at = np.flatnonzero(place >= 0)
            flat = orient_rows(mesh.points, mesh.simplices[place[at]]) <= 0  # such cells contain nothing
            place[at[flat]] = -1
            found[chosen] = place
    missing = np.flatnonzero(found < 0)
    found[missing] = mesh.find_simplex(rows[missing])
    return found
