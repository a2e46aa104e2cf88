"""Facets side by side in a plane as one polygon: outlines, holes, names, and what is left alone."""

from __future__ import annotations

import numpy as np

from unstruct import Domain, examples
from unstruct.domain.space.flat_parts import flat_parts


def triangulated(domain: Domain, **options) -> Domain:
    """The same body with its facets cut into triangles, without names."""
    return Domain(domain.points, domain.triangulated.triangles, **options)


def test_a_box_of_triangles_becomes_six_rectangles() -> None:
    box = triangulated(Domain.box())
    found = flat_parts(box, np.ones(12, dtype=bool))
    new = Domain(**found.arguments)
    assert sorted(new.pieces.corners.tolist()) == [4] * 6 and new.volume == 1.0
    assert np.bincount(found.group).tolist() == [2] * 6
    assert (found.group[found.piece] == np.arange(6)).all()
    one = np.zeros(12, dtype=bool)
    one[3] = True
    assert len(Domain(**flat_parts(box, one).arguments).facets) == 11
    assert flat_parts(box, one, ~one) is None


def test_names_and_inner_pieces_keep_facets_apart() -> None:
    box = Domain.box()
    every = np.ones(12, dtype=bool)
    named = triangulated(box, markers={"half": range(0, 12, 2)})
    assert flat_parts(named, every) is None
    rows = box.triangulated.triangles
    shared = sorted(set(rows[0].tolist()) & set(rows[1].tolist()))
    held = triangulated(box, inner=[shared])
    assert len(Domain(**flat_parts(held, every).arguments).facets) == 7


def test_holes_and_points_within() -> None:
    """The end of a tube is a ring; a point inside of a plane is left out, one that is loose stays."""
    square = Domain.polygon([(0, 0), (3, 0), (3, 3), (0, 3)], holes=[[(1, 1), (2, 1), (2, 2), (1, 2)]])
    tube = triangulated(Domain.extruded(square, 1.0))
    found = flat_parts(tube, np.ones(len(tube.facets), dtype=bool))
    new = Domain(**found.arguments)
    assert len(new.facets) == 10 and new.volume == tube.volume
    assert sorted(len(new.pieces.rings(i)) for i in range(10)) == [1] * 8 + [2] * 2
    cylinder = Domain.cylinder(size=0.25)
    found = flat_parts(cylinder, np.ones(len(cylinder.facets), dtype=bool))
    new = Domain(**found.arguments)
    assert new.volume == cylinder.volume and len(new.points) < len(cylinder.points)
    assert {len(new.markers[name]) for name in ("bottom", "top")} == {1}
    loose = Domain(
        np.concatenate([cylinder.points, [(0.0, 0.0, 0.5)]]), cylinder.facets, markers=cylinder.markers
    )
    kept = flat_parts(loose, np.ones(len(loose.facets), dtype=bool)).vertex
    assert len(loose.points) - 1 in kept


def test_what_is_not_flat_stays() -> None:
    ball = Domain.ball(size=0.5)
    assert flat_parts(ball, np.ones(len(ball.facets), dtype=bool)) is None
    box = triangulated(Domain.box())
    points = box.points + np.where(np.arange(8) == 5, 1e-9, 0.0)[:, None]
    moved = Domain(points, box.facets)
    found = flat_parts(moved, np.ones(12, dtype=bool))
    assert len(Domain(**found.arguments).facets) == 9


def test_points_on_straight_edges_between_parts_go() -> None:
    box = examples.meshed_sides(Domain.box(), 0.25)
    every = np.ones(len(box.facets), dtype=bool)
    new = Domain(**flat_parts(box, every).arguments)
    assert len(new.points) == 8 and new.volume == 1.0 and len(new.facets) == 6
    top = np.zeros(len(box.facets), dtype=bool)
    top[box.markers["top"]] = True  # alone: what is beside it has the points of its edges
    assert len(Domain(**flat_parts(box, top).arguments).facets[0]) == 3
    points = box.points.copy()
    on_edge = np.flatnonzero((points[:, 1:] == 0.0).all(axis=1) & (points[:, 0] == 0.5))[0]
    held = Domain(
        np.concatenate([points, [(0.5, 0.4, 0.4)]]),
        box.facets,
        inner=[[on_edge, len(points)]],
        markers=box.markers,
    )
    assert len(Domain(**flat_parts(held, every).arguments).points) == 8 + 2
    points[on_edge, 1:] = -1e-3  # the edge bends there: both of its sides are no plane polygons any more
    bent = Domain(points, box.facets, markers=box.markers)
    assert Domain(**flat_parts(bent, every).arguments).volume == bent.volume
