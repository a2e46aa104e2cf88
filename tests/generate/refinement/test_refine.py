"""Delaunay refinement: limits kept where they are promised, and the truth where they are not."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from math import cos, pi, radians, sin, sqrt
from typing import Any

import fuzz_regions
import fuzz_work
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from interrupts import interrupt
from regions import KINDS, random_region

import unstruct.base.jit
from unstruct import Arc, Curve, Domain, InputError, Mesh, MeshError, check, refine
from unstruct.plain import ruppert as plain
from unstruct.plain.predicates import in_sphere

METHODS = ("ruppert", "chew", "off-centers")
SQUARE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]


def ring(n: int, radius: float, center: tuple[float, float] = (0.0, 0.0), turn: float = 0.0) -> np.ndarray:
    angle = turn + np.arange(n) * (2 * pi / n)
    return np.array(center) + radius * np.column_stack([np.cos(angle), np.sin(angle)])


def wedge(degrees: float, length: float = 1.0) -> Domain:
    """A triangle with one small angle, at the origin."""
    tip = radians(degrees)
    return Domain.polygon([[0, 0], [1, 0], [length * cos(tip), length * sin(tip)]])


def square_with_hole() -> Domain:
    arcs = {4 + i: Arc((0.5, 0.5), 0.2, i * pi / 2, pi / 2) for i in range(4)}
    circle = ring(4, 0.2, (0.5, 0.5))
    facets = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4]]
    return Domain(np.concatenate([SQUARE, circle]), facets, curves=arcs)


def two_regions() -> Domain:
    points = [[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [1, 1]]
    facets = [[0, 4], [4, 1], [1, 2], [2, 5], [5, 3], [3, 0]]
    seeds = {"left": [[0.5, 0.5]], "right": [[1.5, 0.5]]}
    return Domain(points, facets, inner=[[4, 5]], markers={"bottom": [0, 1]}, regions=seeds)


def lengths(mesh: Mesh) -> np.ndarray:
    return np.linalg.norm(np.diff(mesh.points[mesh.edges], axis=1)[:, 0], axis=1)


def well(mesh: Mesh, domain: Domain) -> None:
    report = check(mesh, domain=domain, delaunay="constrained")
    assert report, str(report)


# --- limits --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("domain", "angle"),
    [
        (Domain.rectangle(), 20.7),
        (Domain.rectangle((0, 0), (1, 0.01)), 20.7),
        (Domain.polygon(ring(6, 1.0)), 20.7),
        (Domain.polygon(ring(3, 1.0), [ring(3, 0.3, turn=0.2)]), 20.7),
        (
            Domain.polygon(
                [[0, 0], [4, 0], [4, 3], [0, 3]], [ring(5, 0.5, (1, 1.0003)), ring(7, 0.4, (2, 1))]
            ),
            20.7,
        ),
        (Domain.polygon([[0, 0], [3, 0], [3, 1], [1.5, 0.999], [1.5, 2], [0, 2]]), 26.0),
        (square_with_hole(), 30.0),
        (two_regions(), 30.0),
    ],
)
def test_the_angle_is_reached(domain: Domain, angle: float, method: Any) -> None:
    """Angles of at least 60 degrees: 20.7 is proved (on straight sides), the rest is known to work."""
    mesh = refine(domain, min_angle=angle, method=method)
    well(mesh, domain)
    assert mesh.complete and len(mesh.reasons) == 0
    assert mesh.quality("min_angle").min() >= angle - 1e-9
    assert mesh.volume == pytest.approx(domain.area, rel=1e-12 if not domain.curves else 0.1)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("degrees", [0.01, 1.0, 10.0])
@pytest.mark.parametrize("length", [1.0, 0.7])
def test_small_input_angles_end_and_are_named(degrees: float, length: float, method: Any) -> None:
    domain = wedge(degrees, length)
    mesh = refine(domain, min_angle=25, method=method, budget=200_000)
    well(mesh, domain)
    assert not mesh.complete
    kinds = {str(reason) for reason in mesh.reasons}
    assert f"input angle {degrees:.3g}°" in kinds
    assert all(reason.startswith("input angle") for reason in kinds)
    small = mesh.quality("min_angle") < 25 - 1e-9
    assert set(np.flatnonzero(small)) == set(mesh.unrefined.tolist())
    assert mesh.quality("min_angle").min() >= degrees * (1 - 1e-6)
    if method == "ruppert":  # Miller, Pav, Walkington: no angle above 180 - 2 * 26.45 + ..., about 137.1
        assert mesh.quality("max_angle").max() < 140


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("degrees", [5.0, 15.0, 20.0, 24.0, 29.8, 35.0])
def test_no_triangle_is_sharper_than_the_apex(degrees: float, method: Any) -> None:
    """The second row, beyond the shell nearest to the apex, had 23.7 degrees at an apex of 29.8."""
    for length in (1.0, 0.83, 0.5):
        domain = wedge(degrees, length)
        for size in (None, 0.1, 0.03):
            mesh = refine(domain, size, method=method)
            well(mesh, domain)
            u, v = domain.points[[0, 1]] - domain.points[2]
            other = np.degrees(np.arccos(u @ v / np.hypot(*u) / np.hypot(*v)))
            assert mesh.quality("min_angle").min() > min(degrees, other, 180 - degrees - other, 25) * 0.998


def test_a_fan_of_small_angles() -> None:
    """Found by fuzzing: with the floor of the ends alone, splits before near features were refused."""
    for i in (104, 752, 851):
        rng = np.random.default_rng([0, i])
        domain = KINDS["angles"](rng)
        mesh = refine(domain, min_angle=20, budget=200_000)
        well(mesh, domain)
        assert {str(reason)[:11] for reason in mesh.reasons} == {"input angle"}


@pytest.mark.parametrize("exponent", [10, 30, 45])
def test_features_that_almost_touch(exponent: int) -> None:
    """Found by fuzzing: the distance to a side is a feature, though no edge of the input is so short."""
    gap = 2.0**-exponent
    domain = Domain.polygon(SQUARE, [[[0.5, gap], [0.7, 0.5], [0.3, 0.5]]])
    mesh = refine(domain, min_angle=20)
    well(mesh, domain)
    assert mesh.complete
    assert mesh.size < 60 * exponent


@pytest.mark.parametrize("method", METHODS)
def test_areas(method: Any) -> None:
    domain = two_regions()
    mesh = refine(domain, min_angle=28, max_area={"left": 0.01, "right": 0.05}, method=method)
    well(mesh, domain)
    assert mesh.complete
    left = mesh.markers["region"] == list(domain.regions).index("left")
    assert mesh.volumes[left].max() <= 0.01 and mesh.volumes[left].sum() == pytest.approx(1.0)
    assert 0.01 < mesh.volumes[~left].max() <= 0.05
    everywhere = refine(domain, max_area=0.01)
    assert everywhere.volumes.max() <= 0.01


@pytest.mark.parametrize("method", METHODS)
def test_a_constant_size(method: Any) -> None:
    """Circumradii are at most h / sqrt 2, and nothing was split: all edges are within sqrt 2 of h."""
    domain, h = Domain.rectangle(), 1 / 24
    mesh = refine(domain, size=h, min_angle=0, method=method)
    well(mesh, domain)
    assert mesh.complete and mesh.counts["splits"] == 0
    edge = lengths(mesh)
    assert h / sqrt(2) * (1 - 1e-12) <= edge.min() and edge.max() <= sqrt(2) * h * (1 + 1e-12)
    assert 0.9 < edge.mean() / h < 1.1


@pytest.mark.parametrize("domain", [square_with_hole(), two_regions()])
def test_a_size_function(domain: Domain) -> None:
    def size(x: np.ndarray) -> np.ndarray:
        return 0.01 + 0.1 * np.hypot(x[:, 0] - 0.5, x[:, 1])

    mesh = refine(domain, size=size, min_angle=25)
    well(mesh, domain)
    assert mesh.complete
    ratio = lengths(mesh) / size(mesh.points[mesh.edges].mean(axis=1))
    assert ratio.max() < 1.6 and np.mean((ratio > 1 / sqrt(2)) & (ratio < sqrt(2))) > 0.9


def test_sizes_by_region() -> None:
    domain = two_regions()
    mesh = refine(domain, size={"left": 0.05, "right": lambda x: 0.1 + 0 * x[:, 0]})
    well(mesh, domain)
    left = mesh.markers["region"] == 0
    radius = np.prod(edges_of(mesh), axis=1) / (4 * mesh.volumes)
    assert radius[left].max() <= 0.05 / sqrt(2) * 1.0001 < radius[~left].max() <= 0.1 / sqrt(2) * 1.03
    one = refine(domain, size={"left": 0.05})
    assert (one.markers["region"] == 1).sum() < (mesh.markers["region"] == 1).sum()


def edges_of(mesh: Mesh) -> np.ndarray:
    corners = mesh.corners
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)


def test_counts_beside_triangle() -> None:
    """No more than 5 percent above the triangles that Triangle makes with the same flags."""
    triangle = pytest.importorskip("triangle")
    rng = np.random.default_rng(5)
    angle = np.sort(rng.random(200)) * 2 * pi
    wavy = (1 + 0.3 * np.sin(5 * angle) + 0.02 * rng.standard_normal(200))[:, None] * np.column_stack(
        [np.cos(angle), np.sin(angle)]
    )
    ours = theirs = 0
    for outer, hole in ((np.array(SQUARE), ring(64, 0.2, (0.5, 0.5))), (wavy, ring(9, 0.1))):
        n, k = len(outer), len(hole)
        segments = [[i, (i + 1) % n] for i in range(n)] + [[n + i, n + (i + 1) % k] for i in range(k)]
        given = {
            "vertices": np.concatenate([outer, hole]),
            "segments": segments,
            "holes": [hole.mean(axis=0)],
        }
        for flags, options in (("pq20", {"min_angle": 20}), ("pq30", {"min_angle": 30}),
                               ("pq30a0.0005", {"min_angle": 30, "max_area": 0.0005})):  # fmt: skip
            theirs += len(triangle.triangulate(given, flags)["triangles"])
            ours += refine(Domain.polygon(outer, [hole]), **options).size
    assert ours <= 1.05 * theirs


# --- random regions ------------------------------------------------------------------------------------


@settings(max_examples=60)
@given(
    st.integers(0, 2**32 - 1), st.sampled_from(sorted(KINDS)), st.sampled_from(METHODS),
    st.sampled_from([0.0, 20.0, 28.0, 33.0]), st.sampled_from(["nothing", "area", "size"]),
)  # fmt: skip
def test_random_regions(seed: int, kind: str, method: Any, angle: float, limit: str) -> None:
    domain = random_region(seed, kind)
    scale = float(np.ptp(domain.bounds, axis=0).prod())
    options = {"nothing": {}, "area": {"max_area": scale / 100}, "size": {"size": sqrt(scale) / 8}}[limit]
    mesh = refine(domain, min_angle=angle, method=method, budget=6000, **options)
    well(mesh, domain)
    assert fuzz_work.promises(mesh, angle, options.get("max_area")) == ""
    again = refine(domain, min_angle=angle, method=method, budget=6000, **options)
    np.testing.assert_array_equal(mesh.points, again.points)
    np.testing.assert_array_equal(mesh.simplices, again.simplices)
    np.testing.assert_array_equal(mesh.reasons, again.reasons)


def test_a_sample_of_the_fuzz(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fuzz_regions, "SECONDS", 0)  # no limit: nothing here may depend on the load
    assert fuzz_regions.main(["27", "--seed", "7"]) == 0


def test_no_subsegment_is_encroached_in_the_end() -> None:
    """Ruppert's method: no corner of a triangle of the region lies in the disc of a subsegment."""
    for kind in ("holes", "star", "cracks", "triangles"):
        mesh = refine(random_region(3, kind), min_angle=20, method="ruppert")
        if {reason[:5] for reason in mesh.reasons.tolist()} - {"input"}:
            continue
        points = plain.exact_points(mesh.points)
        across = {}
        for t in mesh.simplices.tolist():
            for k in range(3):
                across.setdefault(frozenset((t[k - 1], t[k - 2])), []).append(t[k])
        for part in mesh.segments.tolist():
            for apex in across[frozenset(part)]:
                assert not plain.encroaches(points, frozenset(part), points[apex]), (kind, part, apex)


