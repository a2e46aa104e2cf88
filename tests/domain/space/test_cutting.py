"""Polygons in space cut into triangles: with holes, not convex, nearly flat, seen along all axes; chords."""

from __future__ import annotations

from collections import Counter
from itertools import combinations, pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, DomainError
from unstruct.domain.space.cutting import cut
from unstruct.domain.space.flat import chords_of
from unstruct.geometry.polygons import Polygons

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def star(rng: np.random.Generator, many: int, low: float, high: float) -> np.ndarray:
    """A ring about the origin with integer corners, seldom convex."""
    angle = (np.arange(many) + rng.uniform(0, 0.5, many)) * 2 * np.pi / many
    radius = rng.uniform(low, high, many)
    return np.round(np.column_stack([np.cos(angle), np.sin(angle)]) * radius[:, None])


@st.composite
def rings(draw: st.DrawFn) -> tuple[np.ndarray, list[list[int]]]:
    """A polygon with up to four holes in an oblique plane, each ring in either direction."""
    rng = np.random.default_rng(draw(st.integers(0, 2**16)))
    flat = [star(rng, draw(st.integers(12, 36)), 600, 1000)]
    for k in range(draw(st.integers(0, 4))):
        center = np.array([[-240, -240], [240, -240], [240, 240], [-240, 240]])[k]
        flat.append(star(rng, draw(st.integers(3, 8)), 60, 200)[::-1] + center)
    x = np.concatenate(flat)
    a, b = draw(st.integers(-1, 1)), draw(st.integers(-1, 1))
    points = np.column_stack([x, x @ [a, b]])[:, np.roll(np.arange(3), draw(st.integers(0, 2)))]
    ends = np.cumsum([0, *map(len, flat)])
    number = rng.permutation(len(x))
    placed = np.empty_like(points)
    placed[number] = points
    numbered = [number[i:j] for i, j in pairwise(ends)]
    return placed, [ring[::-1].tolist() if draw(st.booleans()) else ring.tolist() for ring in numbered]


def area(points: np.ndarray, ring: list[int]) -> np.ndarray:
    """Twice the area as a vector; exact for small integers."""
    return np.cross(points[ring], points[np.roll(ring, -1)]).sum(axis=0)


def edges_fit(triangles: np.ndarray, polygon: list[list[int]]) -> bool:
    """Sides of the polygon bound one triangle, other edges two, on either side."""
    turned = Counter(pair for a, b, c in triangles.tolist() for pair in ((a, b), (b, c), (c, a)))
    sides = {frozenset(pair) for ring in polygon for pair in zip(ring, np.roll(ring, -1).tolist())}
    for (u, v), count in turned.items():
        if count != 1 or (turned[v, u] == 0) != (frozenset((u, v)) in sides):
            return False
    return len({frozenset(pair) for pair in turned}) == len(sides) + (3 * len(triangles) - len(sides)) // 2


@settings(max_examples=50)
@given(rings(), st.sampled_from([1.0, 2.0**-20, 1e100]), st.sampled_from([0.0, 0.3]))
def test_triangles_fill_the_polygon(polygon: tuple, scale: float, rough: float) -> None:
    points, numbers = polygon
    moved = points + np.random.default_rng(0).uniform(-rough, rough, points.shape)
    shell, faults = cut(moved * scale, Polygons.of_rings([numbers]), 1)
    assert not faults
    assert edges_fit(shell.triangles, numbers)
    vectors = np.cross(
        points[shell.triangles[:, 1]] - points[shell.triangles[:, 0]],
        points[shell.triangles[:, 2]] - points[shell.triangles[:, 0]],
    )
    if not rough:
        outline = area(points, numbers[0])
        inside = [area(points, ring) for ring in numbers[1:]]
        ahead = np.sign(outline @ outline)
        whole = outline - sum(ahead * np.sign(outline @ hole) * hole for hole in inside)
        assert (vectors.sum(axis=0) == whole).all() and (vectors @ outline > 0).all()


