"""front_delaunay: equal to constrained Delaunay and to the plain version; points of its own."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import KINDS, random_region

from unstruct import Arc, Domain, IncompleteWarning, InputError, Mesh, check, constrained_delaunay
from unstruct.generate.front import delaunay_front
from unstruct.generate.front.delaunay_front import front_delaunay
from unstruct.plain import front_delaunay as plain

SQUARE, RING = [[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]]


def with_loose(domain: Domain, points: np.ndarray) -> Domain:
    rows = np.concatenate([domain.points, points])
    return Domain(rows, domain.facets, inner=domain.inner, curves=domain.curves, regions=domain.regions)


def acceptable(domain: Domain, points: np.ndarray) -> np.ndarray:
    """The points without those that are refused."""
    while True:
        try:
            front_delaunay(domain, points)
            return points
        except InputError as error:
            assert str(error).startswith("points[")
            points = np.delete(points, int(str(error)[7:].split("]")[0]), axis=0)


def some_points(domain: Domain, seed: int, kind: str, most: int) -> np.ndarray:
    """On a grid of nine by nine over the box (ties abound), at random, or clustered over many exponents."""
    rng = np.random.default_rng(seed)
    k = int(rng.integers(0, most))
    low, high = domain.bounds
    if kind == "grid":
        unit = np.unique(rng.integers(0, 9, (k, 2)), axis=0) / 8
    elif kind == "random":
        unit = rng.random((k, 2))
    else:
        unit = 10.0 ** -rng.uniform(0, 14, (k, 2))
    return acceptable(domain, low + (high - low) * unit)


def by_place(mesh: Mesh) -> set[frozenset[tuple[float, ...]]]:
    rows = [tuple(x) for x in mesh.points.tolist()]
    return {frozenset(rows[v] for v in cell) for cell in mesh.simplices.tolist()}


@settings(max_examples=30, deadline=None)
@given(
    st.sampled_from(sorted(KINDS)), st.integers(0, 10**6), st.sampled_from(["grid", "random", "clustered"])
)
def test_the_constrained_delaunay_triangulation(kind: str, seed: int, spread: str) -> None:
    domain = random_region(seed, kind)
    points = some_points(domain, seed, spread, 50)
    mesh = front_delaunay(domain, points)
    assert check(mesh, domain=domain, delaunay="constrained")
    oracle = constrained_delaunay(with_loose(domain, points))
    assert mesh.size == oracle.size and len(mesh.points) == len(oracle.points)
    if mesh.counts["cocircular"] == 0:
        assert by_place(mesh) == by_place(oracle)
        regions = (Counter(m.markers["region"].tolist()) for m in (mesh, oracle))
        assert sorted(next(regions).values()) == sorted(next(regions).values())
    assert mesh.counts["cells"] == mesh.size


@settings(max_examples=20, deadline=None)
@given(st.sampled_from(sorted(KINDS)), st.integers(0, 10**6), st.sampled_from(["grid", "random"]))
def test_the_plain_version_cell_by_cell(kind: str, seed: int, spread: str) -> None:
    """Same edges, apexes and ties, in the same order."""
    domain = random_region(seed, kind)
    if len(domain.sampled().points) > 25:
        return
    points = some_points(domain, seed, spread, 8)
    mesh = front_delaunay(domain, points, history=True)
    sampled = with_loose(domain, points).sampled()
    facets = sampled.piece < len(domain.facets)
    place = {tuple(x): i for i, x in enumerate(mesh.points.tolist())}
    number = [place.get(tuple(x), -1) for x in sampled.points.tolist()]
    sides = {frozenset(pair) for t in mesh.simplices.tolist() for pair in (t[:2], t[1:], t[::2])}
    inner = [(a, b) for a, b in sampled.ends[~facets].tolist() if frozenset((number[a], number[b])) in sides]
    outer = [tuple(ends) for ends in sampled.ends[facets].tolist()]
    cells = list(plain.front_delaunay(sampled.points.tolist(), outer, inner=inner))
    named = [tuple(number[v] for v in (*cell.edge, cell.apex)) for cell in cells]
    assert named == [tuple(cell) for cell in mesh.simplices.tolist()]
    assert mesh.steps is not None
    assert [bool(cell.cocircular) for cell in cells] == mesh.steps["cocircular"].tolist()


@settings(max_examples=20, deadline=None)
@given(
    st.sampled_from(sorted(KINDS)), st.integers(0, 10**6), st.sampled_from([0.06, 0.1, 0.3]), st.booleans()
)
def test_with_a_size(kind: str, seed: int, fraction: float, graded: bool) -> None:
    domain = random_region(seed, kind)
    scale = np.ptp(domain.bounds, axis=0).max()
    size, low = float(fraction * scale), domain.bounds[0]
    field = (lambda x: size * (0.4 + np.linalg.norm((x - low) / scale, axis=1))) if graded else size
    mesh = front_delaunay(domain, field)
    assert check(mesh, domain=domain, delaunay="constrained") and mesh.complete


def test_rounder_than_most() -> None:
    mesh = front_delaunay(Domain.disc(), 0.03)
    assert mesh.figures["mean 2r/R"] > 0.97 and mesh.figures["minimum angle"] > 25


@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
@settings(max_examples=10, deadline=None)
@given(st.sampled_from(sorted(KINDS)), st.integers(0, 10**6), st.booleans())
def test_finished(kind: str, seed: int, graded: bool) -> None:
    domain = random_region(seed, kind)
    scale = np.ptp(domain.bounds, axis=0).max()
    size, low = float(0.1 * scale), domain.bounds[0]
    field = (lambda x: size * (0.4 + np.linalg.norm((x - low) / scale, axis=1))) if graded else size
    raw, mesh = front_delaunay(domain, field), front_delaunay(domain, field, finish=True)
    assert check(mesh, domain=domain, delaunay="constrained")
    assert mesh.figures["mean 2r/R before"] == raw.figures["mean 2r/R"]
    assert mesh.figures["minimum angle after"] > min(raw.figures["minimum angle"], 25) - 1e-9
    assert mesh.counts["points"] == raw.counts["points"] and mesh.counts["moves"] >= 0
    assert len(mesh.reasons) == len(mesh.unrefined)


def test_finishing_by_regions() -> None:
    x = [[0, 0], [1, 0], [2, 0], [2, 1], [1, 1], [0, 1]]
    domain = Domain(
        x, [[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [5, 0]], inner=[[1, 4]],
        regions={"left": [[0.5, 0.5]], "right": [[1.5, 0.5]]},
    )  # fmt: skip
    size = {"left": 0.1, "right": 0.05}
    raw, mesh = front_delaunay(domain, size), front_delaunay(domain, size, finish=True)
    assert check(mesh, domain=domain, delaunay="constrained") and mesh.complete
    assert mesh.quality("min_angle").min() > raw.quality("min_angle").min()
    assert mesh.figures["mean 2r/R after"] > raw.figures["mean 2r/R"]
    many = [np.bincount(m.markers["region"]) for m in (raw, mesh)]
    np.testing.assert_allclose(many[1], many[0], rtol=0.1)


def test_points_outside_are_told() -> None:
    square = Domain.rectangle().with_holes(
        Domain([[0.4, 0.4], [0.6, 0.4], [0.5, 0.6]], [[0, 1], [1, 2], [2, 0]])
    )
    with pytest.warns(
        IncompleteWarning, match=r"2 of 3 points are outside .*: points\[0\], points\[2\]; see"
    ):
        mesh = front_delaunay(square, [[0.5, 0.5], [0.2, 0.2], [2, 0]])
    assert mesh.left_out.tolist() == [0, 2] and mesh.counts["outside"] == 2 and check(mesh, domain=square)


def test_finish_is_for_sizes() -> None:
    with pytest.raises(InputError, match="not with points, which stay"):
        front_delaunay(Domain.rectangle(), [[0.5, 0.5]], finish=True)
    with pytest.raises(InputError, match="not with history"):
        front_delaunay(Domain.rectangle(), 0.3, finish=True, history=True)
    with pytest.raises(InputError, match="finish"):
        front_delaunay(Domain.rectangle(), 0.3, finish="yes")


def test_no_triangulation_is_called(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("a triangulation was asked for")

    monkeypatch.setattr(delaunay_front, "planar_complex", refuse)
    domain = Domain(SQUARE, RING, regions={"all": [[0.3, 0.4]]})
    assert front_delaunay(domain, [[0.5, 0.5], [0.25, 0.5]]).size == 6
    assert front_delaunay(domain, 0.3).regions == {"all": 0}


def test_a_tip_two_last_bits_from_a_side() -> None:
    """A vertex 7e-15 from an end of an edge is in every circle through that end, up to rounding."""
    x = 0.5980294917195527
    points = [
        [0.4431416936528113, 4e-15],
        [x, 0.5],
        [0.7232571087563018, 0.5500910468146997],
        [x, 0.5000000000000071],
    ]
    domain = Domain([*SQUARE, *points], [*RING, [4, 5], [5, 6], [6, 4]])
    inside = [[0.5448873816976586, 0.340461559157459], [0.33554799997680385, 0.45967292990003916]]
    mesh = front_delaunay(domain, inside)
    assert check(mesh, domain=domain, delaunay="constrained")


@pytest.mark.parametrize("n", [3, 8, 17])
def test_lattices(n: int) -> None:
    """All circles of the cells have a fourth vertex on them: no two cells overlap."""
    rows = np.stack(np.meshgrid(np.arange(1, n) / n, np.arange(1, n) / n), axis=-1).reshape(-1, 2)
    mesh = front_delaunay(Domain.rectangle(), rows)
    assert check(mesh, domain=Domain.rectangle(), delaunay="constrained")
    assert mesh.counts["cocircular"] > 0


def test_a_regular_polygon() -> None:
    turn = 2 * np.pi * np.arange(60) / 60
    domain = Domain.polygon(np.column_stack([np.cos(turn), np.sin(turn)]))
    mesh = front_delaunay(domain, np.empty((0, 2)))
    assert mesh.size == 58 and check(mesh, domain=domain, delaunay="constrained")


def test_walls_hide_crowds() -> None:
    """Points close behind a wall are in the circles before it, and must not count."""
    rng = np.random.default_rng(0)
    crowd = np.column_stack([rng.uniform(0.01, 0.99, 300), rng.uniform(0.51, 0.52, 300)])
    domain = Domain(
        [*SQUARE, [0, 0.5], [1, 0.5]], [[0, 1], [1, 5], [5, 2], [2, 3], [3, 4], [4, 0]], inner=[[4, 5]]
    )
    mesh = front_delaunay(domain, crowd)
    assert check(mesh, domain=domain, delaunay="constrained") and mesh.counts["hidden"] > 0


def test_points_outside_are_counted() -> None:
    mesh = front_delaunay(Domain.rectangle(), [[0.5, 0.5], [2.0, 0.5], [0.2, 0.7]])
    assert mesh.counts["outside"] == 1 and len(mesh.points) == 6
    assert mesh.points[4:].tolist() == [[0.5, 0.5], [0.2, 0.7]] and mesh.origin.tolist() == [
        0,
        1,
        2,
        3,
        -1,
        -1,
    ]


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([[0.5, 0.5], [0.5, 0.5]], r"points\[1\].*equal to points\[0\]"),
        ([[0.5, 0.5], [1.0, 1.0]], r"points\[1\].*equal to vertex 2"),
        ([[0.5, 0.5], [0.5, 1.0]], r"points\[1\].*on piece 2"),
        ([[0.5, np.nan]], "finite"),
        ([[0.5, 0.5, 0.5]], r"\(k, 2\)"),
    ],
)
def test_refused_points(points: list[list[float]], message: str) -> None:
    with pytest.raises(InputError, match=message):
        front_delaunay(Domain(SQUARE, RING), points)


def test_points_on_a_curve_are_refused() -> None:
    domain = Domain.disc()
    cut = domain.sampled().points[len(domain.points)]
    with pytest.raises(InputError, match=r"points\[1\].*on a curve"):
        front_delaunay(domain, [[0.1, 0.2], cut])


def test_points_on_a_chord_do_not_bound() -> None:
    """(0.5, 0) is outside, and on the chord of the upper side of this crescent, which is cut for it."""
    sides = {i: Arc.through((0, 0), (0.5, low), (1, 0)) for i, low in enumerate((-0.02, -0.4))}
    domain = Domain([[0, 0], [1, 0]], [[0, 1], [0, 1]], curves=sides)
    mesh = front_delaunay(domain, [[0.5, 0.0]])
    assert mesh.counts["outside"] == 1 and check(mesh, domain=domain, delaunay="constrained")


def test_an_edge_whose_ideal_point_is_lost_to_rounding() -> None:
    domain = Domain.polygon([[0, 0], [1, 0], [1, 2.0**-60], [0, 1]])
    assert check(front_delaunay(domain, 0.3), domain=domain, delaunay="constrained")


def test_other_arguments() -> None:
    with pytest.raises(InputError, match="facets"):
        front_delaunay(Domain(SQUARE, np.empty((0, 2), dtype=int)), 0.5)
    with pytest.raises(InputError, match="positive"):
        front_delaunay(Domain.rectangle(), -1.0)


@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
def test_a_budget() -> None:
    mesh = front_delaunay(Domain.rectangle(), 0.1, budget=5)
    assert check(mesh, domain=Domain.rectangle(), delaunay="constrained")
    assert mesh.counts["points"] == 5 and set(mesh.reasons) == {"budget"}


def test_a_point_on_a_curve_up_to_rounding_is_named() -> None:
    """The middle of this arc is (6e-17, 1): beside (0, 1) there is no room for a chord. Found by fuzzing."""
    half = Domain([[-1, 0], [1, 0]], [[0, 1], [1, 0]], curves={1: Arc((0, 0), 1.0, 0.0, np.pi)})
    with pytest.raises(InputError, match=r"^points\[1\] = \[0.0, 1.0\] .* divides the curve"):
        front_delaunay(half, [[0.3, 0.3], [0.0, 1.0], [0.1, 0.2]])
    assert check(front_delaunay(half, [[0.3, 0.3], [0.1, 0.2]]), domain=half, delaunay="constrained")
