"""Meshes of domains take the arrays of our own kernels unchecked: the checked way accepts the same arrays."""

from __future__ import annotations

import numpy as np
import pytest
from regions import KINDS

from unstruct import DomainMesh, constrained_delaunay, refine
from unstruct.mesh.topology import neighbors


@pytest.mark.parametrize("kind", KINDS)
def test_arrays_taken_unchecked_pass_the_checks(kind: str) -> None:
    for seed in range(2):
        domain = KINDS[kind](np.random.default_rng(seed))
        for mesh in (constrained_delaunay(domain), refine(domain, min_angle=10, budget=2000)):
            again = DomainMesh(
                mesh.points, mesh.simplices, neighbors=mesh.neighbors, origin=mesh.origin,
                markers=mesh.markers, segments=mesh.segments, piece=mesh.piece, span=mesh.span,
            )  # fmt: skip
            np.testing.assert_array_equal(mesh.neighbors, neighbors(mesh.simplices))
            assert again.markers.keys() == mesh.markers.keys()
            pairs = [(again.origin, mesh.origin), (again.simplices, mesh.simplices)]
            pairs += [(again.markers[name], mesh.markers[name]) for name in mesh.markers]
            for one, two in pairs:
                np.testing.assert_array_equal(one, two)
                assert one.dtype == two.dtype and not two.flags.writeable
            assert mesh.points.dtype == np.float64 and not mesh.points.flags.writeable
