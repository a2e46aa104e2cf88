"""Directions of rays: the chapter's stages, the center of the smallest cap, and exact visibility."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain
from unstruct.generate.prisms.directions import directed, most_normal, smoothed, staged, weighted
from unstruct.generate.prisms.records import Walls
from unstruct.generate.prisms.stars import stars_of, unit_normals
from unstruct.generate.prisms.visibility import visible
from unstruct.generate.prisms.walls import base_of


def cone(rim: np.ndarray, tip: tuple[float, ...] = (0.0, 0.0, 0.0)) -> Walls:
    """Triangles around one vertex, in the order of a closed rim."""
    n = len(rim)
    points = np.concatenate([np.array([tip], dtype=float), np.asarray(rim, dtype=float)])
    rows = [(0, 1 + i, 1 + (i + 1) % n) for i in range(n)]
    planes = np.full((n + 1, 2), -1, dtype=np.int32)
    return Walls(points, np.array(rows, dtype=np.int32), np.arange(n + 1, dtype=np.int32),
                 np.zeros(n, dtype=np.int32), planes, np.empty((0, 3)))  # fmt: skip


def sees(walls: Walls, v: int, direction: np.ndarray) -> bool:
    """In rational arithmetic."""
    d = [Fraction(x) for x in direction.tolist()]
    for row in walls.triangles[(walls.triangles == v).any(axis=1)].tolist():
        a, b, c = ([Fraction(x) for x in walls.points[i].tolist()] for i in row)
        e, f = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
        n = [e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3] for k in range(3)]
        if sum(x * y for x, y in zip(n, d)) <= 0:
            return False
    return True


def best_of_all(normals: np.ndarray) -> float:
    """The greatest least cosine, by trying all pairs and triples."""
    found = [n for n in normals]
    for i, j in combinations(range(len(normals)), 2):
        found.append(normals[i] + normals[j])
    for i, j, k in combinations(range(len(normals)), 3):
        pole = np.cross(normals[j] - normals[i], normals[k] - normals[i])
        found += [pole, -pole]
    best = -1.0
    for v in found:
        length = np.linalg.norm(v)
        if length > 1e-12:
            best = max(best, float((normals @ (v / length)).min()))
    return best


RAYS = np.array([(0, -2, 1), (1, 0, -2), (-1, 1, 1), (-2, 1, 0)], dtype=float)


def test_a_fan_that_the_weighted_normal_does_not_see() -> None:
    """Four edges around a vertex: all faces see (0, 0, 1), but the sum weighted by angles misses one."""
    walls = cone(RAYS)
    assert not visible(walls, weighted(walls, "angle"))[0]
    best, least = most_normal(walls)
    assert visible(walls, best)[0] and least[0] > 0.2 and sees(walls, 0, best[0])
    assert visible(walls, np.tile([0.0, 0.0, 1.0], (5, 1)))[0]
    found, seen = directed(walls, "angle", 40.0, 10, stars_of(walls.triangles, 5))
    assert seen[0] and visible(walls, found)[0]


@settings(max_examples=80, deadline=None)
@given(st.integers(3, 12), st.integers(0, 10**6), st.sampled_from([0.02, 0.3, 1.0, 3.0]))
def test_the_center_is_that_of_the_smallest_cap(n: int, seed: int, rough: float) -> None:
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.random(n)) * 2 * np.pi
    rim = np.column_stack([np.cos(angle), np.sin(angle), rough * rng.standard_normal(n)])
    walls = cone(rim)
    normals, _ = unit_normals(walls.points, walls.triangles)
    wanted = best_of_all(normals)
    best, least = most_normal(walls)
    if wanted > 1e-9:
        assert least[0] == pytest.approx(wanted, abs=1e-9)
    assert visible(walls, best)[0] == sees(walls, 0, best[0])
    if wanted > 1e-9:
        assert visible(walls, best)[0]


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(*[st.integers(-4, 4)] * 3), min_size=3, max_size=7), st.integers(-2, 2))
def test_visibility_is_exact_on_integers(rim: list[tuple[int, int, int]], unit: int) -> None:
    """Many of these directions lie exactly in the plane of a triangle."""
    walls = cone(np.array(rim) * 2.0 ** (140 * unit))
    for direction in [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (1.0, -1.0, 2.0), (1 / 3, 1e-17, -1.0)]:
        rows = np.tile(direction, (len(rim) + 1, 1))
        assert visible(walls, rows)[0] == sees(walls, 0, np.array(direction))


def test_visibility_within_rounding() -> None:
    """A direction that is off the plane of a triangle by the last bit of a coordinate."""
    rim = np.array([(1.0, 0.0, 0.0), (0.0, 1.0, 0.1), (-1.0, -1.0, 0.1)])
    for tiny in (2.0**-60, 2.0**-1000, -(2.0**-60), 0.0):
        walls = cone(rim + np.array([[0, 0, tiny], [0, 0, 0], [0, 0, 0]]))
        for direction in ([0.1, 0.2, 0.3], [1.0, 0.0, 0.0], [1.0, 0.0, 2 * tiny]):
            rows = np.tile(np.array(direction), (4, 1))
            assert visible(walls, rows)[0] == sees(walls, 0, rows[0])


def test_the_chapters_stages() -> None:
    """On an edge of a box the mean of the two sides, whatever the angles; at its corners by angles."""
    corner = base_of(Domain.box(), None, "outside").walls
    found = staged(corner, 40.0)
    assert np.abs(np.abs(found) - 1 / np.sqrt(3)).max() < 1e-15  # though faces are cut into triangles
    by_area = weighted(corner, "area")
    assert np.abs(np.abs(by_area) - 1 / np.sqrt(3)).max() > 0.01
    rim = np.array([(0, 1, 0), (-1, 1, 0), (-1, -1, 0), (0, -1, 0), (0, -1, -1), (0, 1, -1)], dtype=float)
    edge = cone(rim)
    assert staged(edge, 40.0)[0] == pytest.approx([np.sqrt(0.5), 0, np.sqrt(0.5)], abs=1e-15)
    assert staged(edge, 100.0)[0] == pytest.approx(weighted(edge, "angle")[0])


def test_smoothing_keeps_all_triangles_in_sight() -> None:
    rng = np.random.default_rng(3)
    shell = Domain.ball(size=0.3).triangulated
    noise = 1 + 0.15 * rng.standard_normal((len(shell.points), 1))
    walls = base_of(Domain(shell.points * noise, shell.triangles), None, "outside").walls
    best, least = most_normal(walls)
    before = visible(walls, best)
    for rounds in (1, 10, 100):
        after = smoothed(walls, best, rounds)
        assert (visible(walls, after) >= before).all()
        normals, _ = unit_normals(walls.points, walls.triangles)
        cosines = np.full(len(least), np.inf)
        np.minimum.at(
            cosines, walls.triangles.ravel(), (normals[:, None] * after[walls.triangles]).sum(2).ravel()
        )
        assert (cosines >= np.minimum(0.9 * least, 0.5) - 1e-12)[least > 0].all()


def test_rays_in_planes_stay_in_them_exactly() -> None:
    walls = base_of(Domain.box(), ["bottom", "left"], "inside").walls
    found, seen = directed(walls, "visible", 40.0, 10, stars_of(walls.triangles, len(walls.points)))
    assert seen.all()
    for v, planes in enumerate(walls.planes.tolist()):
        for p in planes:
            assert p < 0 or (found[v] * walls.normals[p]).sum() == 0.0
