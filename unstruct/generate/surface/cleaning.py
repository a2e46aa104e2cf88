"""What is mended of a mesh of triangles before it is remeshed: repeated triangles, and their directions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.inside_shell import triangle_components
from ...geometry.support_features import same_points
from ...mesh.mesh import Mesh

__all__ = ["Cleaned", "cleaned"]


class Cleaned(NamedTuple):
    """A surface without what is repeated.

    Attributes
    ----------
    surface : Domain or Mesh
        Its points are those of what was given.
    counts : dict of str to int
        What was wrong.
    vertices : dict of str to (k,) array
        Vertices by name.
    regions : mapping
        The numbers of regions that have a name.
    """

    surface: Any
    counts: dict[str, int]
    vertices: dict[str, NDArray[np.int64]]
    regions: Mapping[str, int]


def cleaned(surface: Any) -> Cleaned:
    """The surface; of a mesh each triangle once, and all parts turned alike where that is possible.

    A part, which hangs together over edges of two triangles, is turned as its first triangle.
    """
    if not isinstance(surface, Mesh) or list(surface.cells) != ["triangle"] or surface.points.shape[1] != 3:
        return Cleaned(surface, {}, {}, {})
    same = same_points(surface.points)
    rows = same[surface.simplices]
    whole = (rows != np.roll(rows, 1, axis=1)).all(axis=1)
    kept = np.zeros(len(rows), dtype=bool)
    kept[np.unique(np.sort(rows, axis=1), axis=0, return_index=True)[1]] = True
    repeated = whole & ~kept
    triangles = np.array(surface.simplices)[~repeated]
    turned = np.zeros(len(triangles), dtype=bool)
    real = np.flatnonzero(whole[~repeated])
    turned[real] = triangle_components(same[triangles[real]])[1]
    triangles[turned] = triangles[turned][:, [0, 2, 1]]
    used = np.unique(surface.simplices)
    found = surface
    if repeated.any() or turned.any():
        markers = {
            name: values[~repeated] if values.ndim == 1 else values
            for name, values in surface.markers.items()
        }
        found = Mesh(surface.points, triangles, markers=markers, regions=surface.regions)
    counts = {
        "equal points": int((same[used] != used).sum()),
        "degenerate triangles": int((~whole).sum()),
        "repeated triangles": int(repeated.sum()),
        "turned triangles": int(turned.sum()),
    }
    vertices = {
        name: same[np.unique(values)] for name, values in surface.markers.items() if values.shape[1:] == (1,)
    }
    return Cleaned(found, counts, vertices, surface.regions)
