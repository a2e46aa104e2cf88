"""Curves are cut where a loose vertex lies on a chord, which would make it a vertex of the boundary."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import (
    Arc,
    Bezier,
    Domain,
    InputError,
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


@pytest.mark.parametrize("part", [0.25, 0.5, 1 / 3, 0.3])
@pytest.mark.parametrize("off", [0.0, 1e-14])
def test_a_loose_vertex_on_an_arc_is_named_with_it(part: float, off: float) -> None:
    """At a half or a quarter of the arc it is where the arc is cut; elsewhere it is on no chord's end."""
    arc = Arc((0, 0), 1.0, 0.0, np.pi)
    point = arc.point(np.array([part]))[0] * (1.0 + off)
    points, facets = np.vstack([[(1, 0), (-1, 0)], point]), [(1, 0), (0, 1)]
    with pytest.raises(InputError, match=r"point 2 lies on facet 1, at .*let resolve=True do so"):
        Domain(points, facets, curves={1: arc})
    repaired = Domain(points, facets, curves={1: arc}, resolve=True)
    assert len(repaired.facets) == 3 and not len(repaired.loose) and len(repaired.repairs)
    mesh = constrained_delaunay(repaired)
    assert check(mesh, domain=repaired) and 2 in mesh.origin


def test_a_loose_vertex_on_another_curve_is_to_be_moved() -> None:
    curve = Bezier([(0, 0), (0.5, 0.3), (1, 0)])
    points = np.vstack([[(0, 0), (1, 0), (0.5, 1)], curve.point(np.array([0.5]))])
    with pytest.raises(InputError, match=r"point 3 lies on facet 0, at .*or move the point"):
        Domain(points, [(0, 1), (1, 2), (2, 0)], curves={0: curve})