# --- against the plain version ------------------------------------------------------------------------


@pytest.mark.parametrize(
    "points", [SQUARE, [[0, 0], [2, 0], [2, 1], [1.2, 1], [1.1, 0.6], [1, 1], [0, 1]], ring(5, 1.0).tolist()]
)
@pytest.mark.parametrize("area", [None, 0.05])
def test_plain_and_fast_keep_the_same_promises(points: list, area: float | None) -> None:
    n = len(points)
    segments = [(i, (i + 1) % n) for i in range(n)]
    known, cells, parts = plain.refine(points, segments, min_angle=20, max_area=area)
    slow = Mesh(np.array(known, dtype=float), sorted(cells))
    domain = Domain.polygon(points)
    fast = refine(domain, min_angle=20, max_area=area, method="ruppert")
    for t in cells:  # without encroached subsegments it is Delaunay altogether
        assert all(in_sphere([known[v] for v in t], q) <= 0 for q in known)
    for mesh in (slow, fast):
        assert mesh.quality("min_angle").min() >= 20 - 1e-9
        assert mesh.volume == pytest.approx(domain.area)
    assert 0.6 < fast.size / slow.size < 1.7
    bound = plain.Fraction(sin(radians(20))) ** 2
    exact = plain.exact_points(fast.points)
    assert not any(plain.angle_is_small(exact, tuple(t), bound) for t in fast.simplices.tolist())
    assert not any(
        plain.encroaches(known, part, known[v]) for part in parts for v in range(len(known)) if v not in part
    )


