"""Curves are cut where a loose vertex lies on a chord, which would make it a vertex of the boundary."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import (
    Bezier,
    Domain,
    advancing_front,
    check,
    constrained_delaunay,
    front_delaunay,
    refine,
    voronoi_segment,
)


@pytest.mark.parametrize("bend", [-0.4, 0.3])
@pytest.mark.parametrize("part", [0.125, 0.5, 0.39122819049566204])
@pytest.mark.parametrize("start", [0.0, 0.5])
def test_a_loose_vertex_on_a_chord_is_not_on_the_boundary(bend: float, part: float, start: float) -> None:
    curve = Bezier([(0, 0), (0.5, bend), (1, 0)])
    first, last = curve.point(np.array([start, 1.0]))
    points = np.vstack([[(0, 0), (1, 0), (0.5, 1)], first + (last - first) * part])
    domain = Domain(points, [(0, 1), (1, 2), (2, 0)], curves={0: curve})
    inside = bool(domain.contains(points[3:])[0])
    for method in (constrained_delaunay, refine, voronoi_segment, advancing_front, front_delaunay):
        mesh = method(domain) if method in (constrained_delaunay, refine) else method(domain, 0.8)
        place = np.flatnonzero(mesh.origin == 3)
        assert len(place) == inside and not np.isin(place, mesh.markers["facets"]).any()
        assert check(mesh, domain=domain)
