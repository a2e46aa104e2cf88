"""Fans of triangles around vertices, and their normals."""

from __future__ import annotations

import numpy as np

from unstruct import Domain
from unstruct.generate.prisms.stars import stars_of, unit_normals


def test_stars_of_a_closed_surface() -> None:
    shell = Domain.ball(size=0.5).triangulated
    stars = stars_of(shell.triangles, len(shell.points))
    assert stars.single.all() and (stars.mates >= 0).all()
    for v in range(len(shell.points)):
        places = stars.around[stars.start[v] : stars.start[v + 1]]
        rows = shell.triangles[places // 3]
        assert (shell.triangles.ravel()[places] == v).all()
        assert set(places // 3) == set(np.flatnonzero((shell.triangles == v).any(axis=1)))
        follow = [rows[i, (places[i] % 3 + 2) % 3] for i in range(len(rows))]
        begin = [rows[i, (places[i] % 3 + 1) % 3] for i in range(len(rows))]
        assert follow == [*begin[1:], begin[0]]


def test_stars_of_an_open_strip_and_of_a_pinch() -> None:
    strip = np.array([(0, 1, 2), (1, 3, 2), (3, 4, 2)], dtype=np.int32)
    stars = stars_of(strip, 5)
    assert stars.single.all() and (stars.mates < 0).sum() == 5
    assert (stars.around[stars.start[2] : stars.start[3]] // 3).tolist() == [0, 1, 2]
    two = np.array([(0, 1, 2), (0, 3, 4)], dtype=np.int32)
    assert stars_of(two, 5).single.tolist() == [False, True, True, True, True]
    assert not stars_of(two, 6).single[5]  # of no triangle


def test_normals_of_tiny_and_flat_triangles() -> None:
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (2, 0, 0)], dtype=float)
    rows = np.array([(0, 1, 2), (0, 1, 3)], dtype=np.int32)
    for unit in (1.0, 2.0**-280, 2.0**280):
        normals, double = unit_normals(points * unit, rows)
        assert normals.tolist() == [[0, 0, 1], [0, 0, 0]] and double.tolist() == [unit * unit, 0.0]
