"""The advancing front: valid meshes of any region, each step by its record, orders, placements, options."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from interrupts import interrupt
from regions import KINDS, random_region

import unstruct
from unstruct import Domain, InputError, advancing_front, check
from unstruct.examples.running import running_region, running_size
from unstruct.generate.front.run import FRONT_REASONS, ORDERS, PLACEMENTS

ROOT3 = np.sqrt(3.0)
SQUARE = Domain.polygon([(0, 0), (1, 0), (1, 1), (0, 1)])
HARD = {"angles", "thin", "wide exponents"}


def lake(size: float = 0.1) -> Domain:
    return Domain(*running_region(size))


def graded(domain: Domain, size: float) -> Any:
    low = domain.bounds[0]
    return lambda x: size * (0.3 + 0.7 * np.exp(-np.linalg.norm(x - low, axis=1) / size / 10))


def in_circle(a: np.ndarray, b: np.ndarray, c: np.ndarray, x: np.ndarray) -> bool:
    """Whether x lies inside the circle of the triangle abc, counterclockwise, by fractions."""
    rows = []
    for p in (a, b, c):
        u, v = Fraction(p[0]) - Fraction(x[0]), Fraction(p[1]) - Fraction(x[1])
        rows.append((u, v, u * u + v * v))
    (a0, a1, a2), (b0, b1, b2), (c0, c1, c2) = rows
    return a0 * (b1 * c2 - b2 * c1) - a1 * (b0 * c2 - b2 * c0) + a2 * (b0 * c1 - b1 * c0) > 0


def circumradius(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    sides = [np.linalg.norm(p - q) for p, q in ((a, b), (b, c), (c, a))]
    double = abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    return float(np.prod(sides) / (2 * double))


def fronts(mesh: unstruct.DomainMesh) -> Iterator[tuple[int, set[tuple[int, int]]]]:
    """Each step's number and the front before it: directed edges with what is unfinished on their left."""
    inside = {tuple(edge) for cell in mesh.simplices.tolist() for edge in _edges(cell)}
    front = {(a, b) for pair in mesh.segments.tolist() for a, b in (pair, pair[::-1]) if (a, b) in inside}
    for i, cell in enumerate(mesh.simplices.tolist()):
        yield i, front
        for a, b in _edges(cell):
            if (a, b) in front:
                front.remove((a, b))
            else:
                assert (b, a) not in front, "an edge entered the front twice"
                front.add((b, a))
    assert not front


def _edges(cell: list[int]) -> list[tuple[int, int]]:
    return [(cell[0], cell[1]), (cell[1], cell[2]), (cell[2], cell[0])]


# --- any region ------------------------------------------------------------------------------------


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(sorted(set(KINDS) - HARD)), st.integers(0, 10**6), st.sampled_from([0.06, 0.1, 0.2, 0.5]),
    st.booleans(), st.sampled_from(ORDERS), st.sampled_from(PLACEMENTS),
)  # fmt: skip
def test_any_region(kind: str, seed: int, part: float, varies: bool, order: str, placement: str) -> None:
    domain = random_region(seed, kind)
    h = part * float(np.ptp(domain.bounds, axis=0).max())
    size = graded(domain, h) if varies else h
    raw = advancing_front(domain, size, order=order, placement=placement, finish=False)
    assert check(raw, domain=domain)
    mesh = advancing_front(domain, size, order=order, placement=placement)
    assert check(mesh, domain=domain, delaunay="constrained")
    rest = np.delete(mesh.quality("min_angle"), mesh.unrefined)
    assert rest.min(initial=90.0) >= 25.0 - 1e-9
    assert mesh.complete == (len(mesh.unrefined) == 0)


@pytest.mark.parametrize("kind", sorted(HARD))
def test_tiny_angles_and_thin_regions(kind: str) -> None:
    """They need very many triangles: a budget ends that, and the result says so."""
    for seed in range(4):
        domain = random_region(seed, kind)
        h = 0.1 * float(np.ptp(domain.bounds, axis=0).max())
        for finish in (False, True):
            mesh = advancing_front(domain, h, finish=finish, budget=3000)
            assert check(mesh, domain=domain, delaunay="constrained" if finish else False)
            assert mesh.complete or all(mesh.reasons)
            assert len(mesh.points) <= 3100 + len(domain.sampled(h).points)