def test_each_plain_step_is_delaunay() -> None:
    points = plain.exact_points(ring(9, 1.0).tolist())
    kinds = set()
    for step in plain.ruppert(points, [(i, (i + 1) % 9) for i in range(9)], min_angle=25, max_area=0.1):
        kinds.add(step.kind)
        cells = [c for c in step.cells if plain.GHOST not in c]
        for t in cells:
            assert all(in_sphere([points[v] for v in t], q) <= 0 for q in points[: step.vertex + 1])
    assert kinds == {"input", "segment", "circumcenter"}


def test_plain_says_that_there_is_no_end() -> None:
    with pytest.raises(InputError, match="no end"):
        plain.refine([[0, 0], [1, 0], [0.7, 0.01]], [(0, 1), (1, 2), (2, 0)], min_angle=20, budget=60)


# --- curves ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_new_vertices_lie_on_the_true_arc(method: Any) -> None:
    domain = Domain.disc((3.0, -2.0), 1.5)
    mesh = refine(domain, max_area=1e-3, method=method)
    well(mesh, domain)
    rim = np.unique(mesh.boundary)
    assert len(rim) > 50
    np.testing.assert_allclose(np.hypot(*(mesh.points[rim] - (3.0, -2.0)).T), 1.5, rtol=1e-15)
    assert 0 < domain.area - mesh.volume < 0.01
    for (a, b), piece, (s, t) in zip(mesh.segments, mesh.piece, mesh.span):
        np.testing.assert_allclose(domain.at(piece, [s, t]), mesh.points[[a, b]], atol=1e-15)


