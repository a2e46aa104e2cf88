"""A point moves through a mesh of six tetrahedra; a facet of its cavity is hidden (section 2.2b)."""

from __future__ import annotations

from functools import lru_cache
from itertools import combinations

import numpy as np

from ...connect.baker.fixed import cavities, hidden_facets
from ...connect.baker.modernized import insert
from ...mesh.mesh import Mesh
from ..draw import frames as fr
from ..draw.items import item3
from .choices import within
from .space_frames import bodies, space_frame

__all__ = ["HIDING_CELLS", "HIDING_POINTS", "hidden_facet_state", "hiding_mesh", "hiding_place"]

HIDING_POINTS = ((0, 0, 1), (0, 1, 0), (3, 2, 1), (3, 2, 2), (1, 3, 3), (1, 2, 2))
HIDING_CELLS = ((0, 1, 2, 3), (0, 1, 3, 5), (0, 1, 4, 5), (0, 3, 4, 5), (1, 2, 3, 4), (1, 3, 4, 5))
FIRST_OF_P, LAST_OF_P = 0.05, 0.95


@lru_cache(maxsize=1)
def hiding_mesh() -> Mesh:
    """Six points and six tetrahedra that fill their hull, not Delaunay."""
    return Mesh(np.array(HIDING_POINTS, dtype=float), HIDING_CELLS).oriented()


def hiding_place(place: float) -> np.ndarray:
    """The point P on the segment from vertex 4 (place 0) to the middle of the triangle 1 2 3 (place 1)."""
    points = hiding_mesh().points
    return (1.0 - place) * points[4] + place * points[[1, 2, 3]].mean(axis=0)


def hidden_facet_state(place: float = 0.5, seen_from: float = -100.0) -> fr.Frame:
    """The principal component of P, its facets that P does not see, and the cells that are replaced.

    Parameters
    ----------
    place : float
        Of P, between 0.05 (near vertex 4) and 0.95 (near the face 1 2 3 of the tetrahedron 1 2 3 4).
    seen_from : float
        The direction from which the reader looks, in degrees.

    Returns
    -------
    dict
        A frame; its number counts the cells of the component, hidden facets, and the cells that are deleted.
    """
    within("place", place, FIRST_OF_P, LAST_OF_P)
    mesh, p = hiding_mesh(), hiding_place(place)
    component = cavities(mesh, p).gamma_component
    hidden = hidden_facets(mesh, component, p)
    after = {frozenset(cell) for cell in insert(mesh, p).simplices.tolist()}
    gone = [c for c in component.tolist() if frozenset(mesh.simplices[c].tolist()) not in after]
    spared = np.setdiff1d(component, gone)
    faces = [np.delete(mesh.simplices[c], k).tolist() for c, k in hidden.tolist()]
    edges = sorted({tuple(sorted(pair)) for cell in HIDING_CELLS for pair in combinations(cell, 2)})
    scene = [
        bodies("cavity", mesh.simplices[gone], mesh.points, shrink=1.0, opacity=0.35),
        bodies("bad", mesh.simplices[spared], mesh.points, shrink=1.0, opacity=0.3),
        item3("polygons", "highlight", faces, mesh.points, opacity=0.7),
        item3("segments", "muted", edges, mesh.points),
        item3("labels", "vertex", mesh.points, text=range(len(mesh.points))),
        item3("points", "inserted", [p]),
    ]
    named = [" ".join(map(str, sorted(face))) for face in faces]
    caption = "all facets are seen" if not named else f"hidden from P: {', '.join(named)}"
    number = f"component = {len(component)}, hidden facets = {len(faces)}, replaced = {len(gone)}"
    return space_frame(scene, caption, number=number, azimuth=seen_from, elevation=15)
