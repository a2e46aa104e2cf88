"""Meshes of domains take the arrays of our own kernels unchecked: the checked way accepts the same arrays."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from regions import KINDS

import unstruct
from unstruct import Domain, DomainMesh, constrained_delaunay, refine
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


def test_an_incomplete_mesh_is_noticed():
    """A warning of its own class names the counts and reasons, at the line of the caller."""
    needle = Domain.polygon([(0, 0), (1, 0), (1, 0.05)])
    calls = [
        lambda: unstruct.refine(needle, 0.05, min_angle=30),
        lambda: unstruct.voronoi_segment(needle, 0.05),
        lambda: unstruct.refine(Domain.rectangle(), 0.05, budget=20),
        lambda: unstruct.conforming_delaunay(Domain.rectangle((0, 0), (9, 1)), size=0.01, budget=1),
    ]
    for call in calls:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            mesh = call()
        found = [w for w in caught if w.category is unstruct.IncompleteWarning]
        assert len(found) == (not mesh.complete)
        for one in found:
            assert one.filename == __file__
            assert str(one.message).startswith(
                f"{len(mesh.unrefined)} of {mesh.size} cells are not as asked for: "
            )
            assert str(mesh.reasons[0]) in str(one.message)
    with warnings.catch_warnings():
        warnings.simplefilter("error", unstruct.IncompleteWarning)
        assert unstruct.refine(Domain.rectangle(), 0.3).complete


def test_a_mesh_without_cells_is_never_complete() -> None:
    """Methods take no domain in which nothing is inside, so an empty mesh misses what was asked for."""
    empty = DomainMesh(np.empty((0, 3)), np.empty((0, 4), dtype=np.int32))
    assert len(empty.unrefined) == 0 and not empty.complete
    mesh = constrained_delaunay(Domain.polygon([(0, 0), (1, 0), (0, 1)]))
    assert mesh.complete
    with pytest.raises(AttributeError):
        mesh.complete = True  # type: ignore[misc]
