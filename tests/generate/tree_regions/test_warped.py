"""Cut and warp: valid, everything kept, what moved and what was cut on record, angles as measured."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import KINDS, random_region
from tree_regions import angles, everything

import unstruct
from benchmarks.tree_meshes import coast
from unstruct import Domain, check, quadtree
from unstruct.generate.tree_regions.warped import WARPED

pytestmark = pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")


@pytest.mark.parametrize("side", [0.5, 0.2, 0.07, 0.03])
def test_circles(side):
    disc = Domain.disc((0, 0), 1)
    mesh = quadtree(disc, side).mesh("warped")
    assert check(mesh, domain=disc, delaunay="constrained")
    assert angles(mesh).min() > 22
    assert mesh.figures["minimum angle"] == pytest.approx(angles(mesh).min())


@pytest.mark.parametrize("seed", range(3))
def test_coasts_are_valid_but_poor(seed):
    land = coast(seed, levels=6)
    tree = quadtree(land, 0.1, boundary_size=0.02)
    mesh = tree.mesh("warped")
    assert check(mesh, domain=land, delaunay="constrained")
    assert angles(mesh).min() < angles(tree.mesh("fitted")).min() + 10


@pytest.mark.parametrize("side", [0.3, 0.05])
def test_the_record(side):
    """Warped vertices were near and are on the circle; cut edges join one side of it to the other."""
    disc = Domain.disc((0, 0), 1)
    tree = quadtree(disc, side)
    mesh = tree.mesh("warped")
    first, last = mesh.steps["from"], mesh.steps["to"]
    assert len(first) == mesh.counts["warped"] > 0 and len(mesh.steps["cut"]) == mesh.counts["cuts"] > 0
    assert (np.sqrt(((last - first) ** 2).sum(axis=1)) <= WARPED * tree.sides.max() + side**2).all()
    assert np.abs(np.hypot(*last.T) - 1).max() < 1e-12
    ends = np.hypot(mesh.steps["edge"][..., 0], mesh.steps["edge"][..., 1])
    assert (ends.min(axis=1) < 1).all() and (ends.max(axis=1) > 1 - side**2).all()
    where = {tuple(x) for x in mesh.points}
    assert all(tuple(x) in where for x in np.concatenate([last, mesh.steps["cut"]]))


@pytest.mark.parametrize("kind", list(KINDS))
@settings(max_examples=12, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    cells=st.sampled_from([2.0, 0.3, 0.1]),
    balance=st.sampled_from(["corners", None]),
)
def test_random_regions(kind, seed, cells, balance):
    domain = random_region(seed, kind)
    extent = float(np.ptp(domain.bounds, axis=0).max())
    try:
        mesh = quadtree(domain, cells * extent, balance=balance, max_level=10).mesh("warped")
    except unstruct.UnstructError:
        assert kind == "wide exponents"  # refused as by all methods
        return
    assert check(mesh, domain=domain)


@pytest.mark.parametrize("side", [8.0, 1.0, 0.25, 0.1])
@pytest.mark.parametrize("offset", [0.0, 1e8])
def test_everything_is_kept(side, offset):
    domain = everything(offset)
    mesh = quadtree(domain, side).mesh("warped")
    assert check(mesh, domain=domain)
    assert sorted(mesh.origin[mesh.origin >= 0]) == list(range(len(domain.points)))
    assert set(mesh.markers) >= {"bottom", "hole", "crack"} and set(mesh.regions) == {"left", "right"}


def test_sides_on_sides_of_leaves():
    square = Domain.rectangle((0, 0), (1, 1))
    mesh = quadtree(square, 0.125, box=[[0, 0], [1, 1]]).mesh("warped")
    assert check(mesh, domain=square)
    assert len(mesh.points) == 81 and mesh.counts["cuts"] == 0
    assert np.abs(angles(mesh) - 45).max() < 1e-9


def test_pieces_that_have_their_points_get_no_others():
    square = Domain.rectangle((0, 0), (1, 1)).matched(3, 1)
    mesh = quadtree(square, 0.1, boundary_size=0.03).mesh("warped")
    assert check(mesh, domain=square) and len(mesh.pairs) > 10
    spaced = Domain.rectangle((0, 0), (1, 1)).spaced({0: 7})
    mesh = quadtree(spaced, 0.1).mesh("warped")
    assert check(mesh, domain=spaced) and (mesh.piece == 0).sum() == 7


def test_refused():
    with pytest.raises(unstruct.UnstructError, match="this tree is over a box"):
        quadtree([[0, 0], [1, 1]], 0.25).mesh("warped")