def test_curves_regions_markers_and_loose_points() -> None:
    points = [[0, 0], [4, 0], [4, 3], [0, 3], [2, 0.5], [2, 2.5], [1, 1.5], [3.1, 1.7]]
    arc = unstruct.Arc.through((4, 0), (4.8, 1.5), (4, 3))
    domain = Domain(
        points, [[0, 1], [1, 2], [2, 3], [3, 0]], inner=[[4, 5]], curves={1: arc}, markers={"bay": [1]},
        regions={"water": [[0.3, 0.4]]},
    )  # fmt: skip
    for finish in (False, True):
        mesh = advancing_front(domain, 0.2, finish=finish)
        assert check(mesh, domain=domain)
        bay = mesh.points[np.unique(mesh.markers["bay"])]
        np.testing.assert_allclose(np.hypot(*(bay - arc.center).T), arc.radius, rtol=1e-14)
        assert {6, 7} <= set(mesh.origin.tolist()) and mesh.regions == {"water": 0}
        assert len(mesh.markers["inner"]) >= 10


# --- the record ------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("placement", PLACEMENTS)
def test_every_step_is_what_its_record_says(order: str, placement: str) -> None:
    """A replay with sets: the front is the symmetric difference of all sides, and each reason is true."""
    for domain, size in ((lake(), running_size), (random_region(7, "cracks"), 0.2), (SQUARE, 0.13)):
        mesh = advancing_front(domain, size, order=order, placement=placement, finish=False, history=True)
        steps, x = mesh.steps, mesh.points
        assert steps is not None and {len(column) for column in steps.values()} == {mesh.size}
        seen = set(np.unique(mesh.segments).tolist()) | set(np.flatnonzero(mesh.origin >= 0).tolist())
        for i, front in fronts(mesh):
            a, b = steps["edge"][i].tolist()
            c, reason = int(steps["apex"][i]), steps["reason"][i]
            assert (a, b) in front and sorted((a, b, c)) == sorted(mesh.simplices[i].tolist())
            ideal, f, radius = steps["ideal"][i], steps["size"][i] / ROOT3, steps["radius"][i]
            if reason == "new point":
                assert c not in seen
                np.testing.assert_allclose(x[c], ideal, rtol=0, atol=1e-15)
                assert radius >= 1.2 * f * (1 - 1e-12)
            elif reason == "closed":
                assert sum(edge in front for edge in ((a, b), (b, c), (c, a))) >= 2
            else:
                np.testing.assert_allclose(radius, circumradius(x[a], x[b], x[c]), rtol=1e-9)
                assert (radius < 1.2 * f) == (reason == "small enough")
                if reason == "near apex":
                    assert steps["near"][i] == c and np.linalg.norm(ideal - x[c]) < 0.8 * steps["size"][i]
                if reason == "empty circle":
                    assert not in_circle(x[a], x[b], x[c], ideal)
            seen.add(c)
        assert set(steps["reason"]) <= set(FRONT_REASONS)
        for name in ("new point", "closed", "near apex", "forced"):
            assert mesh.counts[name] == (steps["reason"] == name).sum()


