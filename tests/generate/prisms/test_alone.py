"""Layers without anything beyond: columns beside rays without layers are left out; names, also in planes."""

from __future__ import annotations

import numpy as np

from unstruct import Domain, Layers, check
from unstruct.generate.prisms.alone import layers_of_columns
from unstruct.generate.prisms.growing import grown_layers
from unstruct.generate.prisms.prismatic_layers import prismatic_layers
from unstruct.generate.prisms.walls import base_of


def test_some_columns_of_a_ball() -> None:
    """What is kept has its own numbers, and refers to the body."""
    ball = Domain.ball(size=0.5)
    body = Domain(
        ball.points,
        ball.facets,
        markers={"low": np.flatnonzero(ball.points[ball.triangulated.triangles][:, :, 2].max(axis=1) < 0)},
    )
    base = base_of(body, None, "outside")
    walls, n = base.walls, len(base.walls.points)
    places = walls.points * np.linspace(1.0, 1.3, 4)[:, None, None]
    grown = grown_layers(walls, np.arange(n), np.full(n, 3), places, walls.triangles)
    kept = walls.points[walls.triangles][:, :, 2].max(axis=1) < 0.3
    found = layers_of_columns(base, grown, kept)
    some = found.grown
    assert len(some.cells["wedge"]) == 3 * kept.sum() and len(some.base) == len(some.cap) == kept.sum()
    assert np.array_equal(some.points[found.vertex[found.vertex >= 0]], walls.points[found.vertex >= 0])
    assert (found.origin[some.level > 0] == -1).all()
    assert np.array_equal(body.points[found.origin[some.level == 0]], some.points[some.level == 0])
    assert set(found.markers) == {"low", "cap"} and np.array_equal(found.face_piece, walls.piece[kept])


def test_sides_in_planes_have_their_names() -> None:
    tube = Domain.extruded(Domain.disc(), 1.0, size=0.5)
    walls = np.setdiff1d(np.arange(len(tube.facets)), [tube.markers[name][0] for name in ("bottom", "top")])
    layers = Layers(first=0.05, growth=1.2, count=3)
    mesh = prismatic_layers(tube, layers=layers, walls=walls, side="inside")
    assert check(mesh)
    around = int(tube.pieces.corners[tube.markers["top"][0]])
    for name, z in (("bottom", 0.0), ("top", 1.0)):
        rows = mesh.markers[name]
        assert rows.shape == (3 * around, 4) and (mesh.points[rows][..., 2] == z).all()
        assert (np.isin(mesh.face_piece, tube.markers[name])).sum() == 6 * around
