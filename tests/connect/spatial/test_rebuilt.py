"""A complex made anew: Delaunay cells, the same faces, numbers, marks and regions."""

from __future__ import annotations

import numpy as np
import solids

from unstruct.connect.spatial.complex import SpatialComplex
from unstruct.connect.spatial.rebuilt import rebuilt

NONE = np.empty(0, dtype=np.int32)


def recovered(points: np.ndarray, triangles: np.ndarray) -> SpatialComplex:
    cells = SpatialComplex(points)
    assert cells.recover(triangles).exact
    cells.flood()
    return cells


def marked(cells: SpatialComplex) -> set[tuple[int, ...]]:
    faces = cells.mark[: 4 * cells.slots].reshape(-1, 4)
    rows = cells.vertex[: 4 * cells.slots].reshape(-1, 4)
    found = set()
    for t in np.flatnonzero(cells.used()).tolist():
        for k in range(4):
            if faces[t, k] >= 0:
                face = sorted(np.delete(rows[t], k).tolist())
                found.add((*face, int(faces[t, k]), int(cells.region[t])))
    return found


def test_the_same_surface() -> None:
    rng = np.random.default_rng(2)
    points, triangles = solids.torus(24, 10)
    points = np.vstack([points, 0.1 * rng.normal(size=(40, 3)) + points[:40]])
    cells = recovered(points, triangles)
    new = rebuilt(cells, NONE.reshape(0, 2), NONE)
    assert new is not None
    new.validate()
    assert marked(new) == marked(cells) and (new.at[: len(points)] >= 0).all()
    assert np.array_equal(new.xyz[: len(points)], cells.xyz[: len(points)])


def test_without_a_vertex() -> None:
    points, triangles = solids.torus(24, 10)
    inside = np.asarray(points)[:10].mean(axis=0)
    cells = recovered(np.vstack([points, [inside]]), triangles)
    new = rebuilt(cells, NONE.reshape(0, 2), np.array([len(points)], dtype=np.int32))
    assert new is not None and new.at[len(points)] == -1
    new.validate()
    assert marked(new) == marked(cells)