@pytest.mark.parametrize("method", METHODS)
def test_other_curves_are_followed(method: Any) -> None:
    wave = Curve(lambda t: np.column_stack([t, 0.2 * np.sin(2 * np.pi * t)]))
    domain = Domain(SQUARE, [[0, 1], [1, 2], [2, 3], [3, 0]], curves={0: wave})
    mesh = refine(domain, max_area=1e-4, method=method)
    well(mesh, domain)
    assert mesh.complete
    rows = mesh.segments[mesh.piece == 0]
    x, y = mesh.points[np.unique(rows)].T
    np.testing.assert_allclose(y, 0.2 * np.sin(2 * np.pi * x), atol=1e-15)
    assert mesh.volume == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("method", METHODS)
def test_crescents(method: Any) -> None:
    """Two arcs that meet at their ends under a small angle: shells are cut out of the true curves."""
    for kind in (Arc.through, lambda *p: Curve(Arc.through(*p).point)):
        arcs = {i: kind((0, 0), (0.5, y), (1, 0)) for i, y in enumerate((0.25, 0.27))}
        domain = Domain([[0, 0], [1, 0]], [[0, 1], [0, 1]], curves=arcs)
        mesh = refine(domain, min_angle=25, method=method, budget=20_000)
        well(mesh, domain)
        assert not mesh.complete
        assert set(mesh.reasons) == {"input angle 3.61°"}  # 2 atan 0.54 - 2 atan 0.5, of the true tangents
        assert mesh.counts["shell splits"] >= 4


def test_nearly_touching_circles() -> None:
    for gap in (1e-2, 1e-4):
        arcs = {i: Arc((0, 0), 1, i * pi / 2, pi / 2) for i in range(4)}
        arcs |= {4 + i: Arc((0.5 - gap, 0), 0.5, i * pi / 2, pi / 2) for i in range(4)}
        points = np.concatenate([ring(4, 1.0), ring(4, 0.5, (0.5 - gap, 0.0))])
        facets = [[i, (i + 1) % 4] for i in range(4)] + [[4 + i, 4 + (i + 1) % 4] for i in range(4)]
        domain = Domain(points, facets, curves=arcs)
        mesh = refine(domain, min_angle=25)
        well(mesh, domain)
        assert mesh.complete


# --- account ------------------------------------------------------------------------------------------


def test_everything_is_accounted_for() -> None:
    domain = two_regions()
    mesh = refine(domain, min_angle=25, max_area=0.02)
    n = len(domain.points)
    np.testing.assert_array_equal(mesh.origin[:n], np.arange(n))
    assert (mesh.origin[n:] == -1).all()
    np.testing.assert_array_equal(mesh.points[:n], domain.points)
    bottom = np.sort(mesh.points[mesh.markers["bottom"]][..., 0], axis=1)
    assert (mesh.points[mesh.markers["bottom"]][..., 1] == 0).all()
    assert bottom.min() == 0 and bottom.max() == 2 and np.diff(bottom).sum() == pytest.approx(2)
    assert (mesh.points[mesh.markers["inner"]][..., 0] == 1).all()
    assert (
        len(mesh.points) == n + mesh.counts["splits"] + mesh.counts["circumcenters"] - mesh.counts["removed"]
    )


