"""What is mended of triangles before they are remeshed: repeated and flat ones, and directions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.embedded import flat_rows
from ...geometry.inside_shell import triangle_components
from ...geometry.support_features import same_points, side_groups
from ...mesh.mesh import Mesh

__all__ = ["Cleaned", "broken_edges", "cleaned"]


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


def cleaned(surface: Any, *, flat: bool = False) -> Cleaned:
    """The surface; of a mesh each triangle once, and all parts turned alike where that is possible.

    A part, which hangs together over edges of two triangles, is turned as its first triangle. A part with one
    side, such as Moebius' strip, stays as it is given if that is turned alike at no fewer edges.
    """
    if not isinstance(surface, Mesh) or list(surface.cells) != ["triangle"] or surface.points.shape[1] != 3:
        return Cleaned(surface, {}, {}, {})
    same = same_points(surface.points)
    rows = same[surface.simplices]
    whole = (rows != np.roll(rows, 1, axis=1)).all(axis=1)
    kept = np.zeros(len(rows), dtype=bool)
    kept[np.unique(np.sort(rows, axis=1), axis=0, return_index=True)[1]] = True
    repeated = whole & ~kept
    hanging = _hanging(surface, same, rows, whole & kept) if flat else np.zeros(len(rows), dtype=bool)
    gone = repeated | hanging
    triangles = np.array(surface.simplices)[~gone]
    turned = np.zeros(len(triangles), dtype=bool)
    real = np.flatnonzero(whole[~gone])
    turned[real] = _against(same[triangles[real]])
    triangles[turned] = triangles[turned][:, [0, 2, 1]]
    used = np.unique(surface.simplices)
    found = surface
    if gone.any() or turned.any():
        markers = {
            name: values[~gone] if values.ndim == 1 else values for name, values in surface.markers.items()
        }
        found = Mesh(surface.points, triangles, markers=markers, regions=surface.regions)
    counts = {
        "equal points": int((same[used] != used).sum()),
        "degenerate triangles": int((~whole).sum() + hanging.sum()),
        "repeated triangles": int(repeated.sum()),
        "turned triangles": int(turned.sum()),
    }
    vertices = {
        name: same[np.unique(values)] for name, values in surface.markers.items() if values.shape[1:] == (1,)
    }
    return Cleaned(found, counts, vertices, surface.regions)


def _hanging(
    surface: Mesh, same: NDArray[np.int64], rows: NDArray[np.int64], sound: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """The flat triangles with two or three sides of no other one, and no name at them; but never all."""
    gone = np.zeros(len(rows), dtype=bool)
    among = np.flatnonzero(sound)
    flat = among[flat_rows(surface.points, rows[among])]
    if len(flat) in (0, len(among)):
        return gone
    named = [same[values] for values in surface.markers.values() if values.ndim == 2]
    held = {tuple(sorted(row)) for values in named for row in values.tolist()}
    used = Counter(side for row in rows[among].tolist() for side in _sides(row))
    todo = flat.tolist()
    while todo:
        rest = []
        for t in todo:
            row = rows[t].tolist()
            free = [side for side in _sides(row) if used[side] == 1]
            parts = [*free, tuple(sorted(row)), *((v,) for v in row)]
            if len(free) > 1 and not held.intersection(parts):
                gone[t] = True
                used.subtract(_sides(row))
            else:
                rest.append(t)
        if len(rest) == len(todo):
            break
        todo = rest
    return gone


def _sides(row: list[int]) -> list[tuple[int, int]]:
    a, b, c = sorted(row)
    return [(a, b), (b, c), (a, c)]


def _against(rows: NDArray[np.int64]) -> NDArray[np.bool_]:
    """The triangles to be turned."""
    part, against, count = triangle_components(rows)
    other = rows.copy()
    other[against] = rows[against][:, [0, 2, 1]]
    before, after = broken_edges(rows, part, count), broken_edges(other, part, count)
    return against & ~((after > 0) & (before <= after))[part]


def broken_edges(rows: NDArray[np.int64], part: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """At how many edges of each part just two triangles meet and run in the same direction."""
    place, _, size = side_groups(rows)
    ends = rows.ravel()
    last = np.cumsum(size)[size == 2] - 1
    one, two = place[last - 1], place[last]
    return np.bincount(part[one[ends[one] == ends[two]] // 3], minlength=count)
