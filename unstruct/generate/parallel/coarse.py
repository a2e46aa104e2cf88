"""The coarse triangles of which parts consist: few, graded to the boundary, with their predicted cells."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import MOST_VERTICES
from ...base.errors import IncompleteWarning, InputError
from ...domain.derived import held_by
from ...domain.domain import Domain, as_domain
from ...domain.plane.sample import Sampled
from ...mesh.domain_mesh import DomainMesh
from ...sizing.field import SizeField, as_size
from ...sizing.metric import Metric
from ...sizing.source_sizes import sources
from ..rebay.voronoi_segment import voronoi_segment

__all__ = ["Coarse", "by_part", "coarse_triangles", "predicted"]

COARSE_TRIANGLES = 400  # coarse triangles a part, at least, where there are so many cells
COARSE_GROWTH = 0.4  # of the coarse triangles' edges, by length, away from the boundary
MEAN_PARTS = 4  # the sides of a triangle are divided so often for the mean of 1 / size^2
WHOLE_PIECE = np.array([0.0, 1.0])  # a piece with points at these parameters only is held as it is
EQUILATERAL_AREA = np.sqrt(3.0) / 4.0  # the area of an equilateral triangle of sides 1


class Coarse(NamedTuple):
    """Coarse triangles whose boundary is that of the final mesh."""

    sampled: Sampled  # the pieces, cut by the size
    mesh: DomainMesh  # of the sampled pieces, none of which is cut further
    cells: NDArray[np.float64]  # (t,) how many cells each triangle will have


def _smaller(one: SizeField, other: SizeField, factor: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.minimum(one(x), factor * other(x))


def by_part(mesh: DomainMesh, size: Any) -> dict[int, SizeField]:
    """The size of each region, by its number."""
    numbers = np.unique(mesh.markers["region"]).tolist() if "region" in mesh.markers else [0]
    if not isinstance(size, Mapping):
        return dict.fromkeys(numbers, as_size(size))
    called = {number: name for name, number in mesh.regions.items()}
    return {r: as_size(size[called[r] if called.get(r) in size else None]) for r in numbers}


def _refuse_metrics(size: Any) -> None:
    for one in size.values() if isinstance(size, Mapping) else [size]:
        if isinstance(one, Metric):
            raise InputError("mesh_parts takes sizes, not metrics: mesh the whole region with its metric")


def coarse_triangles(domain: Domain, size: Any, parts: int) -> Coarse:
    """Triangles with edges that grow from those of the boundary to a multiple of the size.

    The multiple is chosen so that each part has about 400 of them, and it is 1 where a part has fewer cells.
    """
    _refuse_metrics(size)
    sampled = domain.sampled(size)
    lengths = np.sqrt(((sampled.points[sampled.ends[:, 1]] - sampled.points[sampled.ends[:, 0]]) ** 2).sum(1))
    near = sources(sampled.points[sampled.ends], lengths, growth=COARSE_GROWTH, name="chords")
    straight = as_domain(sampled)
    straight = held_by(straight, {k: WHOLE_PIECE for k in range(len(straight.pieces))}, straight.matches)
    mesh = _meshed(straight, near, False)
    total = float(predicted(mesh, size).sum())
    factor = max(np.sqrt(total / (COARSE_TRIANGLES * min(parts, MOST_VERTICES))), 1.0)
    each = size if isinstance(size, Mapping) else {None: size}
    found: dict[Any, SizeField] = {}
    for name, one in each.items():
        field = as_size(one)
        found[name] = SizeField(partial(_smaller, near, field, factor), landmarks=field.landmarks)
    mesh = _meshed(straight, found if isinstance(size, Mapping) else found[None], True)
    return Coarse(sampled, mesh, np.maximum(predicted(mesh, size), 1.0))  # short pieces make small cells


def _meshed(straight: Domain, size: Any, finish: bool) -> DomainMesh:
    with warnings.catch_warnings():  # triangles beside pieces that are not cut may be any
        warnings.simplefilter("ignore", IncompleteWarning)
        return voronoi_segment(straight, size, finish=finish, split_boundary=False)


def predicted(mesh: DomainMesh, size: Any) -> NDArray[np.float64]:
    """How many equilateral triangles of the wanted size each triangle has room for: (t,)."""
    corners = mesh.points[mesh.simplices]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    region = mesh.markers.get("region", np.zeros(mesh.size, dtype=np.int64))
    found = np.zeros(mesh.size)
    for number, field in by_part(mesh, size).items():
        rows = np.flatnonzero(region == number)
        for s, t in _places():
            h = field(corners[rows, 0] + s * u[rows] + t * v[rows])
            found[rows] += area[rows] / (EQUILATERAL_AREA * h * h) / MEAN_PARTS**2
    return found


def _places() -> list[tuple[float, float]]:
    """The centers of the equal parts of a triangle, along two of its sides."""
    n, third = MEAN_PARTS, 1.0 / 3.0
    upright = [((i + third) / n, (j + third) / n) for i in range(n) for j in range(n - i)]
    turned = [((i + 2 * third) / n, (j + 2 * third) / n) for i in range(n) for j in range(n - i - 1)]
    return upright + turned