def test_rings_that_touch_or_cross() -> None:
    flat = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 2), (2, 1), (2, 3), (9, 9)]
    points = np.array([(*p, 0.0) for p in flat])
    for hole, kind in (
        ([4, 5, 6], "crossing itself"),  # a corner on a side
        ([0, 5, 6], "repeated vertex"),  # a corner in common
        ([7, 5, 6], "crossing itself"),
    ):
        with pytest.raises(DomainError) as caught:
            Domain(points, [[[0, 1, 2, 3], hole]])
        assert {fault.kind for fault in caught.value.faults} == {kind}


@pytest.mark.parametrize("off", [0.0, 0.9e-3, 1.2e-3])
def test_how_flat_a_polygon_must_be(off: float) -> None:
    """Vertices may be off the plane by 1/1000 of the extent: here by off of a square's diagonal each."""
    points = CORNERS.copy()
    points[[0, 3], 0] += off * np.sqrt(2)
    points[[1, 2], 0] -= off * np.sqrt(2)
    if off > 1e-3:
        with pytest.raises(DomainError, match="do not lie in a plane"):
            Domain(points, SIDES)
    else:
        assert abs(Domain(points, SIDES).volume - 1.0) < 1e-3


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("diagonal", [0, 1])
@pytest.mark.parametrize("off", [0.0, 1e-4])
def test_inner_segments_between_corners_of_a_facet(side: tuple, diagonal: int, off: float) -> None:
    """Either diagonal of each side, also where the side is flat only nearly, is an edge of its triangles."""
    points = CORNERS.copy()
    points[7] += off
    pair = (side[diagonal], side[diagonal + 2])
    domain = Domain(points, SIDES, inner=[pair])
    triangles = domain.triangulated.triangles
    assert sum({*pair} <= {*row} for row in triangles.tolist()) == 2
    if off == 0.0:
        with pytest.raises(DomainError, match=r"inner segment 1 = .* lies in facet"):
            Domain(points, SIDES, inner=[(side[0], side[2]), (side[1], side[3])])


def test_chords_of_polygons_that_are_not_convex() -> None:
    """All pairs of corners of an L: chords inside are edges; outside they are free; none crosses it."""
    ring = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    points = np.array([(*p, z) for z in (0.0, 1.0) for p in ring])
    facets = [[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11]]
    facets += [[i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i] for i in range(6)]
    through = {(0, 2), (0, 3), (0, 4), (1, 3), (3, 5)}
    outside, blocked = {(2, 4)}, {(1, 4), (2, 5), (1, 5)}  # (1, 4), (2, 5) meet vertex 3 or cross sides
    sides = {tuple(sorted((k, (k + 1) % 6))) for k in range(6)}
    for pair in combinations(range(6), 2):
        if pair in sides:
            with pytest.raises(DomainError):
                Domain(points, facets, inner=[pair, pair])
        elif pair in blocked:
            with pytest.raises(DomainError, match="point 3 lies" if pair == (1, 5) else "put a vertex"):
                Domain(points, facets, inner=[pair])
        else:
            domain = Domain(points, facets, inner=[pair])
            count = sum({*pair} <= {*row} for row in domain.triangulated.triangles.tolist())
            assert count == (2 if pair in through else 0) and (pair in through) != (pair in outside)


def test_inner_facets_end_in_facets() -> None:
    """A wall along either diagonal of two opposite sides."""
    for wall in ((0, 3, 7, 4), (1, 2, 6, 5)):
        domain = Domain(CORNERS, SIDES, inner=[wall], regions={"a": (0.5, 0.1, 0.2), "b": (0.5, 0.9, 0.8)})
        assert domain.volume == 1.0
    assert chords_of(Polygons.of_rings([[s] for s in SIDES])) == {}
    chords = chords_of(Polygons.of_rings([*[[s] for s in SIDES], [(0, 3, 7, 4)]]))
    assert {i: rows.tolist() for i, rows in chords.items()} == {0: [[0, 3]], 1: [[4, 7]]}
