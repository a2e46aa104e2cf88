"""Sharp edges kept: chains of edges of the mesh, exactly, on boxes, notches and wedges."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from tests.helpers.value_tables import assert_sound, dihedral_range
from unstruct import Domain, InputError, check, examples, isosurface_stuffing

TURN = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]


def wedge(angle: float) -> Domain:
    c, s = np.cos(angle), np.sin(angle)
    points = np.array([(0, 0, 0), (1, 0, 0), (c, s, 0), (0, 0, 1), (1, 0, 1), (c, s, 1)])
    return Domain(points, [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]])


def turned(body: Domain) -> Domain:
    return Domain(body.points @ TURN, body.facets)


BODIES = {
    "box": (Domain.box(), 0.21, 12),
    "turned box": (turned(Domain.box()), 0.15, 12),
    "notch": (examples.notched_box(), 0.3, 21),
    "turned notch": (turned(examples.notched_box()), 0.25, 21),
    "wedge of 45 degrees": (turned(wedge(np.pi / 4)), 0.12, 9),
    "wedge of 20 degrees": (wedge(np.pi / 9), 0.07, 9),
}


@pytest.mark.parametrize("name", BODIES)
def test_each_crease_is_a_chain_of_edges(name: str) -> None:
    body, size, creases = BODIES[name]
    mesh = isosurface_stuffing(body, size, features=30)
    assert mesh.complete
    assert check(mesh)
    assert_sound(mesh)
    assert mesh.volume == pytest.approx(body.volume, rel=1e-12)
    assert 0 < mesh.counts["strip"] < mesh.size
    origin = np.asarray(mesh.origin)
    assert np.array_equal(np.sort(origin[origin >= 0]), np.arange(len(body.points)))
    assert np.array_equal(mesh.points[origin >= 0], body.points[origin[origin >= 0]])

    sides = {tuple(sorted(pair)) for row in body.facets for pair in zip(row, [*row[1:], row[0]], strict=True)}
    assert len(sides) == creases
    edges = set(map(tuple, np.asarray(mesh.edges).tolist()))
    total = 0
    for i, j in sides:
        a, b = body.points[i], body.points[j]
        along = b - a
        share = ((mesh.points - a) * along).sum(axis=1) / (along**2).sum()
        off = np.abs(mesh.points - a - share[:, None] * along).max(axis=1)
        on = np.flatnonzero((off < 1e-14) & (share > -1e-14) & (share < 1 + 1e-14))
        chain = on[np.argsort(share[on])].tolist()
        assert {origin[chain[0]], origin[chain[-1]]} == {i, j}
        assert all(tuple(sorted(pair)) in edges for pair in pairwise(chain))
        total += len(chain) - 1
    assert total == mesh.counts["on creases"]

    least, most = dihedral_range(mesh)
    assert least >= 8
    assert most <= 164.8


def test_the_other_cells_are_stuffed() -> None:
    body = turned(Domain.box())
    plain, mesh = isosurface_stuffing(body, 0.12), isosurface_stuffing(body, 0.12, features=30)
    count = mesh.size - mesh.counts["strip"]
    kept = {frozenset(map(tuple, x)) for x in mesh.points[mesh.simplices[:count]].tolist()}
    assert kept < {frozenset(map(tuple, x)) for x in plain.points[plain.simplices].tolist()}


@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
@pytest.mark.parametrize("graded", (False, True))
@pytest.mark.parametrize("seed", range(6))
def test_the_strip_has_the_size_of_the_cells_beside_it(seed: int, graded: bool) -> None:
    """Sizes that vary: edges of the size in a strip as wide as a smaller cell gave angles of 5 degrees."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    box, low, growth = Domain.box(), rng.uniform(0.1, 0.16), rng.uniform(0.1, 0.4)
    body, place = Domain(box.points @ turn, box.facets), rng.uniform(0.0, 0.6, 3) @ turn

    def size(x: np.ndarray) -> np.ndarray:
        return low + growth * np.sqrt(np.square(x - place).sum(axis=1))

    mesh = isosurface_stuffing(body, size, features=30, graded=graded)
    assert check(mesh) and mesh.volume == pytest.approx(1.0, rel=1e-12)
    assert mesh.counts["strip"] > 0 and not any("not kept" in why for why in mesh.reasons)
    least, most = mesh.quality("min_dihedral"), mesh.quality("max_dihedral")
    poor = np.flatnonzero((least < 10.0) | (most > 165.0))
    assert np.isin(poor, mesh.unrefined).all() and len(poor) <= 2
    if not graded:
        assert least.min() > 12.0 and most.max() < 158.0


@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
def test_poor_cells_of_the_strip_are_listed() -> None:
    """In a wedge of 6 degrees there must be some."""
    mesh = isosurface_stuffing(turned(wedge(np.pi / 30)), 0.03, features=30)
    poor = np.flatnonzero((mesh.quality("min_dihedral") < 10.0) | (mesh.quality("max_dihedral") > 165.0))
    assert len(poor) > 0 and not mesh.complete and np.isin(poor, mesh.unrefined).all()
    assert "in the strip along a sharp edge" in " ".join(mesh.reasons)


def test_names_stay() -> None:
    mesh = isosurface_stuffing(Domain.box(), 0.3, features=30)
    assert sum(map(len, mesh.markers.values())) == len(mesh.boundary)
    assert (np.abs(mesh.points[mesh.markers["left"]][:, :, 0]) < 1e-15).all()


def test_refusals() -> None:
    with pytest.raises(InputError, match="must be flat"):
        isosurface_stuffing(Domain.cylinder(size=0.4), 0.2, features=50)
    with pytest.raises(InputError, match="features are kept of a surface"):
        isosurface_stuffing(examples.sphere(), 0.3, features=30)
    with pytest.raises(InputError, match="between 0 and 180"):
        isosurface_stuffing(Domain.box(), 0.3, features=200.0)
