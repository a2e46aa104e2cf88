"""Names of a domain on the cells of its tree: regions of what lies in one, and the pieces that cells meet."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.generate.hexahedra.test_dominant import halves
from unstruct import Domain, InputError, constrained_delaunay, octree, quadtree


def rooms(x: float = 0.4, y: float = 0.55) -> Domain:
    """A square of three regions, one of them without a name, and a crack."""
    points = [(0, 0), (x, 0), (1, 0), (1, y), (1, 1), (0, 1), (x, 1), (x, y), (0.7, 0.2), (0.8, 0.3)]
    facets = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 6), (6, 5), (5, 0)]
    return Domain(
        points,
        facets,
        inner=[(1, 7), (7, 6), (7, 3), (8, 9)],
        markers={"left": [6], "wall": [7, 8], "leaf": [0]},
        regions={"west": [(0.1, 0.5)], "south": [(0.9, 0.1)]},
    )


@settings(max_examples=30, deadline=None)
@given(st.integers(2, 10), st.integers(6, 14), st.integers(2, 5), st.booleans())
def test_as_asked_at_many_places(i: int, j: int, level: int, fine: bool) -> None:
    """Walls on lines of the lattice and between them; regions are those of all places of a leaf."""
    domain = rooms(i / 16, j / 16)
    tree = quadtree(domain, 2.0**-level, box=[[0, 0], [1, 1]])
    if fine:
        tree = tree.refined(np.arange(0, len(tree), 3))
    mesh = tree.mesh("cells")
    assert mesh.regions == {"west": 0, "south": 1}
    region = mesh.markers["region"]
    steps = (np.arange(7) + 0.5) / 7
    places = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    low, high = tree.corners
    x = low[:, None] + places * (high - low)[:, None]
    truth = constrained_delaunay(domain)
    at = truth.markers["region"][truth.find_simplex(x.reshape(-1, 2))].reshape(len(tree), -1)
    named = region >= 0
    assert (at[named] == region[named][:, None]).all()
    differ = at.min(axis=1) < at.max(axis=1)
    assert (region[differ] == -1).all()
    whole = mesh.markers["state"] == 1
    crack = (np.maximum(low, [0.7, 0.2]) < np.minimum(high, [0.8, 0.3])).all(axis=1)
    assert (region[whole & ~differ & ~crack] >= 0).all()
    left = mesh.markers["left"]
    assert np.array_equal(left == 1, low[:, 0] == 0.0)
    wall = (low[:, 0] <= i / 16) & (high[:, 0] >= i / 16)
    assert np.array_equal(mesh.markers["wall"] == 1, wall)
    assert np.array_equal(mesh.markers["leaf"], np.arange(len(tree)))  # our own name comes first
    fans = tree.mesh("conforming")
    for name in ("region", "wall", "left"):
        assert np.array_equal(fans.markers[name], mesh.markers[name][fans.markers["leaf"]])


def test_curves_divide() -> None:
    disc, small = Domain.disc(radius=1.0), Domain.disc(radius=0.5)
    n = len(disc.points)
    domain = Domain(
        np.concatenate([disc.points, small.points]),
        disc.facets,
        inner=np.asarray(small.facets) + n,
        curves=disc.curves | {len(disc.facets) + k: c for k, c in small.curves.items()},
        regions={"core": [(0, 0)], "rim": [(0.8, 0)]},
        markers={"seam": np.arange(len(disc.facets), len(disc.facets) + len(small.facets))},
    )
    mesh = quadtree(domain, 0.06).mesh("cells")
    low, high = mesh.points[mesh.cells["quad"][:, [0, 2]]].transpose(1, 0, 2)
    far = np.sqrt((np.maximum(np.abs(low), np.abs(high)) ** 2).sum(axis=1))
    near = np.sqrt((np.where((low < 0) & (high > 0), 0, np.minimum(np.abs(low), np.abs(high))) ** 2).sum(1))
    region = mesh.markers["region"]
    assert np.array_equal(region == 0, far < 0.5)
    assert np.array_equal(region == 1, (near > 0.5) & (far < 1.0))
    assert np.array_equal(mesh.markers["seam"] == 1, (near <= 0.5) & (far >= 0.5))


@pytest.mark.parametrize("at", [0.45, 0.5])
def test_in_space(at: float) -> None:
    tree = octree(halves(at), 1 / 8, box=[[0, 0, 0], [1, 1, 1]])
    mesh = tree.mesh("cells")
    low, high = tree.corners
    right = np.where(low[:, 0] >= at, 0, np.where(high[:, 0] <= at, 1, -1))
    assert np.array_equal(mesh.markers["region"], right)
    assert np.array_equal(mesh.markers["wall"] == 1, (low[:, 0] <= at) & (high[:, 0] >= at))
    assert np.array_equal(mesh.markers["left"] == 1, low[:, 0] == 0)
    assert mesh.regions == {"b": 0, "a": 1}


def test_what_has_no_names() -> None:
    assert quadtree([[0, 0], [1, 1]], 0.3).mesh("cells").markers.keys() == {
        "leaf",
        "level",
        "state",
        "hanging",
    }
    assert "region" not in quadtree(Domain.disc(), 0.3).mesh("cells").markers
    one = halves()
    both = Domain(one.points, one.facets, regions={"a": [(0.2, 0.5, 0.5)], "b": [(0.8, 0.1, 0.5)]})
    with pytest.raises(InputError, match="region 'b' is in the same part as one of 'a'"):
        octree(both, 0.25).mesh("cells")
