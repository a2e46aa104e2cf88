"""Smoothing: against the plain version, by `check`, and what must stay where it is."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from fixtures import HARD_2D
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import InputError, Mesh, MeshError, check, delaunay, simplex, statistics
from unstruct.connect.planar import stars as stars2
from unstruct.examples.running import sweep_triangulation
from unstruct.generate.improve.smoothing import METHODS, smooth
from unstruct.mesh.domain_mesh import DomainMesh
from unstruct.mesh.topology import twins
from unstruct.plain.smoothing import laplacian_round

EVERY = list(METHODS)


def cloud(n: int = 300, seed: int = 0) -> Mesh:
    return delaunay(np.random.default_rng(seed).random((n, 2)))


def rim(mesh: Mesh) -> np.ndarray:
    return np.unique(mesh.boundary)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10**6), st.booleans(), st.integers(8, 40))
def test_one_round_is_the_plain_one(seed: int, lattice: bool, n: int) -> None:
    rng = np.random.default_rng(seed)
    rows = np.unique(rng.integers(0, 9, (n, 2)), axis=0).astype(float) if lattice else rng.random((n, 2))
    rows = np.concatenate([rows, [[-1.0, -1.0], [11.0, -1.0], [5.0, 12.0]]])
    mesh = sweep_triangulation(rows)
    new = smooth(mesh, "laplace", rounds=1, smart=False, swap=False)
    expected = laplacian_round(mesh.points.tolist(), mesh.simplices.tolist(), rim(mesh).tolist())
    np.testing.assert_allclose(new.points, np.array(expected, dtype=float), rtol=0, atol=1e-9)
    assert check(new)


@pytest.mark.parametrize("method", EVERY)
def test_the_mesh_stays_delaunay_and_its_rim_stays(method: str) -> None:
    mesh = cloud(2000)
    new = smooth(mesh, method, rounds=4)
    assert check(new, delaunay="constrained")
    np.testing.assert_array_equal(new.points[rim(mesh)], mesh.points[rim(mesh)])
    assert new.volume == pytest.approx(mesh.volume)
    assert new.counts["moved"] > 500 and new.counts["swaps"] > 0
    assert statistics(new).mean_round > statistics(mesh).mean_round + 0.05
    again = smooth(mesh, method, rounds=4)
    np.testing.assert_array_equal(again.points, new.points)
    np.testing.assert_array_equal(again.simplices, new.simplices)


@pytest.mark.parametrize("method", EVERY)
def test_smart_moves_never_spoil_the_worst(method: str) -> None:
    mesh = cloud(500, seed=3)
    worst = [mesh.quality("2r/R").min()]
    for _ in range(5):
        mesh = smooth(mesh, method, rounds=1, swap=False)
        worst.append(mesh.quality("2r/R").min())
    assert all(after >= before for before, after in pairwise(worst))


@pytest.mark.parametrize("name", HARD_2D)
def test_hard_points_stay_valid(name: str) -> None:
    mesh = delaunay(HARD_2D[name])
    for method in EVERY:
        assert check(smooth(mesh, method, rounds=2, smart=False)), method


def test_marked_edges_and_named_vertices_stay() -> None:
    mesh = cloud(400)
    inside = np.setdiff1d(np.arange(400), rim(mesh))
    wall = mesh.edges[np.isin(mesh.edges, inside).all(axis=1)][::40]
    held = np.setdiff1d(inside, wall)[:5]
    marked = Mesh(mesh.points, mesh.simplices, markers={"wall": wall, "held": held[:, None]})
    new = smooth(marked, smart=False)
    still = np.concatenate([wall.ravel(), held])
    np.testing.assert_array_equal(new.points[still], mesh.points[still])
    edges = set(map(tuple, new.edges.tolist()))
    assert all(tuple(sorted(row)) in edges for row in wall.tolist())
    assert check(new, delaunay="constrained")
    (moved,) = np.nonzero((new.points != mesh.points).any(axis=1))
    assert len(moved) > 200


def test_vertices_of_a_domain_stay_unless_told_otherwise() -> None:
    mesh = cloud(200)
    origin = np.full(200, -1)
    origin[50:] = np.arange(150)
    domain = DomainMesh(mesh.points, mesh.simplices, origin=origin, unrefined=[0], reasons=["why"])
    new = smooth(domain, swap=False)
    np.testing.assert_array_equal(new.points[50:], mesh.points[50:])
    assert not new.complete and new.reasons.tolist() == ["why"]
    freed = smooth(domain, fixed=[7])
    assert (freed.points[50:] != mesh.points[50:]).any()
    np.testing.assert_array_equal(freed.points[7], mesh.points[7])


def test_only_what_is_bad_is_looked_at() -> None:
    mesh = cloud(1000)
    assert smooth(mesh, below=0.0).counts == {
        "moved": 0, "invalid": 0, "worse": 0, "swaps": 0, "examined": 0, "rounds": 1,
    }  # fmt: skip
    few = smooth(mesh, below=0.3, rounds=1).counts["examined"]
    assert 0 < few < smooth(mesh, rounds=1).counts["examined"]


def test_bad_input() -> None:
    mesh = cloud(20)
    with pytest.raises(InputError, match="no method is called 'cotangent'"):
        smooth(mesh, "cotangent")
    with pytest.raises(InputError, match="negative"):
        smooth(mesh, rounds=-1)
    with pytest.raises(InputError, match=r"rounds = 1\.5 must be a whole number"):
        smooth(mesh, rounds=1.5)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="below = nan must be finite"):
        smooth(mesh, below=float("nan"))
    with pytest.raises(MeshError, match="nothing to smooth"):
        smooth(Mesh(np.empty((0, 2)), np.empty((0, 3), dtype=int)))
    with pytest.raises(MeshError, match="not None"):
        smooth(None)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="fixed"):
        smooth(mesh, fixed=[99])
    with pytest.raises(MeshError, match="exponents"):
        smooth(Mesh([[0, 5e-324], [1e300, 0], [0, 1e300]], [[0, 1, 2]]))
    with pytest.raises(MeshError, match=r"simplices\[0\]"):
        smooth(Mesh(mesh.points, mesh.simplices[:, ::-1]))
    with pytest.raises(MeshError):
        smooth(delaunay(np.random.default_rng(0).random((20, 3))))


@pytest.mark.parametrize("judge", [stars2.FAIRNESS, stars2.ROUNDNESS])
def test_measures_of_a_star(judge: int) -> None:
    rng = np.random.default_rng(judge)
    for _ in range(50):
        k = int(rng.integers(3, 9))
        angle = 2 * np.pi * (np.arange(k + 1) % k + 0.3 * rng.random()) / k
        places = 0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        x, y = 0.1 * rng.random(2)
        rows = np.stack([places[:-1], places[1:], np.broadcast_to([x, y], (k, 2))], axis=1)
        square = sum(((rows[:, i] - rows[:, i - 1]) ** 2).sum(axis=1) for i in range(3))
        fair = 4 * np.sqrt(3) * simplex.volume(rows) / square
        wanted = fair if judge == stars2.FAIRNESS else simplex.quality("2r/R", rows)
        least, sine, total = stars2.star_measures(places, k, x, y, -1.0, judge)
        assert least == pytest.approx(wanted.min()) and total == pytest.approx(wanted.sum())
        if judge == stars2.FAIRNESS:
            real = np.sin(np.radians(simplex.quality("min_angle", rows).min())) ** 2
            assert sine == pytest.approx(real) or (sine == 1.0 and real > stars2.SAFE)
        assert stars2.star_measures(places, k, x, y, least, judge)[0] == -1.0
        assert stars2.star_measures(places, k, x, y, 0.99 * least, judge) == (least, sine, total)


def test_a_star_is_refused_by_exact_signs() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
    for height, valid in ((0.0, False), (-1e-300, False), (5e-324, True), (1e-200, True), (1e-12, True)):
        least, _, _ = stars2.star_measures(square, 4, 0.5, height, -1.0, stars2.ROUNDNESS)
        assert (least >= 0.0) == valid


def test_swaps_for_many_moves_at_once() -> None:
    mesh = cloud(2000)
    pressed = smooth(mesh, rounds=3, smart=False, swap=False)
    assert not check(pressed, delaunay=True)
    xy, vertex, twin = pressed.points, pressed.simplices.ravel().copy(), twins(pressed.neighbors)
    region, at = np.zeros(mesh.size, dtype=np.int32), np.empty(len(xy), dtype=np.int32)
    stars2.opposite_half_edges(vertex, region, mesh.size, at)
    mark = np.where(twin < 0, 0, -1).astype(np.int32)
    moved = (xy != mesh.points).any(axis=1)
    where, stack = np.zeros(1, dtype=np.int32), np.empty(8, dtype=np.int32)  # hardly any room: more rounds
    still, ring, places = np.zeros(len(xy), dtype=bool), np.empty(64, dtype=np.int32), np.empty((65, 2))
    counts = np.zeros(8, dtype=np.int64)
    stars = stars2.Stars(xy, vertex, twin, mark, where, at, still, ring, places, stack, counts)
    assert stars2.legalize_moved(stars, region, mesh.size, moved) > 100
    assert check(Mesh(xy, vertex.reshape(-1, 3)), delaunay=True)
    assert stars2.legalize_moved(stars, region, mesh.size, moved) == 0
