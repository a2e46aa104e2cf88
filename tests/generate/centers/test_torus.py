"""Circumcenter insertion on the torus: the chapter's three relations, without exception."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import InputError, simplex
from unstruct.generate.centers.periodic import PeriodicMesh, periodic_delaunay
from unstruct.plain import circumcenters as plain
from unstruct.studies import periodic_circumcenters

LATTICE = np.array([(i / 5, j / 5) for i in range(5) for j in range(5)])
SHEARED = np.array([(i / 4, (j + 0.5 * (i % 2)) / 4) for i in range(4) for j in range(4)])


def jittered(seed: int, n: int = 5, amount: float = 0.8) -> np.ndarray:
    """A point in each of n x n squares: no empty disk of radius 1/4."""
    cells = np.stack(np.meshgrid(np.arange(n), np.arange(n)), axis=-1).reshape(-1, 2)
    return (cells + amount * np.random.default_rng(seed).random((n * n, 2))) / n


starts = st.builds(jittered, st.integers(0, 10**6), st.integers(6, 9), st.floats(0.05, 1.0))


def state(mesh: PeriodicMesh) -> dict[str, float]:
    edges = simplex.edge_lengths(mesh.corners)
    radius, ratio = simplex.circumradius(mesh.corners).max(), mesh.quality("radius_ratio").max()
    angle = mesh.quality("min_angle").min()
    return {"R": radius, "l": edges.min(), "L": edges.max(), "mu": ratio, "angle": angle}


# ---------------------------------------------------------------------- the triangulation


@given(starts)
@settings(deadline=None, max_examples=25)
def test_delaunay_on_the_torus(points: np.ndarray) -> None:
    mesh = periodic_delaunay(points)
    assert mesh.check() and np.abs((mesh.points - points + 0.5) % 1.0 - 0.5).max() <= 2.0**-50
    assert (mesh.points * 2.0**50 % 1.0 == 0).all()
    moved = periodic_delaunay(points + np.array([3.0, -2.0]))
    assert moved.check() and len(moved.simplices) == len(mesh.simplices)
    plane = mesh.plane()
    assert plane.size == mesh.corners.shape[0] and np.allclose(plane.corners, mesh.corners)


@pytest.mark.parametrize(
    "points", [LATTICE, SHEARED, LATTICE[:, ::-1] + 0.5 / 5], ids=["square", "sheared", "moved"]
)
def test_lattices(points: np.ndarray) -> None:
    mesh = periodic_delaunay(points)
    assert mesh.check() and len(mesh.simplices) == 2 * len(points)


def test_bad_input() -> None:
    with pytest.raises(InputError, match="equal on the torus"):
        periodic_delaunay(np.vstack([LATTICE, LATTICE[:1] + 1.0]))
    for few in (LATTICE[:2], LATTICE[:12], np.array([(0.1, 0.1)]), np.random.default_rng(0).random((4, 2))):
        with pytest.raises(InputError, match="too few or too uneven"):
            periodic_delaunay(few)
    with pytest.raises(InputError, match="has 2"):
        periodic_delaunay(np.zeros((4, 3)))
    with pytest.raises(InputError, match="budget"):
        periodic_circumcenters(LATTICE)
    with pytest.raises(InputError, match="-3"):
        periodic_circumcenters(LATTICE, budget=-3)
    with pytest.raises(InputError, match="0 points are too few"):
        periodic_circumcenters(np.empty((0, 2)), 0.1)


def test_check_finds_what_is_wrong() -> None:
    mesh = periodic_delaunay(jittered(1))
    parts = {k: getattr(mesh, k).copy() for k in ("points", "simplices", "shifts", "neighbors")}

    def spoiled(name: str, change) -> PeriodicMesh:
        arrays = {k: v.copy() for k, v in parts.items()}
        change(arrays[name])
        return PeriodicMesh(**arrays)

    def turn(rows: np.ndarray) -> None:
        rows[3] = rows[3][::-1]

    def move(rows: np.ndarray) -> None:
        rows[3, 1, 0] += 1

    def drag(rows: np.ndarray) -> None:
        rows[7] += 0.03

    assert "orientation" in str(spoiled("simplices", turn).check())
    assert not spoiled("shifts", move).check()
    assert not spoiled("points", drag).check()
    assert "adjacency" in str(spoiled("neighbors", lambda rows: rows.__setitem__((4, 0), 4)).check())
    less = PeriodicMesh(
        parts["points"], parts["simplices"][1:], parts["shifts"][1:], parts["neighbors"][1:] % 40
    )
    assert "count" in str(less.check())


# ---------------------------------------------------------------------- the relations


@given(starts, st.sampled_from([40, 400, 2500]))
@settings(deadline=None, max_examples=25)
def test_the_three_relations(points: np.ndarray, budget: int) -> None:
    mesh = periodic_circumcenters(points, budget=budget, history=True)
    steps = mesh.steps
    assert steps is not None and mesh.check() and mesh.counts["circumcenters"] == budget
    R, l, L = steps["R"], steps["l"], steps["L"]
    assert (R[1:] <= R[:-1] * (1 + 1e-11)).all()  # (1)
    assert np.allclose(steps["chosen"], R[:-1], rtol=1e-12)
    law = np.minimum(l[0], np.minimum.accumulate(R[:-1]))
    assert np.allclose(l[1:], law, rtol=1e-10)  # the exact law, and by (1) the chapter's (2):
    assert np.allclose(l[1:], np.where(R[:-1] >= l[0], l[0], R[:-1]), rtol=1e-10)
    late = R <= l[0]  # (3)
    assert (L[late] <= 2 * l[late] * (1 + 1e-10)).all() and (steps["angle"][late] >= 30 - 1e-8).all()
    assert (steps["mu"][late] <= 2 + 4 / math.sqrt(3) + 1e-8).all()
    assert (np.sin(np.radians(steps["angle"])) >= l / (2 * R) * (1 - 1e-10)).all()  # (12.2)
    last = state(mesh)
    assert all(last[name] == pytest.approx(steps[name][-1], rel=1e-9) for name in last)


def test_the_first_relation_holds_exactly() -> None:
    """Relation (1) does not care where in the circle the point lies: rounding cannot break it."""
    mesh = periodic_circumcenters(jittered(4, 5), budget=40)
    previous = None
    for n in range(25, 66):
        corners = periodic_delaunay(mesh.points[:n]).corners
        largest = Fraction(0)
        for t in corners[np.argsort(simplex.circumradius(corners))[-3:]]:  # the others are far below
            exact = [tuple(Fraction(float(x)) for x in p) for p in t]
            largest = max(largest, plain.radius2(exact, (0, 1, 2)))
        assert previous is None or largest <= previous
        previous = largest


def test_prefixes_are_states() -> None:
    points = jittered(7, 6)
    mesh = periodic_circumcenters(points, budget=120, history=True)
    assert mesh.steps is not None
    for k in (0, 1, 17, 60, 119, 120):
        now = state(periodic_delaunay(mesh.points[: 36 + k]))
        assert all(now[name] == pytest.approx(mesh.steps[name][k], rel=1e-9) for name in now)


def test_the_plain_version_agrees() -> None:
    points = SHEARED + np.random.default_rng(3).integers(0, 100, (16, 2)) / 2048
    steps = list(plain.circumcenter_insertion_on_torus(points.tolist(), 5))
    mesh = periodic_circumcenters(points, budget=5)
    assert np.allclose([[float(x) % 1.0 for x in step.point] for step in steps], mesh.points[16:], rtol=1e-12)
    own = plain.in_square(steps[-1].points, steps[-1].cells)
    radii = sorted(math.sqrt(plain.radius2(steps[-1].points, cell)) for cell in own)
    assert np.allclose(radii, np.sort(simplex.circumradius(mesh.corners)), rtol=1e-9)


def test_packing() -> None:
    """Points inserted while R >= rho are rho apart: no more than 2 / (sqrt(3) rho^2) of them fit."""
    mesh = periodic_circumcenters(jittered(2), 0.05)
    f = 0.05 / math.sqrt(3)
    assert mesh.complete and mesh.counts["circumcenters"] <= 2 / (math.sqrt(3) * f * f)
    assert simplex.circumradius(mesh.corners).max() < f


def test_sizes_that_change() -> None:
    def size(x: np.ndarray) -> np.ndarray:
        return 0.03 + 0.05 * (1 - np.cos(2 * np.pi * x[:, 0]))

    mesh = periodic_circumcenters(jittered(3), size)
    f = size(simplex.circumcenter(mesh.corners)) / math.sqrt(3)
    assert mesh.complete and mesh.check() and (simplex.circumradius(mesh.corners) < 1.03 * f).all()


def test_budget_tells_the_truth() -> None:
    mesh = periodic_circumcenters(jittered(5), 0.02, budget=100)
    assert not mesh.complete and set(mesh.reasons) == {"budget"}
    bad = np.flatnonzero(simplex.circumradius(mesh.corners) >= 0.02 / math.sqrt(3))
    assert np.array_equal(mesh.unrefined, bad)


def test_progress(capsys: pytest.CaptureFixture[str]) -> None:
    quiet = periodic_circumcenters(jittered(5), budget=50)
    assert capsys.readouterr().err == ""
    loud = periodic_circumcenters(jittered(5), budget=50, progress=True)
    assert "50 points" in capsys.readouterr().err and np.array_equal(loud.points, quiet.points)


def test_large() -> None:
    mesh = periodic_circumcenters(jittered(6), budget=100_000)
    assert mesh.check() and mesh.quality("min_angle").min() > 30 - 1e-6
