"""Meshes that touch themselves: told by place, exactly where `check` finds it."""

from __future__ import annotations

import re
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.generate.hexahedra.test_dominant import SIDES, UNIT
from unstruct import Domain, IncompleteWarning, Mesh, check, octree, quadtree
from unstruct.generate.planting.pinched import pinches
from unstruct.generate.tree.cubes import cubes_as_tetrahedra
from unstruct.generate.tree.templates import squares_as_triangles
from unstruct.generate.tree.vertices import numbered


@settings(max_examples=60, deadline=None)
@given(st.integers(2, 3), st.integers(0, 10**6))
def test_as_checked(d: int, seed: int) -> None:
    """Any choice of leaves: what is told is what the validator finds."""
    rng = np.random.default_rng(seed)
    tree = (quadtree if d == 2 else octree)([[0] * d, [1] * d], 0.5 if d == 3 else 0.25)
    if seed % 2:
        tree = tree.refined([0])
    chosen = rng.random(len(tree)) < rng.uniform(0.3, 0.9)
    chosen[0] = True
    pattern = squares_as_triangles if d == 2 else cubes_as_tetrahedra
    points, cells, _ = pattern(tree.grid, numbered(tree.grid), chosen)
    used, number = np.unique(cells, return_inverse=True)
    mesh = Mesh(points[used], number.reshape(cells.shape))
    found = pinches(mesh.points, np.asarray(mesh.simplices))
    problems = [p for p in check(mesh).problems if p.kind.startswith("pinched") or p.kind == "link"]
    assert bool(found) == bool(problems)
    bad = {v for p in problems for v in p.vertices if p.kind == "pinched vertex"}
    rows = np.flatnonzero(np.isin(mesh.simplices, list(bad)).any(axis=1)) if bad else []
    assert set(np.asarray(rows).tolist()) <= set(found)


@pytest.mark.parametrize("step", [[1, 1, 0], [1, 1, 1]])
def test_bodies_that_touch(step: list[int]) -> None:
    points, number = np.unique(np.concatenate([UNIT, UNIT + step]), axis=0, return_inverse=True)
    body = Domain(points, number.ravel()[np.concatenate([SIDES, SIDES + 8])])
    tree = octree(body, 0.25, box=[[0, 0, 0], [2, 2, 2]])
    with pytest.warns(IncompleteWarning, match=r"meet here at a corner or an edge only.*near \(1, 1, "):
        mesh = tree.mesh("conforming")
    assert not check(mesh)
    assert not mesh.complete
    place = np.array(re.findall(r"near \(([^)]*)\)", mesh.reasons[0])[0].split(","), dtype=float)
    assert (place[:2] == 1).all()


def test_nothing_is_told_of_others() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh = octree(Domain.ball(size=0.4), 0.3).mesh("conforming")
        assert mesh.complete and check(mesh)
