"""The front on a surface: judged by `check`, which shares nothing with it, on surfaces of every kind."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from interrupts import interrupt

from unstruct import Domain, IncompleteWarning, Mesh, check, examples, remesh
from unstruct.domain.given_surface import given_surface
from unstruct.errors import InputError
from unstruct.generate.surface.front import surface_front
from unstruct.generate.surface.front_near import _crosses
from unstruct.generate.surface.front_sizes import caps_of, parts_of
from unstruct.generate.surface.front_start import cut_curves, sides_of_curves
from unstruct.generate.surface.own_crossings import OWN_CROSSING
from unstruct.mesh.domain_mesh import DomainMesh
from unstruct.sizing.asked import MISSED_SIZE
from unstruct.sizing.field import as_size

THREE_SHEETS = Mesh(
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]], [[0, 1, 2], [1, 0, 3], [0, 1, 4]]
)


def hill(n: int = 12) -> Mesh:
    x, y = np.meshgrid(np.arange(n + 1) / n, np.arange(n + 1) / n, indexing="ij")
    z = 0.2 * np.sin(5 * x) * np.cos(4 * y)
    rows = [
        row
        for i in range(n)
        for j in range(n)
        for a in [(n + 1) * i + j]
        for row in ([a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1])
    ]
    half = [row for row in rows if row[0] < (n + 1) * (n // 2)]
    path = [[(n + 1) * i + i, (n + 1) * (i + 1) + i + 1] for i in range(n)]
    points = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    return Mesh(points, rows, markers={"half": half, "path": path, "region": np.full(len(rows), 7)})


def angles(mesh: Mesh) -> np.ndarray:
    x = mesh.points[mesh.simplices]
    sides = np.linalg.norm(x[:, [1, 2, 0]] - x[:, [2, 0, 1]], axis=2)
    a, b, c = sides.T
    cosines = [(b * b + c * c - a * a) / (2 * b * c), (c * c + a * a - b * b) / (2 * c * a)]
    two = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
    return np.concatenate([two, 180 - two.sum(axis=0, keepdims=True)])


CASES: dict[str, tuple[Any, Any, float]] = {
    "ball": (Domain.ball(size=0.2), 0.2, 30),
    "coarse given": (Domain.ball(size=0.5), 0.1, 30),
    "larger than the ball": (Domain.ball(size=0.3), 5.0, 25),
    "torus": (Domain.torus(size=0.15), 0.15, 25),
    "box": (Domain.box((0, 0, 0), (1, 2, 1)), 0.2, 30),
    "box, larger than its sides": (Domain.box((0, 0, 0), (1, 2, 1)), 9.0, 20),
    "cylinder": (Domain.cylinder(size=0.2), 0.2, 30),
    "plate": (Domain.box((0, 0, 0), (1, 1, 0.02)), 0.2, 4),
    "hill": (hill(), 0.1, 25),
    "three sheets": (THREE_SHEETS, 0.15, 25),
    "graded": (Domain.ball(size=0.1), lambda x: 0.05 + 0.2 * np.abs(x[:, 2] - 1), 20),
    "merged body": (examples.level_surface(examples.merged_body(0), 0.2), 0.2, 15),
}


@pytest.mark.parametrize("improve", [True, False])
@pytest.mark.parametrize("name", CASES)
def test_surfaces(name: str, improve: bool) -> None:
    surface, size, least = CASES[name]
    mesh = surface_front(surface, size, improve=improve)
    report = check(mesh, domain=surface)
    assert report, report
    assert mesh.complete and mesh.counts["attempts"] == 1
    assert mesh.counts["candidate"] + mesh.counts["point"] + mesh.counts["search"] <= mesh.size + 8
    assert angles(mesh).min() > (least if improve else 3)


@pytest.mark.parametrize("size", [0.05, 0.1, 0.3])
def test_lengths_are_as_wanted(size: float) -> None:
    mesh = surface_front(Domain.torus(size=0.1), size)
    x = mesh.points[mesh.edges]
    lengths = np.linalg.norm(x[:, 0] - x[:, 1], axis=1)
    assert 0.85 * size < np.median(lengths) < 1.15 * size and lengths.max() < 2 * size


def test_names_follow() -> None:
    """Names of triangles, of edges and numbers; the path is a chain of edges."""
    surface = hill()
    mesh = surface_front(surface, 0.06)
    assert check(mesh, domain=surface)
    x = mesh.points[mesh.markers["half"]]
    assert (x[:, :, 0] <= 0.5 + 1e-12).all() and (mesh.markers["region"] == 7).all()
    ends = mesh.points[mesh.markers["path"]]
    assert np.allclose(ends[:, :, 0], ends[:, :, 1]) and np.isclose(
        np.abs(ends[:, 0, 0] - ends[:, 1, 0]).sum(), 1.0
    )
    box = Domain.box((0, 0, 0), (1, 1, 1))
    mesh = surface_front(box, 0.3)
    assert set(mesh.markers) == set(box.markers) and check(mesh, domain=box)


def test_a_cone_keeps_its_tip_and_a_named_vertex_stays() -> None:
    angle = np.arange(24) * np.pi / 12
    rim = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    points = np.concatenate([rim, [[0, 0, 2]]])
    rows = np.column_stack([np.arange(24), (np.arange(24) + 1) % 24, np.full(24, 24)])
    cone = Mesh(points, rows)
    mesh = surface_front(cone, 0.3)
    assert check(mesh, domain=cone), check(mesh, domain=cone)
    assert (mesh.points == [0, 0, 2]).all(axis=1).any()
    ball = given_surface(Domain.ball(size=0.3)).support
    spot = Mesh(ball.points, ball.triangles, markers={"spot": [[17]]})
    mesh = surface_front(spot, 0.3)
    assert check(mesh, domain=spot) and (mesh.points == ball.points[17]).all(axis=1).any()


def test_components_and_thin_gaps() -> None:
    """Two balls, one within the other, far closer to each other than the size."""
    one, two = (given_surface(Domain.ball(radius=r, size=0.3)).support for r in (1.0, 0.98))
    shell = Mesh(
        np.concatenate([one.points, two.points]),
        np.concatenate([one.triangles, two.triangles[:, ::-1] + len(one.points)]),
    )
    mesh = surface_front(shell, 0.12)
    report = check(mesh, domain=shell)
    assert report, report


def test_what_cannot_close_is_told() -> None:
    """A pit far narrower than the size, whose walls nearly touch: never an invalid mesh, never in silence."""
    surface = examples.level_surface(examples.noisy_ball(0), 0.1)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        mesh = surface_front(surface, 0.3)
    assert not mesh.complete and len(mesh.unrefined) == mesh.size
    assert any(issubclass(one.category, IncompleteWarning) for one in told)
    report = check(mesh, domain=surface)
    assert "meets itself" not in {p.kind for p in report.problems}, report


def test_the_budget() -> None:
    surface = Domain.ball(size=0.3)
    with pytest.warns(IncompleteWarning, match="budget"):
        mesh = surface_front(surface, 0.05, budget=100)
    assert check(mesh, domain=surface) and not mesh.complete


@pytest.mark.parametrize("exponent", [-200, 200])
def test_very_large_and_small(exponent: int) -> None:
    own = given_surface(Domain.torus(size=0.3)).support
    mesh = surface_front(Mesh(own.points, own.triangles), 0.3)
    surface = Mesh(np.ldexp(own.points, exponent), own.triangles)
    scaled = surface_front(surface, float(np.ldexp(0.3, exponent)))
    assert np.array_equal(scaled.points, np.ldexp(mesh.points, exponent))
    assert np.array_equal(scaled.simplices, mesh.simplices)


@settings(deadline=None, max_examples=15)
@given(st.integers(0, 2**32))
def test_random_polyhedra(seed: int) -> None:
    """Hulls of random points with all their edges as creases, needles among their facets, and any size."""
    from scipy.spatial import ConvexHull

    rng = np.random.default_rng(seed)
    points = rng.standard_normal((int(rng.integers(5, 14)), 3)) * [1, 1, rng.choice([0.05, 1.0])]
    body = Domain(
        points[np.unique(rows := ConvexHull(points).simplices)],
        np.unique(rows, return_inverse=True)[1].reshape(-1, 3),
    )
    size = float(rng.choice([0.1, 0.3, 1.0]))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)
        mesh = surface_front(body, size)
    report = check(mesh, domain=body)
    assert report, report


@settings(deadline=None, max_examples=60)
@given(st.lists(st.integers(-3, 3), min_size=8, max_size=8))
def test_crossings_beside_fractions(values: list[int]) -> None:
    """Two segments in the plane: whether a point of both is there, by solving exactly."""
    p, q, a, b = np.array(values, dtype=float).reshape(4, 2)
    if (p == q).all() or (a == b).all():
        return

    def side(u: np.ndarray, v: np.ndarray, w: np.ndarray) -> float:
        return float((v[0] - u[0]) * (w[1] - u[1]) - (v[1] - u[1]) * (w[0] - u[0]))

    def on(u: np.ndarray, v: np.ndarray, w: np.ndarray) -> bool:
        return side(u, v, w) == 0 and bool(((np.minimum(u, v) <= w) & (w <= np.maximum(u, v))).all())

    proper = side(p, q, a) * side(p, q, b) < 0 and side(a, b, p) * side(a, b, q) < 0
    touch = on(p, q, a) or on(p, q, b) or on(a, b, p) or on(a, b, q)
    assert _crosses(p / 8, q / 8, a / 8, b / 8) == (proper or touch)


def test_curves_are_cut_evenly() -> None:
    """Chords of a circle and of straight sides, each with one edge of the front for each side."""
    body = Domain.cylinder(size=0.1)
    support = given_surface(body).support
    curves = cut_curves(support, as_size(0.25), 1.0, np.full(len(support.points), np.inf))
    lengths = np.linalg.norm(np.diff(curves.points[curves.rows], axis=1)[:, 0], axis=1) / support.factor
    assert 0.2 < lengths.min() and lengths.max() < 0.3
    rows, normals, seats, chord = sides_of_curves(support, curves)
    assert len(rows) == 2 * len(curves.rows) and (np.bincount(chord) == 2).all()
    assert np.allclose(np.linalg.norm(normals, axis=1), 1) and (seats >= 0).all()


def test_lengths_follow_the_turns_of_the_surface() -> None:
    support = given_surface(Domain.ball(radius=2.0, size=0.2)).support
    part = parts_of(support.held.rows, len(support.points))
    assert len(np.unique(part)) == 1
    cap = caps_of(support, part, 0.5) / support.factor
    assert 0.6 < cap.min() and cap.max() < 1.3, "half a radian of a sphere of radius 2"
    assert caps_of(support, part, np.inf)[0] / support.factor == pytest.approx(0.25 * 4 * 3**0.5, rel=0.1)


def test_wrong_arguments() -> None:
    ball = Domain.ball(size=0.5)
    for call in (
        lambda: surface_front(ball, -1.0),
        lambda: surface_front(ball, 0.3, sharp=0.0),
        lambda: surface_front(ball, 0.3, improve="yes"),
        lambda: surface_front(ball, 0.3, budget=-1),
        lambda: surface_front("ball", 0.3),
    ):
        with pytest.raises(InputError):
            call()
    assert isinstance(surface_front(ball, 0.5), DomainMesh)


def test_an_interrupt_is_heard_within_the_march(monkeypatch: pytest.MonkeyPatch) -> None:
    work = lambda: surface_front(Domain.ball(size=0.1), 0.02, improve=False, progress=True)  # noqa: E731
    assert max(interrupt(monkeypatch, work, "triangles")) <= 20_000


def test_a_front_lists_what_misses_the_size() -> None:
    def size(x: np.ndarray) -> np.ndarray:
        return np.where(np.linalg.norm(x - [0.5, 0.5, 1.0], axis=1) < 0.2, 0.04, 0.2)

    mesh = surface_front(Domain.box((0, 0, 0), (1, 1, 1)), size)
    corners = mesh.points[mesh.simplices]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    large = sides.max(axis=1) > 2.5 * size(corners.mean(axis=1))
    assert large.any() and np.isin(np.flatnonzero(large), mesh.unrefined).all()
    at_corner = size(corners.reshape(-1, 3)).reshape(-1, 3).min(axis=1)
    large |= sides.min(axis=1) > 2.5 * at_corner
    assert np.array_equal(np.flatnonzero(large), mesh.unrefined)
    assert set(mesh.reasons) == {MISSED_SIZE}


def test_a_front_tells_where_the_given_surface_crosses_itself() -> None:
    i, j = (a.ravel() for a in np.meshgrid(range(4), range(4), indexing="ij"))
    u, v = (a.ravel() / 4 for a in np.meshgrid(range(5), range(5), indexing="ij"))
    rows = np.concatenate([np.stack([5 * i + j, 5 * i + j + 5, 5 * i + j + 6], 1),
                           np.stack([5 * i + j, 5 * i + j + 6, 5 * i + j + 1], 1)])  # fmt: skip
    flat, upright = np.stack([u, v, 0 * u], 1), np.stack([0.9 * u + 0.037, 0 * u + 0.513, v - 0.5], 1)
    given = Mesh(np.concatenate([flat, upright]), np.concatenate([rows, rows + 25]))
    mesh = surface_front(given, 1 / 8)
    assert mesh.counts["own crossings"] == remesh(given, 1 / 8).counts["own crossings"] > 0
    assert len(mesh.unrefined) and set(mesh.reasons) == {OWN_CROSSING}
    x = mesh.points[mesh.simplices[mesh.unrefined]]
    assert (np.abs(x[..., 2]).min(axis=1) < 1 / 8).all()
    assert (np.abs(x[..., 1] - 0.513).min(axis=1) < 1 / 8).all()
