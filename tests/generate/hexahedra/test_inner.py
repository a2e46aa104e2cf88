"""The leaves inside of a body as hexahedra: valid meshes, whatever touches whatever."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.generate.hexahedra.test_dominant import SIDES, UNIT, blob, halves
from unstruct import Domain, InputError, Mesh, check, octree
from unstruct.generate.hexahedra.pinches import pinched_vertices


def test_ball_of_one_level() -> None:
    body = Domain.ball(size=0.2)
    tree = octree(body, 0.1)
    mesh = tree.mesh("hexahedra")
    assert list(mesh.cells) == ["hexahedron"]
    assert mesh.size == np.count_nonzero(tree.states == 1)
    assert check(mesh)
    assert mesh.volume / body.volume == pytest.approx(mesh.figures["share of volume"])
    assert mesh.to_skfem().nelements == mesh.size


def test_levels_that_change() -> None:
    body = Domain.ball(size=0.2)
    mesh = octree(body, lambda x: 0.06 + 0.3 * np.abs(x[:, 0])).mesh("hexahedra")
    assert set(mesh.cells) == {"hexahedron", "pyramid", "tetra"}
    assert check(mesh)


@pytest.mark.parametrize(("step", "fewer"), [([1, 1, 0], 8), ([1, 1, 1], 2)])
def test_leaves_that_touch_are_left_out(step: list[int], fewer: int) -> None:
    points, number = np.unique(np.concatenate([UNIT, UNIT + step]), axis=0, return_inverse=True)
    body = Domain(points, number.ravel()[np.concatenate([SIDES, SIDES + 8])])
    mesh = octree(body, 0.25, box=[[0, 0, 0], [2, 2, 2]]).mesh("hexahedra")
    assert check(mesh)
    assert mesh.size == 128 - fewer
    assert mesh.counts["left out where leaves touch at edges or corners only"] == fewer


def test_regions_and_inner_facets() -> None:
    mesh = octree(halves(0.45), 0.1).mesh("hexahedra")
    assert check(mesh)
    x = mesh.points[mesh.cells["hexahedron"]][..., 0]
    assert ((x.max(axis=1) <= 0.45) == (mesh.markers["region"] == mesh.regions["a"])).all()
    assert ((x.min(axis=1) >= 0.45) == (mesh.markers["region"] == mesh.regions["b"])).all()
    whole = octree(halves(0.5), 0.125, box=[[0, 0, 0], [1, 1, 1]]).mesh("hexahedra")
    assert whole.figures["share of volume"] == 1


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([6, 10, 17]), st.sampled_from(["edges", "corners"]))
def test_random_bodies(seed: int, parts: int, balance: str) -> None:
    body = blob(seed)
    size = (body.bounds[1] - body.bounds[0]).max() / parts
    tree = octree(body, lambda x: size * (1 + (seed % 3) * np.abs(x[:, 0])), balance=balance)
    try:
        mesh = tree.mesh("hexahedra")
    except InputError as error:
        assert "no leaf lies inside" in str(error)
        return
    assert check(mesh)


def test_nothing_inside() -> None:
    with pytest.raises(InputError, match="no leaf lies inside of the body; give a smaller size"):
        octree(Domain.ball(size=0.3), 2.0).mesh("hexahedra")


def test_pinched_vertices() -> None:
    """Two tetrahedra at a vertex, two at an edge, two at a face."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]], float)
    for other, bad in (([0, 4, 6, 5], {0}), ([0, 1, 6, 5], {0, 1}), ([0, 1, 6, 2], set())):
        rows = np.array([[0, 1, 2, 3], other], dtype=np.int32)
        mesh = Mesh(points, rows).oriented()
        assert set(pinched_vertices(mesh.simplices, np.unique(mesh.boundary), 7).tolist()) == bad
