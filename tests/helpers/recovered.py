"""Judge what a recovery in space says of itself."""

from __future__ import annotations

import numpy as np

from unstruct.connect.spatial.complex import Recovered, SpatialComplex


def judge(c: SpatialComplex, triangles: np.ndarray, found: Recovered) -> None:
    """The complex is valid, and holds what the result does not say is missing."""
    c.validate()
    cells = c.cells()
    faces = {tuple(row) for k in range(4) for row in np.sort(np.delete(cells, k, axis=1), axis=1).tolist()}
    whole = [tuple(row) in faces for row in np.sort(triangles, axis=1).tolist()]
    if found.exact:
        assert all(whole)
    parts = c.given_parts
    assert parts is not None
    alive = parts.corner[: parts.count][parts.alive[: parts.count]]
    roots = parts.root[: parts.count][parts.alive[: parts.count]]
    missing = {
        int(r)
        for r, row in zip(roots, np.sort(alive, axis=1).tolist(), strict=True)
        if tuple(row) not in faces
    }
    assert missing == set(found.triangles.tolist())
