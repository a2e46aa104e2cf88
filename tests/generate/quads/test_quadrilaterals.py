"""Quadrilaterals in regions: valid, of the region, with its names; as many and as good as promised."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import regions
from extreme_regions import EXTREME

import unstruct
from unstruct import Domain, examples

KINDS = regions.KINDS | {name: EXTREME[name] for name in ("spokes", "sides", "huge")}


def lake_size(x):
    return examples.running_size(x)


def wing_size(x):
    return 0.02 + 0.15 * np.hypot(x[:, 0] - 0.6, x[:, 1])


@pytest.mark.parametrize(
    "make, size, share, deviation",
    [
        (examples.running_domain, 0.04, 1.0, 5.6),
        (examples.running_domain, lake_size, 1.0, 8.0),
        (examples.wing_with_flap, wing_size, 1.0, 8.9),
        (Domain.disc, 0.1, 1.0, 9.0),
        (Domain.rectangle, 0.1, 1.0, 1e-6),
    ],
)
def test_figures(make, size, share, deviation):
    domain = make()
    mesh = unstruct.quadrilaterals(domain, size)
    assert unstruct.check(mesh, domain=domain)
    assert mesh.figures["share of quadrilaterals"] >= share
    assert mesh.figures["mean deviation"] <= deviation


def test_the_coast():
    domain = examples.coastline()
    with pytest.warns(unstruct.IncompleteWarning, match="triangle"):
        mesh = unstruct.quadrilaterals(domain, examples.coastline_size(domain))
    assert unstruct.check(mesh, domain=domain)
    assert mesh.figures["share of quadrilaterals"] > 0.995
    assert mesh.figures["mean deviation"] < 15.5
    assert mesh.reasons.tolist() == ["triangle"] * mesh.counts["triangles"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(3))
def test_random_regions(kind, seed):
    rng = np.random.default_rng([7, seed])
    domain = KINDS[kind](rng)
    lower, upper = domain.bounds
    h = float((upper - lower).max()) * 10 ** rng.uniform(-1.4, -0.3)
    split = (True, False, "inner")[seed]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", unstruct.IncompleteWarning)
        mesh = unstruct.quadrilaterals(domain, h, split_boundary=split)
        other = unstruct.recombine(unstruct.voronoi_segment(domain, h, split_boundary=split))
    for found in (mesh, other):
        assert unstruct.check(found, domain=domain)
        own = np.flatnonzero(found.origin >= 0)
        assert np.array_equal(found.points[own], domain.points[found.origin[own]])


def test_flat_corners_are_nobodys_gain():
    """A side of 1e-12 at a hub: its corners counted as flat although they were not, and one turned over."""
    domain = EXTREME["spokes"](np.random.default_rng([3, 10]))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", unstruct.IncompleteWarning)
        mesh = unstruct.quadrilaterals(domain, 1.7413033348474618e120)
    assert unstruct.check(mesh, domain=domain)


def test_squares_of_lengths_that_are_no_doubles():
    domain = EXTREME["spokes"](np.random.default_rng([3, 64]))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", unstruct.IncompleteWarning)
        mesh = unstruct.quadrilaterals(domain, 0.12972897977112819, split_boundary=False)
    assert unstruct.check(mesh, domain=domain)


def two_regions():
    outer = [(0, 0), (2, 0), (2, 1), (0, 1)]
    points = np.array([*outer, (1, 0), (1, 1)], dtype=float)
    facets = [(0, 4), (4, 1), (1, 2), (2, 5), (5, 3), (3, 0)]
    return Domain(
        points, facets, inner=[(4, 5)], regions={"left": (0.5, 0.5), "right": (1.5, 0.5)},
        markers={"inlet": [5], "middle": [6]},
    )  # fmt: skip


def test_names_regions_and_sizes_by_region():
    domain = two_regions()
    mesh = unstruct.quadrilaterals(domain, {"left": 0.1, None: 0.05})
    assert unstruct.check(mesh, domain=domain)
    center = np.concatenate([mesh.points[rows].mean(axis=1) for rows in mesh.cells.values()])
    assert np.array_equal(mesh.markers["region"] == mesh.regions["left"], center[:, 0] < 1)
    for name, x in (("inlet", 0.0), ("middle", 1.0)):
        rows = mesh.markers[name]
        assert (mesh.points[rows][..., 0] == x).all()
        y = np.sort(mesh.points[rows][..., 1], axis=1)
        assert y[:, 0].min() == 0 and y[:, 1].max() == 1
        assert (y[:, 1] - y[:, 0]).sum() == pytest.approx(1)
    left = (center[:, 0] < 0.8).sum() / 0.8
    assert 2.5 < (center[:, 0] > 1.2).sum() / 0.8 / left < 6


def test_a_side_is_divided_with_its_names():
    """A triangle with one edge a side: an odd number of sides, so that one of them is divided."""
    domain = Domain.polygon([(0, 0), (1, 0), (1, 1), (0.5, 1.4), (0, 1)])
    mesh = unstruct.quadrilaterals(domain, 1.0)
    assert unstruct.check(mesh, domain=domain)
    assert mesh.counts["divided"] == 1 and mesh.complete
    assert len(mesh.segments) == 6 and len(mesh.markers["facets"]) == 6
    ends = {tuple(sorted(row)) for row in mesh.segments.tolist()}
    assert ends == {tuple(sorted(row)) for row in mesh.markers["facets"].tolist()}
    with pytest.warns(unstruct.IncompleteWarning):
        kept = unstruct.quadrilaterals(domain, 1.0, split_boundary=False)
    assert len(kept.segments) == 5 and kept.counts["triangles"] == 1


def test_sides_that_match():
    domain = Domain.rectangle((0, 0), (2, 1)).matched("left", "right")
    mesh = unstruct.quadrilaterals(domain, 0.15)
    assert unstruct.check(mesh, domain=domain)
    (pairs,) = mesh.periodic
    one, two = mesh.points[pairs.vertices.T] if hasattr(pairs, "vertices") else mesh.points[pairs[1].T]
    assert np.allclose(np.abs(one - two), [2, 0])


def test_a_small_budget():
    domain = Domain.disc()
    with pytest.warns(unstruct.IncompleteWarning, match="budget"):
        mesh = unstruct.quadrilaterals(domain, 0.05, budget=20)
    assert unstruct.check(mesh, domain=domain)
    assert not mesh.complete and mesh.counts["points"] <= 20


def test_pairs_alone():
    domain = Domain.disc()
    with pytest.warns(unstruct.IncompleteWarning):
        mesh = unstruct.quadrilaterals(domain, 0.1, finish=False)
    assert unstruct.check(mesh, domain=domain)
    assert mesh.figures["maximum angle"] < 140.5 or mesh.counts["triangles"] > 0


@pytest.mark.parametrize("offset", [0.0, 1e5])
@pytest.mark.parametrize("scale", [1e-5, 1.0])
def test_far_from_the_origin(offset, scale):
    domain = Domain.polygon(np.array([[0, 0], [2, 0], [2, 1], [1, 1.5], [0, 1]]) * scale + offset)
    if len(np.unique(domain.points, axis=0)) < 5:
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", unstruct.IncompleteWarning)
        mesh = unstruct.quadrilaterals(domain, 0.2 * scale)
    assert unstruct.check(mesh, domain=domain)


def test_a_body():
    with pytest.raises(unstruct.InputError, match="octree"):
        unstruct.quadrilaterals(Domain.box(), 0.3)
