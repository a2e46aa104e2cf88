"""Surfaces that end in planes, closed by polygons: nested loops, bent ducts, faults."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError, Layers, Mesh, check
from unstruct.generate.prisms.closing import closed_in_planes
from unstruct.generate.prisms.prismatic_layers import prismatic_layers


def side_of(domain: Domain, *ends: str) -> Mesh:
    """The facets of a body as triangles, without some of its ends."""
    shell = domain.triangulated
    left_out = np.concatenate([domain.markers[name] for name in ends])
    rows = shell.triangles[~np.isin(shell.piece, left_out)]
    used, place = np.unique(rows, return_inverse=True)
    return Mesh(domain.points[used], place.reshape(-1, 3))


def test_a_tube_from_inside() -> None:
    tube = Domain.cylinder(size=0.25)
    surface = side_of(tube, "bottom", "top")
    found = closed_in_planes(surface)
    assert len(found.domain.facets) == surface.size + 2 and np.isclose(
        found.domain.volume, tube.volume, rtol=1e-12
    )
    mesh = prismatic_layers(surface, 0.25, layers=Layers(first=0.02, count=3))
    assert (
        mesh.complete and check(mesh, domain=found.domain) and {"end 0", "end 1", "cap"} <= set(mesh.markers)
    )
    at = np.flatnonzero(mesh.origin >= 0)
    assert np.array_equal(mesh.points[at], surface.points[mesh.origin[at]])
    assert len(at) == len(np.unique(surface.simplices))


def test_an_end_with_a_hole_and_ends_in_one_plane() -> None:
    ring = Domain.polygon([(0, 0), (6, 0), (6, 6), (0, 6)], holes=[[(2, 2), (4, 2), (4, 4), (2, 4)]])
    body = Domain.extruded(ring, 1.0, size=1.0)
    found = closed_in_planes(side_of(body, "bottom", "top"))
    ends = [found.domain.markers[f"end {k}"][0] for k in range(2)]
    assert found.domain.volume == body.volume and [len(found.domain.pieces.rings(i)) for i in ends] == [2, 2]
    mesh = prismatic_layers(side_of(body, "bottom", "top"), 1.0, layers=Layers(first=0.1, count=3))
    assert mesh.complete and check(mesh, domain=found.domain)
    bend = Domain.revolved(Domain.polygon([(2, 0), (3, 0), (3, 1), (2, 1)]), 180.0, count=8)
    found = closed_in_planes(side_of(bend, "start", "end"))
    assert np.isclose(found.domain.volume, bend.volume) and len(found.domain.facets) == len(found.walls) + 2


def test_what_is_closed_or_no_loop() -> None:
    ball = Domain.ball(size=0.5)
    assert closed_in_planes(Mesh(ball.points, ball.triangulated.triangles)) is None
    rows = np.array([(0, 1, 2), (0, 3, 4)])
    points = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (-1, 0, 0), (-1, -1, 0.0)])
    with pytest.raises(InputError, match="meet at point 0"):
        closed_in_planes(Mesh(points, rows))
