"""`Domain.simplified`: what is left is valid, near, and on the same side; a `Sampled` is a domain."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import KINDS, random_region
from segments import coastline

from benchmarks.inputs import fractal_coast
from unstruct import (
    Domain,
    InputError,
    check,
    circumcenter_insertion,
    conforming_delaunay,
    constrained_delaunay,
    refine,
    voronoi_segment,
)
from unstruct.geometry.curves import Arc


def star(rng: np.random.Generator, n: int) -> np.ndarray:
    angle = 2 * np.pi * np.arange(n) / n
    return rng.uniform(0.3, 1.0, (n, 1)) * np.column_stack([np.cos(angle), np.sin(angle)])


def distance(x: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """From each point to the nearest segment (s, 2, 2)."""
    a, u = segments[:, 0], segments[:, 1] - segments[:, 0]
    t = np.clip(((x[:, None] - a) * u).sum(axis=2) / (u * u).sum(axis=1), 0, 1)
    return np.linalg.norm(x[:, None] - a - t[:, :, None] * u, axis=2).min(axis=1)


def straight(domain: Domain, rows: np.ndarray | None = None) -> np.ndarray:
    rows = np.setdiff1d(np.arange(len(domain.pieces)) if rows is None else rows, list(domain.curves))
    return domain.points[domain.pieces[rows]]


def dense(segments: np.ndarray) -> np.ndarray:
    t = np.linspace(0, 1, 9)[:, None, None]
    return ((1 - t) * segments[:, 0] + t * segments[:, 1]).reshape(-1, 2)


def dropped_rings(new: Domain) -> set[int]:
    return {v for r in new.repairs if r.kind == "dropped ring" for v in r.vertices}


def judge(old: Domain, new: Domain, tolerance: float) -> None:
    """All that is promised, by brute force."""
    lost = dropped_rings(new)
    named = lost | {v for r in new.repairs if r.kind == "dropped vertices" for v in r.vertices}
    assert sorted([*named, *new.origin.tolist()]) == list(range(len(old.points)))  # all are accounted for
    assert np.array_equal(new.points, old.points[new.origin])
    kept = np.array([i for i, row in enumerate(old.pieces.tolist()) if not set(row) & lost], dtype=int)
    before, after = straight(old, kept), straight(new)
    if len(after):
        assert distance(dense(before), after).max() <= tolerance * (1 + 1e-9)
        assert distance(dense(after), before).max() <= tolerance * (1 + 1e-9)
    for s, t in combinations(range(len(new.pieces)), 2):
        if s not in new.curves and t not in new.curves:
            assert not crosses(new.points, new.pieces[s].tolist(), new.pieces[t].tolist())
    x = np.random.default_rng(1).uniform(*old.bounds, (300, 2))
    far = (
        distance(x, straight(old)) > tolerance * (1 + 1e-9)
        if len(straight(old))
        else np.ones(300, dtype=bool)
    )
    assert np.array_equal(old.contains(x[far]), new.contains(x[far]))
    fixed = np.concatenate([old.points[old.loose], *old.regions.values(), np.empty((0, 2))])
    assert np.array_equal(old.contains(fixed), new.contains(fixed))
    assert set(old.markers) == set(new.markers)
    for name, pieces in old.markers.items():
        assert set(new.piece_origin[new.markers[name]]) <= set(pieces) and len(new.markers[name]) > 0


def crosses(points: np.ndarray, s: list[int], t: list[int]) -> bool:
    """Whether two segments meet in more than a common vertex, in fractions."""

    def side(a: int, b: int, c: int) -> Fraction:
        (ax, ay), (bx, by), (cx, cy) = (map(Fraction, points[v].tolist()) for v in (a, b, c))
        return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)

    def between(a: int, b: int, c: int) -> bool:
        low, high = np.minimum(points[a], points[b]), np.maximum(points[a], points[b])
        return (
            c not in (a, b) and side(a, b, c) == 0 and bool(((low <= points[c]) & (points[c] <= high)).all())
        )

    (p, q), (a, b) = s, t
    if {p, q} == {a, b} or any(between(p, q, v) for v in t) or any(between(a, b, v) for v in s):
        return True
    if {p, q} & {a, b}:
        return False
    return side(p, q, a) * side(p, q, b) < 0 and side(a, b, p) * side(a, b, q) < 0


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([*KINDS, "star", "coast"]), st.floats(-4, 0.5))
def test_simplified_regions_are_valid_and_near(seed: int, kind: str, exponent: float) -> None:
    rng = np.random.default_rng(seed)
    if kind == "star":
        old = Domain.polygon(star(rng, 40), holes=[0.2 * star(rng, 12)], regions={"a": [0.25, 0.0]})
    elif kind == "coast":
        old = Domain.polygon(coastline(120, seed % 1000), holes=[1e-3 * star(rng, 5)])
    else:
        old = random_region(rng, kind)
    tolerance = 10.0**exponent
    try:
        new = old.simplified(tolerance)
    except InputError as error:
        assert "whole region is smaller" in str(error) and np.hypot(*np.diff(old.bounds, axis=0)[0]) < 4
        return
    judge(old, new, tolerance)
    assert len(new.points) <= len(old.points)


def test_a_straight_side_becomes_one_piece() -> None:
    x = np.linspace(0, 1, 11)
    ring = [*[(t, 0.0) for t in x], (1, 1), (0, 1)]
    new = Domain.polygon(ring).simplified(1e-9)
    assert new.points.tolist() == [[0, 0], [1, 0], [1, 1], [0, 1]] and new.area == 1
    assert new.piece_origin.tolist() == [0, 10, 11, 12]
    named = Domain.polygon(ring, markers={"left half": range(5)}).simplified(1e-9)
    assert named.points[named.pieces[named.markers["left half"]]].tolist() == [[[0, 0], [0.5, 0]]]


def test_triangles_are_left_and_small_rings_go() -> None:
    island = [(0.4, 0.4), (0.41, 0.4), (0.41, 0.41), (0.4, 0.41)]
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    assert len(Domain.polygon(square).simplified(1.2).points) == 3  # smaller than its diagonal
    with pytest.raises(InputError, match="the whole region is smaller than the tolerance"):
        Domain.polygon(square).simplified(1.5)
    new = Domain.polygon(square, [island]).simplified(0.02)
    assert len(new.points) == 4 and [r.kind for r in new.repairs] == ["dropped ring"]
    assert new.repairs[0].vertices == (4, 5, 6, 7) or set(new.repairs[0].vertices) == {4, 5, 6, 7}
    for keeps in (
        {"points": [(0.405, 0.405)], "inner": None, "markers": {}},  # a loose vertex within
        {"points": [(0.402, 0.402), (0.408, 0.404)], "inner": [(8, 9)], "markers": {}},
        {"points": np.empty((0, 2)), "inner": None, "markers": {"isle": [4, 5, 6, 7]}},
    ):
        ring = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4]]
        points = np.concatenate([square, island, keeps["points"]])
        old = Domain(points, ring, inner=keeps["inner"], markers=keeps["markers"])
        assert not dropped_rings(old.simplified(0.02))


def test_common_borders_and_curves_stay_joined() -> None:
    """Two regions with a wavy border, one of them with a round side."""
    y = np.linspace(0, 1, 41)[1:-1]
    wave = np.column_stack([1 + 0.02 * np.sin(20 * y), y])
    points = np.concatenate([[(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1)], wave])
    facets = [[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [5, 0]]
    chain = [1, *range(6, 6 + len(wave)), 4]
    old = Domain(
        points, facets, inner=list(pairwise(chain)), curves={2: Arc((2, 0.5), 0.5, -np.pi / 2, np.pi)},
        regions={"west": [0.5, 0.5], "east": [1.5, 0.5]},
    )  # fmt: skip
    new = old.simplified(0.05)
    assert len(new.inner) == 1 and len(new.curves) == 1
    judge(old, new, 0.05)
    fine = old.simplified(0.005)
    assert 5 < len(fine.inner) < 30
    mesh = refine(fine, 0.2)
    assert check(mesh, domain=fine) and len(np.unique(mesh.markers["region"])) == 2


def test_what_is_in_the_way_keeps_vertices() -> None:
    """A zigzag between two others, which stay because each of their pieces has a name of its own."""
    x = np.arange(12.0)
    zigzag = np.column_stack([x, np.where(x % 2 == 0, 0.1, -0.1)])
    box = np.array([(-1, -1), (12, -1), (12, 1), (-1, 1)], dtype=float)
    chain = np.column_stack([x[:-1], x[1:]]).astype(int)
    ring = [[0, 1], [1, 2], [2, 3], [3, 0]]

    def between(*shifts: float, free: tuple[int, ...]) -> Domain:
        points = np.concatenate([box, *(zigzag + np.array([0, shift]) for shift in shifts)])
        inner = np.concatenate([chain + 4 + 12 * k for k in range(len(shifts))])
        fixed = np.setdiff1d(np.arange(len(inner)), [11 * k + i for k in free for i in range(11)])
        return Domain(points, ring, inner=inner, markers={f"{i}": [4 + i] for i in fixed.tolist()})

    held = between(-0.01, 0.0, 0.01, free=(1,)).simplified(0.5)
    assert len(held.inner) == 33 and not held.repairs
    loose = between(-0.01, 0.0, 0.01, free=(0, 1, 2))
    assert len(loose.simplified(0.5).inner) == 3  # they wait for each other
    judge(loose, loose.simplified(0.12), 0.12)
    seeds = {"above": [(k, -0.099) for k in (1, 3, 5, 7, 9)]}  # the valleys stay, the peaks go
    points, inner = np.concatenate([box, zigzag]), chain + 4
    seeded = Domain(points, ring, inner=inner, regions=seeds).simplified(0.5)
    assert len(seeded.inner) == 2
    judge(Domain(points, ring, inner=inner, regions=seeds), seeded, 0.5)


def test_with_a_size_only_short_pieces_go() -> None:
    ring = coastline(4000, 3)
    old = Domain.polygon(ring)
    new = old.simplified(size=0.05)
    length = np.hypot(*np.diff(new.points[new.pieces], axis=1)[:, 0].T)
    assert np.median(length) > 0.75 * 0.05 and length.max() < 0.5
    judge_distance = distance(old.points, straight(new)).max()
    assert judge_distance <= 0.5 * 0.05 and len(old.simplified(1e-3, size=0.05).points) > len(new.points)
    graded = old.simplified(size=lambda x: 0.01 + 0.1 * (x[:, 0] > 0))
    east = graded.points[:, 0] > 0.1
    assert (~east).sum() > 3 * east.sum()
    with pytest.raises(InputError, match="give a tolerance"):
        old.simplified()
    with pytest.raises(InputError, match="tolerance"):
        old.simplified(-1.0)


def test_a_sampled_boundary_can_be_meshed() -> None:
    disc = Domain.disc(markers={"right": [0, 3]}, regions={"all": [0, 0]})
    pieces = disc.sampled(0.2)
    for mesh in (
        constrained_delaunay(pieces),
        refine(pieces, 0.2),
        conforming_delaunay(pieces),
        circumcenter_insertion(pieces, 0.3),
        voronoi_segment(pieces, 0.3),
    ):
        report = check(mesh, domain=pieces)
        assert report, str(report)
        assert len(mesh.markers["right"]) >= len(pieces.ends) // 2 - 2


def test_a_fractal_coast_with_islands() -> None:
    rings = fractal_coast(6000, 40)
    assert len(rings) == 41 and sum(map(len, rings)) == 6000
    old = Domain.polygon(rings[0], rings[1:], resolve=True)
    assert not old.repairs and len(old.facets) == 6000  # simple by construction
    new = old.simplified(size=0.05)
    assert 100 < len(new.points) < 1000 and len(new.points) + len(lost_vertices(new)) == 6000
    mesh = refine(new, 0.05)
    assert check(mesh, domain=new)
    with pytest.raises(ValueError, match="multiples of 3"):
        fractal_coast(6001, 40)


def lost_vertices(new: Domain) -> set[int]:
    return {v for r in new.repairs for v in r.vertices}