def test_prefixes_of_cells_are_the_history() -> None:
    mesh = advancing_front(SQUARE, 0.2, finish=False)
    for k in (1, 10, mesh.size // 2, mesh.size):
        part = unstruct.Mesh(mesh.points, mesh.simplices[:k])
        assert (part.volumes > 0).all()
    assert mesh.steps is None


@pytest.mark.parametrize("order", ["smallest", "shortest"])
def test_the_order_is_kept_up_to_a_fifth(order: str) -> None:
    """Wherever nothing was set aside, the edge that is taken has about the least measure of all."""
    size = unstruct.sizing.points([(0.2, 0.2)], 0.02, growth=0.2)
    mesh = advancing_front(SQUARE, size, order=order, finish=False, history=True)
    x, steps = mesh.points, mesh.steps
    assert steps is not None and mesh.counts["set aside"] < 5
    late = 0
    for i, front in fronts(mesh):
        if steps["reason"][i] == "closed":
            continue
        ends = np.array(sorted(front))
        a, b = steps["edge"][i]
        if order == "shortest":
            lengths = np.linalg.norm(x[ends[:, 0]] - x[ends[:, 1]], axis=1)
            late += np.linalg.norm(x[a] - x[b]) > 1.2 * lengths.min()
        else:
            late += size(x[[a, b]]).min() > 1.6 * size(x[ends.ravel()]).min()
    assert late <= 0.02 * mesh.size


def test_widest_first_is_rounder_than_the_other_orders() -> None:
    for domain in (SQUARE, SQUARE.with_holes(Domain.disc((0.5, 0.5), 0.2))):
        mean = {}
        for order in ORDERS:
            raw = advancing_front(domain, 0.01, order=order, placement="equal sides", finish=False)
            mean[order] = raw.figures["mean 2r/R"]
        assert max(mean, key=mean.__getitem__) == "widest" and mean["widest"] > 0.99


# --- options ---------------------------------------------------------------------------------------


def test_a_function_places_points() -> None:
    calls = []

    def place(p: np.ndarray, a: np.ndarray, b: np.ndarray, n: np.ndarray, h: float) -> Any:
        assert not np.array_equal(a, b) and h == pytest.approx(0.2)
        calls.append((p, n))
        if len(calls) % 3 == 0:
            return None
        return (a + b) / 2 + np.array([a[1] - b[1], b[0] - a[0]]) * ROOT3 / 2

    for order in ORDERS:
        raw = advancing_front(SQUARE, 0.2, placement=place, order=order, finish=False, history=True)
        assert check(raw, domain=SQUARE) and raw.counts["angle"] > 0 < raw.counts["new point"]
    assert check(
        advancing_front(SQUARE, 0.2, placement=lambda *_: None), domain=SQUARE, delaunay="constrained"
    )


@pytest.mark.parametrize("answer", ["here", (1, 2, 3), (np.nan, 0.0), (np.inf, 0), 5, [[0, 0]]])
def test_a_function_that_places_nothing(answer: Any) -> None:
    with pytest.raises(InputError, match="placement returned"):
        advancing_front(SQUARE, 0.2, placement=lambda *_: answer)


@pytest.mark.parametrize("place", [lambda p: p, lambda p, a, b, n, h: 1 / 0])
def test_a_function_that_raises(place: Any) -> None:
    with pytest.raises(InputError, match=r"placement raised .*Error .* from .* to .*; it is called as"):
        advancing_front(SQUARE, 0.2, placement=place)


def test_points_far_away_or_on_vertices_do_no_harm() -> None:
    for answer in ((1e300, 1e300), (0.0, 0.0), (0.5, 0.0), (-3.0, 0.2)):
        raw = advancing_front(SQUARE, 0.3, placement=lambda *_, x=answer: x, finish=False)
        assert check(raw, domain=SQUARE)


@pytest.mark.parametrize(
    "options",
    [
        {"order": "largest"},
        {"placement": "ideal"},
        {"placement": 3},
        {"search": "far"},
        {"search": ["ideal"]},
        {"split_boundary": "outer"},
    ],
)
def test_unknown_options(options: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(options))):
        advancing_front(SQUARE, 0.2, **options)


def test_budget() -> None:
    mesh = advancing_front(SQUARE, 0.02, budget=100)
    assert not mesh.complete and set(mesh.reasons) == {"budget"} and check(mesh, domain=SQUARE)
    sides = len(SQUARE.sampled(0.02).points)
    assert len(mesh.points) == sides + 100
    assert sum(mesh.counts[name] for name in (*FRONT_REASONS[:6], "forced")) == mesh.size - len(
        mesh.unrefined
    )


def test_kept_boundary() -> None:
    domain = Domain.polygon([(0, 0), (8, 0), (8, 0.3), (0, 0.3)])
    mesh = advancing_front(domain, 1.0, split_boundary=False)
    assert check(mesh, domain=domain) and len(mesh.segments) == len(domain.sampled(1.0).ends)


def test_the_same_on_every_run() -> None:
    one, two = (advancing_front(lake(), running_size) for _ in range(2))
    assert np.array_equal(one.points, two.points) and np.array_equal(one.simplices, two.simplices)


def test_interrupt(monkeypatch: pytest.MonkeyPatch) -> None:
    work = lambda: advancing_front(SQUARE, 0.002, finish=False, progress=True)  # noqa: E731
    assert max(interrupt(monkeypatch, work, "points")) <= 50_000


def test_a_large_mesh_is_as_round_as_promised() -> None:
    domain = SQUARE.with_holes(Domain.disc((0.5, 0.5), 0.2))
    mesh = advancing_front(domain, 0.0045)
    assert mesh.size > 90_000 and mesh.complete and check(mesh, domain=domain, delaunay="constrained")
    assert mesh.figures["mean 2r/R after"] > 0.9985 and mesh.quality("min_angle").min() > 36.0
