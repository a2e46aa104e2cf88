"""Sizes from the surfaces of bodies: curvature of round ones is known; edges give their lengths."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError, check, sizing, tetrahedralize
from unstruct.sizing.surface import bends_of


@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e200])
def test_curvature_of_round_bodies(scale: float) -> None:
    def scaled(body: Domain) -> Domain:
        return Domain(body.points * scale, body.triangulated.triangles)

    edges, bend = bends_of(scaled(Domain.ball(radius=2.0, size=0.3)))
    assert edges.shape == (len(bend), 2, 3)
    assert bend * scale == pytest.approx(np.full(len(bend), 0.5), rel=0.03)
    edges, bend = bends_of(scaled(Domain.cylinder(size=0.1)))
    edges = edges / scale
    around = np.isclose(edges[:, 0, 2], edges[:, 1, 2]) & np.isclose(np.hypot(*edges.T[:2]), 0.5).all(axis=0)
    inner = (edges[:, :, 2] > 0.2).all(axis=1) & (edges[:, :, 2] < 0.8).all(axis=1)
    assert bend.max() * scale == pytest.approx(2.0, rel=1e-4), "around it; its ends have no curvature"
    assert bend[around & inner] * scale == pytest.approx(np.full((around & inner).sum(), 2.0), rel=1e-4)
    assert bends_of(Domain.box())[1].max() == 0.0


def test_a_torus_bends_most_around_its_tube() -> None:
    bend = bends_of(Domain.torus(radius=1.0, tube=0.25, size=0.06))[1]
    assert np.quantile(bend, 0.99) == pytest.approx(4.0, rel=0.1), "few edges run exactly around it"


def test_from_curvature_of_bodies() -> None:
    ball = Domain.ball(size=0.2)
    size = sizing.from_curvature(ball, 30, far=0.5, growth=0.3)
    assert size(ball.points) == pytest.approx(np.full(len(ball.points), 2 * np.pi / 30), rel=0.03)
    assert size([[0.0, 0.0, 0.0]])[0] == pytest.approx(0.5)
    assert sizing.from_curvature(ball, 30, far=0.5, lower=0.3)([[0, 0, 1.0]])[0] == pytest.approx(0.3)
    flat = sizing.from_curvature(Domain.box(), 30, far=0.5)
    assert flat.constant == 0.5
    cylinder = Domain.cylinder(radius=0.5, size=0.12)
    mesh = tetrahedralize(cylinder, sizing.from_curvature(cylinder, 24, far=0.3, growth=0.3))
    assert check(mesh, domain=cylinder) and mesh.complete and mesh.quality("min_dihedral").min() > 20


def test_from_facets() -> None:
    torus = Domain.torus(size=0.15)
    size = sizing.from_facets(torus, growth=0.4, far=0.25)
    middle = size(torus.points)
    assert 0.7 < np.quantile(middle / 0.15, 0.02) and (middle / 0.15).max() < 1.2
    assert size([[0.0, 0.0, 9.0]])[0] == 0.25
    twice = sizing.from_facets(torus, 2.0)(torus.points)
    assert twice == pytest.approx(2 * sizing.from_facets(torus, growth=0.15)(torus.points))
    mesh = tetrahedralize(torus, size)
    assert check(mesh, domain=torus) and mesh.complete and mesh.quality("min_dihedral").min() > 20
    box = sizing.from_facets(Domain.box(), far=3.0)
    assert box([[0.5, 0.0, 0.0]])[0] == pytest.approx(1.0), "an edge of the box"


def test_wrong_arguments() -> None:
    planar, ball = Domain.rectangle(), Domain.ball(size=0.5)
    with pytest.raises(InputError, match="planar"):
        sizing.from_facets(planar)
    with pytest.raises(InputError, match="Domain"):
        sizing.from_facets(3.0)  # type: ignore[arg-type]
    for name, value in (("factor", 0.0), ("far", -1.0), ("growth", np.nan), ("growth", -1.0)):
        with pytest.raises(InputError, match=name):
            sizing.from_facets(ball, **{name: value})
    with pytest.raises(InputError, match="facets"):
        sizing.from_curvature(Domain(np.eye(3), np.empty((0, 3), dtype=int)), far=1.0)
