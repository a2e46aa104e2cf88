"""Circumcenters and Voronoi segments in space: valid meshes, slivers, and their cure."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError, check, circumcenter_insertion, improve, voronoi_segment
from unstruct.simplex import circumradius
from unstruct.sizing import directional

REGULAR = np.sqrt(6) / 4
BODIES = {"box": Domain.box(), "ball": Domain.ball(size=0.3), "torus": Domain.torus(size=0.25)}


@pytest.mark.parametrize("shape", BODIES)
def test_the_maximal_tetrahedron(shape: str) -> None:
    domain, h = BODIES[shape], 0.25
    mesh = circumcenter_insertion(domain, h)
    assert check(mesh, domain=domain) and mesh.counts["circumcenters"] > 20
    assert not mesh.complete or circumradius(mesh.corners).max() <= REGULAR * h * (1 + 1e-9)
    better = improve(mesh)
    assert check(better, domain=domain)
    assert better.quality("min_dihedral").min() > max(5, mesh.quality("min_dihedral").min())


@pytest.mark.parametrize("shape", BODIES)
def test_voronoi_segments(shape: str) -> None:
    domain, h = BODIES[shape], 0.2
    raw = voronoi_segment(domain, h, finish=False)
    mesh = voronoi_segment(domain, h)
    assert check(raw, domain=domain) and check(mesh, domain=domain)
    assert raw.counts["Voronoi points"] > 0.5 * (raw.counts["Voronoi points"] + raw.counts["circumcenters"])
    assert not raw.complete or circumradius(raw.corners).max() <= 1.35 * REGULAR * h * (1 + 1e-9)
    assert mesh.quality("min_dihedral").min() > 15 > raw.quality("min_dihedral").min()
    assert mesh.figures["minimum min_dihedral after"] == mesh.quality("min_dihedral").min()


def test_a_boundary_that_stays() -> None:
    domain = Domain.ball(size=0.2)
    for method in (circumcenter_insertion, voronoi_segment):
        with pytest.warns(UserWarning) if method is circumcenter_insertion else np.errstate():
            mesh = method(domain, 0.2, split_boundary=False)
        assert check(mesh, domain=domain) and not len(mesh.steiner)
        assert len(mesh.points) > len(domain.points)


def test_priorities_and_budget() -> None:
    box = Domain.box()
    one = circumcenter_insertion(box, 0.3, priority="circumradius")
    assert check(one, domain=box) and one.complete
    with pytest.warns(UserWarning, match="budget"):
        few = circumcenter_insertion(box, budget=10)
    assert check(few, domain=box) and len(few.points) == 18
    steps = circumcenter_insertion(box, 0.3, history=True).steps
    assert steps is not None and len(steps["vertex"]) == len(one.points) - 8


def test_a_size_as_priority() -> None:
    """Only the order of the points changes: the first ones go where the size of the priority is small."""
    box = Domain.box()

    def low(x: np.ndarray) -> np.ndarray:
        return 0.02 + x[:, 2]

    with pytest.warns(UserWarning, match="budget"):
        first = circumcenter_insertion(box, budget=100, priority=low)
    new = first.points[8:]
    assert check(first, domain=box) and (new[:, 2] < 0.5).sum() > 75
    done = circumcenter_insertion(box, 0.3, priority=low)
    assert check(done, domain=box) and done.complete
    assert circumradius(done.corners).max() <= REGULAR * 0.3 * (1 + 1e-9)
    segments = voronoi_segment(box, 0.3, priority=0.3, finish=False)
    other = voronoi_segment(box, 0.3, priority="circumradius", finish=False)
    assert np.array_equal(segments.points, other.points)


def test_refused() -> None:
    box = Domain.box()
    with pytest.raises(InputError, match="give a size"):
        circumcenter_insertion(box)
    with pytest.raises(InputError, match="limit and step"):
        circumcenter_insertion(box, 0.3, limit=2.0)
    with pytest.raises(InputError, match="'alpha' or 'circumradius' in space, or a size"):
        voronoi_segment(box, 0.3, priority="area")
    with pytest.raises(InputError, match="give a size"):
        circumcenter_insertion(box, priority="alpha", budget=10)
    with pytest.raises(InputError, match="evaluate and order"):
        voronoi_segment(box, 0.3, order="last")
    with pytest.raises(InputError, match=r"directions|metric"):
        voronoi_segment(box, directional([1, 1], 0.2, 0.1))
    with pytest.raises(InputError, match="size must be"):  # it once went on for ten million points
        voronoi_segment(box, None)