def test_dangling_segments_and_loose_points_stay() -> None:
    points = [*SQUARE, [0.2, 0.2], [0.8, 0.25], [0.5, 0.5], [0.3, 0.8]]
    domain = Domain(points, [[0, 1], [1, 2], [2, 3], [3, 0]], inner=[[4, 5], [4, 6]])
    mesh = refine(domain, min_angle=25)
    well(mesh, domain)
    assert mesh.complete
    assert {4, 5, 6, 7} <= set(mesh.origin.tolist())


def test_history_tells_every_point() -> None:
    domain = wedge(8.0, 0.6)
    for method in METHODS:
        mesh = refine(domain, min_angle=25, max_area=2e-3, method=method, history=True)
        steps = mesh.steps
        assert steps is not None
        put = np.isin(steps["kind"], ["split", "circumcenter"])
        gone = steps["kind"] == "removed"
        assert (steps["kind"] == "split").sum() == mesh.counts["splits"]
        assert (steps["kind"] == "rejected").sum() == mesh.counts["rejected"]
        np.testing.assert_array_equal(steps["vertex"][put], 3 + np.arange(put.sum()))
        left = np.setdiff1d(np.arange(put.sum()), steps["vertex"][gone] - 3)
        np.testing.assert_array_equal(steps["place"][put][left], mesh.points[3:])
        assert (steps["vertex"][steps["kind"] == "rejected"] == -1).all()
        assert refine(domain, min_angle=25, max_area=2e-3, method=method).steps is None


def test_a_prefix_of_the_points_is_the_state() -> None:
    domain = Domain.polygon(SQUARE, [ring(3, 0.2, (0.5, 0.5))])
    whole = refine(domain, min_angle=25, max_area=0.01, method="ruppert")
    for k in (12, 25, len(whole.points) - 1):
        part = refine(domain, min_angle=25, max_area=0.01, method="ruppert", budget=k)
        well(part, domain)
        np.testing.assert_array_equal(part.points, whole.points[:k])
        assert not part.complete


def test_the_budget_is_kept_and_told() -> None:
    domain = Domain.rectangle()
    for budget in (4, 5, 100, 1000):
        mesh = refine(domain, max_area=1e-5, budget=budget)
        assert len(mesh.points) == budget and not mesh.complete
        assert set(mesh.reasons) == {"budget"}
        well(mesh, domain)
        assert (mesh.volumes[np.setdiff1d(np.arange(mesh.size), mesh.unrefined)] <= 1e-5).all()


def test_precision_is_told() -> None:
    """Vertices a few last places apart leave no room: nothing is forced, all is said."""
    far, step = 2.0**30, 2.0**-22
    domain = Domain.rectangle((far, far), (far + 3 * step, far + 2 * step))
    mesh = refine(domain, max_area=1e-3 * step * step)
    well(mesh, domain)
    assert not mesh.complete
    assert {str(reason).split(":")[0] for reason in mesh.reasons} == {"precision"}
    tiny = refine(Domain.rectangle((0, 0), (1e-150, 1e-150)), max_area=1e-302)
    assert tiny.complete and tiny.size > 100


def test_neighbors_by_one_bit_are_told_and_do_not_spread() -> None:
    """Points a few units of rounding apart have any angle: the region used to fill with them."""
    near = 0.5 + 2.0**-53
    domain = Domain(np.array([*SQUARE, (0.5, 0.5), (near, near)]), [[0, 1], [1, 2], [2, 3], [3, 0]])
    mesh = refine(domain, budget=20_000)
    assert mesh.size < 1000 and not mesh.complete and {r[:8] for r in mesh.reasons} == {"too near"}
    assert check(mesh, domain=domain, delaunay="constrained")
    corner = Domain(np.array([*SQUARE, (1e-200, 1e-200)]), domain.facets)  # doubles are finer there
    mesh = refine(corner, budget=20_000)  # but a parameter near 1 on a side is not
    assert mesh.size < 1000 and not mesh.complete and {r[:8] for r in mesh.reasons} == {"too near"}
    well(mesh, corner)


WIDE = {
    "area below rounding": [(-1, 2), (0, 0), (2, -1), (0, 1e-28)],
    "equal parameters": [(2, 1), (4.3e-168, -1.0009639963136083), (-2.42e-07, 0), (0, 4.2e-56), (0, 0)],
    "squares below all doubles": [(1.94e-170, -2), (2.4e-09, 3.7e-90), (8e-176, -2)],
    "an edge that has no square": [
        (-6.2e-265, -4.909093465297727e-91), (2.37e-91, 2.2e-274), (0, -4.909041529035115e-91),
        (-9.8e-91, -4.90967e-91), (-5.2e-91, 9.8e-91), (4.909093465297727e-91, 0),
        (0, -4.909093465297727e-91),
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", WIDE)
@pytest.mark.parametrize("method", METHODS)
def test_wide_exponents(name: str, method: Any) -> None:
    """Found by fuzzing: halves with the same parameters; products of edges that are 0 in doubles."""
    domain = Domain.polygon(WIDE[name])
    for options in ({}, {"size": float(np.ptp(domain.bounds, axis=0).max()) / 5}):
        mesh = refine(domain, method=method, budget=20_000, **options)
        well(mesh, domain)
        assert fuzz_work.promises(mesh, 25, None) == ""
        assert (np.diff(mesh.span, axis=1) > 0).all()


# --- what is out of reach -------------------------------------------------------------------------------

ELL = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]


def test_a_needle_is_not_meshed_to_dust() -> None:
    """1.2 million points, most of them in triangles that missed the angle anyway."""
    for height, apex in ((1e-6, 0.37), (1e-9, 0.5), (1e-4, 0.01)):
        domain = Domain.polygon([(0, 0), (1, 0), (apex, height)])
        for size in (None, 0.1):
            mesh = refine(domain, size)
            well(mesh, domain)
            assert mesh.size < 5000 and not mesh.complete
            assert {str(r)[:6] for r in mesh.reasons} <= {"input ", "narrow"}
            if size is not None:
                assert lengths(mesh).max() < 0.15


def test_a_narrow_gap_beside_ordinary_sides() -> None:
    """The gap stays as it is, with the reason; everything else is as good as ever."""
    hole = [(0.2, 1e-7), (0.8, 1e-7), (0.7, 0.3), (0.3, 0.3)]
    domain = Domain.polygon(SQUARE, [hole])
    mesh = refine(domain, 0.1)
    well(mesh, domain)
    assert mesh.size < 30_000 and not mesh.complete
    assert {str(r)[:6] for r in mesh.reasons} == {"narrow"}
    assert mesh.corners[mesh.unrefined].mean(axis=1)[:, 1].max() < 1e-3
    wider = refine(Domain.polygon(SQUARE, [[(x, max(y, 1e-3)) for x, y in hole]]), 0.1)
    assert wider.complete


@pytest.mark.parametrize("angle", [34.0, 36.0, 40.0, 45.0, 59.0])
def test_an_angle_beyond_the_theorems_ends_early(angle: float) -> None:
    domain = Domain.polygon(ELL)
    base = refine(domain, 0.1, min_angle=30).size
    mesh = refine(domain, 0.1, min_angle=angle)
    well(mesh, domain)
    assert mesh.size <= 3 * base
    assert all(str(r).startswith("too near: an angle above 33.5") for r in mesh.reasons)
    assert fuzz_work.promises(mesh, angle, None) == ""
    tiny = Domain.polygon(SQUARE, [ring(7, 0.003, (0.31, 0.42))])
    assert refine(tiny, 0.1, min_angle=angle).size <= 10 * refine(tiny, 0.1, min_angle=30).size


def test_few_digits_left_by_an_offset_do_not_spread() -> None:
    """1e11 away the last bit of the coordinates is 2^-16: narrow angles made millions of triangles of it."""
    rows = [
        (2648, 8047), (30426, 63206), (9096, 21339), (12564, 21079), (3621, 41675), (4495, 63904),
        (6849, 24535), (4087, 47876), (13739, 37016), (21840, 10490), (9333, 21321), (11011, 24654),
        (10907, 24894), (3750, 41378), (5270, 37877),
    ]  # fmt: skip
    ring = [(0, 10), (10, 11), (11, 1), (1, 12), (12, 2), (2, 10), (10, 3), (3, 11), (11, 12), (12, 14),
            (14, 13), (13, 4), (4, 5), (5, 13), (13, 0)]  # fmt: skip
    domain = Domain(1e11 + np.array(rows) * 2.0**-16, ring, inner=[(6, 14), (14, 7)])
    mesh = refine(domain, min_angle=28, budget=20_000)
    assert mesh.size < 2000 and check(mesh, domain=domain, delaunay="constrained")


def test_an_angle_out_of_reach_ends() -> None:
    domain = Domain.polygon(ring(7, 1.0), [ring(4, 0.3)])
    mesh = refine(domain, min_angle=45, budget=20_000)
    well(mesh, domain)
    assert not mesh.complete
    assert {str(reason).split(":")[0] for reason in mesh.reasons} <= {"budget", "too near"}


# --- meshes as input -------------------------------------------------------------------------------------


def test_a_mesh_is_refined() -> None:
    first = refine(two_regions(), min_angle=20)
    mesh = refine(first, min_angle=28, max_area=0.01)
    assert check(mesh, delaunay="constrained")
    assert mesh.complete and mesh.volumes.max() <= 0.01
    np.testing.assert_array_equal(mesh.points[: len(first.points)], first.points)
    assert (mesh.points[mesh.markers["inner"]][..., 0] == 1).all()
    assert (mesh.points[mesh.markers["bottom"]][..., 1] == 0).all()
    left = mesh.corners.mean(axis=1)[:, 0] < 1
    np.testing.assert_array_equal(mesh.markers["region"], np.where(left, 0, 1))
    assert set(mesh.origin[: len(first.points)]) >= set(range(6))
    by_region = refine(first, max_area={1: 0.01})
    right = by_region.markers["region"] == 1
    assert by_region.volumes[right].max() <= 0.01 < by_region.volumes[~right].max()


def test_a_mesh_that_is_not_delaunay_with_markers_of_all_kinds() -> None:
    points = [[0, 0], [4, 0], [4, 1], [0, 1], [9, 9], [2.1, 0.5]]
    cells = [[0, 1, 5], [1, 2, 5], [2, 3, 5], [3, 0, 5]]
    markers = {"material": np.array([7, 7, 5, 5]), "corner": [[2], [4]], "top": [[2, 3]], "spoke": [[5, 1]]}
    mesh = refine(Mesh(points, cells, markers=markers), min_angle=25, size=0.3)
    assert check(mesh, delaunay="constrained")
    assert {str(reason)[:16] for reason in mesh.reasons} <= {
        "input angle 13.4",
        "input angle 14.7",
        "input angle 29.5",
    }
    assert mesh.volume == pytest.approx(4)
    upper = mesh.corners.mean(axis=1)
    # material 7 lies below 0-5 and right of 5-2
    below = np.where(upper[:, 0] < 2.1, upper[:, 1] < upper[:, 0] * 0.5 / 2.1,
                     (upper[:, 1] - 0.5) * (4 - 2.1) < (upper[:, 0] - 2.1) * 0.5)  # fmt: skip
    np.testing.assert_array_equal(mesh.markers["material"], np.where(below, 7, 5))
    assert (mesh.points[mesh.markers["top"]][..., 1] == 1).all()
    np.testing.assert_array_equal(mesh.points[mesh.markers["corner"].ravel()], [[4, 1]])
    spoke = mesh.points[mesh.markers["spoke"]].reshape(-1, 2)
    np.testing.assert_allclose((spoke[:, 0] - 2.1) * (0 - 0.5), (spoke[:, 1] - 0.5) * (4 - 2.1), atol=1e-12)


def test_a_coarse_mesh_of_a_wedge_still_ends() -> None:
    """Straight chains of boundary edges are one piece, so that small angles are known as such."""
    first = refine(wedge(2.0), size=0.05, min_angle=0)
    mesh = refine(first, min_angle=25, budget=100_000)
    assert check(mesh, delaunay="constrained")
    assert not mesh.complete
    assert {str(reason)[:11] for reason in mesh.reasons} <= {"input angle", "too near: t"}


@pytest.mark.parametrize(
    ("points", "cells", "message"),
    [
        (SQUARE, [[0, 2, 1]], "not counterclockwise"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], "triangle mesh of the plane"),
        ([*SQUARE, [0.2, 0.1]], [[0, 1, 2], [4, 1, 3]], "cross|overlap"),
        ([[0, 0], [2, 0], [0, 2], [1, 0], [2, -1]], [[0, 1, 2], [3, 4, 1]], "overlap|lies on"),
    ],
)
def test_bad_meshes(points: list, cells: list, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        refine(Mesh(points, cells))


# --- bad input, interrupts, size ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"min_angle": 60}, "min_angle = 60"),
        ({"min_angle": -1}, "min_angle = -1"),
        ({"min_angle": float("nan")}, "min_angle = nan"),
        ({"max_area": 0}, "max_area = 0.0 must be positive"),
        ({"max_area": float("nan")}, "must be positive"),
        ({"max_area": "small"}, "max_area must be a number"),
        ({"max_area": {"middle": 1.0}}, "'middle', but the regions of the domain are"),
        ({"size": {"middle": 1.0}}, "'middle'"),
        ({"size": 0}, "size"),
        ({"size": lambda x: x[:, 0] - 0.5}, r"size.*\["),
        ({"method": "delaunay"}, "method = 'delaunay'"),
        ({"budget": 2}, "budget = 2"),
        ({"budget": 10.5}, "budget = 10.5"),
        ({"budget": "many"}, "budget = 'many'"),
        ({"min_angle": "large"}, "min_angle must be a number"),
    ],
)
def test_bad_limits(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        refine(two_regions(), **options)


def test_an_enormous_size_limits_nothing() -> None:
    """Its square is beyond all doubles."""
    assert refine(two_regions(), 1e300).complete


def test_neither_domain_nor_mesh() -> None:
    with pytest.raises(InputError, match="must be a Domain or a Mesh, not list"):
        refine(SQUARE)  # type: ignore[arg-type]


def test_a_curve_that_has_no_point() -> None:
    class Broken:
        def point(self, t: np.ndarray) -> np.ndarray:
            y = np.where((t > 0) & (np.round(t * 64) != t * 64), np.nan, 0.1 * np.sin(np.pi * t))
            return np.column_stack([t, y])

    domain = Domain(SQUARE, [[0, 1], [1, 2], [2, 3], [3, 0]], curves={0: Broken()})
    with pytest.raises(InputError, match="piece 0 has no finite point at parameter"):
        refine(domain, max_area=1e-5)


@pytest.mark.parametrize("method", METHODS)
def test_a_split_that_would_leave_the_region_is_refused(method: Any) -> None:
    """A curve with a spike that nobody could foresee: its subsegment stays, and the reason is told."""

    class Spike:
        def point(self, t: np.ndarray) -> np.ndarray:
            return np.column_stack([t, np.where(t == 5 / 64, 2.0, 0.0)])

    domain = Domain(SQUARE, [[0, 1], [1, 2], [2, 3], [3, 0]], curves={0: Spike()})
    mesh = refine(domain, max_area=3e-5, min_angle=20, method=method)
    assert check(mesh, delaunay="constrained")
    assert mesh.volume == pytest.approx(1.0)
    assert not mesh.complete and mesh.counts["locked"] == 1
    assert {str(reason).split(":")[0] for reason in mesh.reasons} == {"curve"}
    assert np.abs(mesh.corners[mesh.unrefined].mean(axis=1) - (5 / 64, 0)).max() < 0.03


def test_no_limits_at_all_is_the_constrained_triangulation() -> None:
    domain = two_regions()
    mesh = refine(domain, min_angle=0, method="chew")
    assert mesh.size == 4 and mesh.complete and len(mesh.points) == 6


@pytest.mark.skipif(unstruct.base.jit.numba is None, reason="plain Python stops between any two lines")
def test_an_interrupt_is_heard_at_once_and_harms_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    domain = Domain.rectangle()
    work = lambda: refine(domain, max_area=1e-5, progress=True)  # noqa: E731
    assert max(interrupt(monkeypatch, work, "vertices")) <= 20_000 < 1e5  # triangles in all
    well(refine(domain, max_area=0.01), domain)


def test_progress_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    refine(Domain.rectangle(), max_area=1e-3, progress=True)
    assert "vertices" in capsys.readouterr().err


def test_a_million_triangles() -> None:
    domain = Domain.polygon(SQUARE, [ring(64, 0.2, (0.5, 0.5))])
    mesh = refine(domain, min_angle=30, max_area=1.4e-6)
    assert mesh.size > 900_000 and mesh.complete
    assert fuzz_work.quick(mesh, domain) == ""
    assert fuzz_work.promises(mesh, 30, 1.4e-6) == ""
    assert mesh.quality("2r/R").mean() > 0.89


SMALL = """
import json, numpy as np, unstruct
points = [[0, 0], [2, 0], [2, 1], [1.2, 1], [1.1, 0.6], [1, 1], [0, 1]]
domain = unstruct.Domain.polygon(points)
meshes = [unstruct.refine(domain, min_angle=25, max_area=0.05, method=m) for m in ("ruppert", "chew")]
meshes.append(unstruct.refine(unstruct.Domain.disc(), size=lambda x: 0.3 + 0.2 * x[:, 0] ** 2))
meshes.append(unstruct.refine(meshes[0], max_area=0.02))
print(json.dumps([[m.points.tolist(), m.simplices.tolist(), m.counts] for m in meshes]))
"""


@pytest.mark.skipif(unstruct.base.jit.numba is None, reason="numba is not installed")
def test_without_numba_the_meshes_are_the_same() -> None:
    def run(**environment: str) -> Any:
        result = subprocess.run(
            [sys.executable, "-c", SMALL], env={**os.environ, **environment}, capture_output=True, text=True
        )
        assert result.returncode == 0, result.stderr
        return json.loads(result.stdout)

    assert run() == run(NUMBA_DISABLE_JIT="1")
