"""Repeated triangles, and parts of a surface that are much nearer to each other than the size."""

from __future__ import annotations

import sys
import warnings
from fractions import Fraction

import numpy as np
import pytest
from surface_shapes import icosphere, joined, remeshed, saddle, surface_delaunay_of

import unstruct
from unstruct import DomainMesh, Mesh, examples, remesh, surface_delaunay
from unstruct.domain.given_surface import given_surface
from unstruct.errors import IncompleteWarning, InputError
from unstruct.generate.surface.near_sheets import creases_near, keeping
from unstruct.generate.surface.surface_delaunay import NEAR_OTHERS
from unstruct.geometry.embedded import meeting_pairs


def grid(n: int = 4) -> tuple[np.ndarray, np.ndarray]:
    flat = saddle(n)
    return flat.points * [1.0, 1.0, 0.0], np.array(flat.simplices)


# ---------------------------------------------------------------------- repeated triangles


@pytest.mark.parametrize("options", [{"size": 0.2}, {"min_angle": 25}, {}, {"deviation": 1e-3}])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("repeated", [1, 5, 32])
def test_repeated_triangles_count_once(options: dict, turned: bool, repeated: int) -> None:
    """They halved edges until the budget, or stayed, and no word; copies may be turned."""
    points, rows = grid()
    again = rows[:repeated, ::-1] if turned else rows[:repeated]
    given = Mesh(np.concatenate([points, points]), np.concatenate([rows, again + len(points)]))
    once, mesh = (surface_delaunay(surface, **options) for surface in (Mesh(points, rows), given))
    assert (mesh.points == once.points).all() and (mesh.simplices == once.simplices).all()
    assert mesh.counts["repeated triangles"] == repeated and mesh.complete
    assert once.counts["repeated triangles"] == 0 == once.counts["own crossings"]
    assert unstruct.check(mesh, domain=given)


def test_the_same_place_triangulated_twice_is_told() -> None:
    """With other diagonals no triangle is repeated: the two cover each other."""
    points, rows = grid(1)
    a, b, c, d = 0, 1, 3, 2
    assert {a, b, c, d} == set(rows.ravel().tolist())
    given = Mesh(points, [[a, b, c], [a, c, d], [a, b, d], [b, c, d]])
    for options in ({"size": 0.2}, {}):
        mesh = surface_delaunay_of(given, **options)
        assert mesh.size < 1000 and mesh.counts["own crossings"] > 0
        assert len(mesh.unrefined) == mesh.size and all("crosses itself" in why for why in mesh.reasons)


# ---------------------------------------------------------------------- sheets near each other


def shell(distance: float) -> Mesh:
    """A ball of 216 triangles, and another one in it, turned inward."""
    body = examples.level_surface(examples.sphere(), 0.4)
    points, rows = np.array(body.points), np.array([list(facet) for facet in body.facets])
    return joined((points, rows), (points * (1 - distance), rows[:, ::-1]))


def meets_by_fractions(mesh: DomainMesh, pairs: np.ndarray) -> bool:
    """Whether an edge of one of some pairs of triangles passes through the inside of the other."""
    x = [[Fraction(v) for v in p] for p in mesh.points.tolist()]

    def six(a: int, b: int, c: int, d: int) -> Fraction:
        u, v, w = ([p - q for p, q in zip(x[i], x[a])] for i in (b, c, d))
        return (
            u[0] * (v[1] * w[2] - v[2] * w[1])
            - u[1] * (v[0] * w[2] - v[2] * w[0])
            + u[2] * (v[0] * w[1] - v[1] * w[0])
        )

    for one, two in pairs.tolist():
        for s, t in ((one, two), (two, one)):
            a, b, c = mesh.simplices[t].tolist()
            for p, q in zip(mesh.simplices[s].tolist(), np.roll(mesh.simplices[s], -1).tolist()):
                if six(a, b, c, p) * six(a, b, c, q) < 0:
                    sides = [six(p, q, u, v) > 0 for u, v in ((a, b), (b, c), (c, a))]
                    if all(sides) or not any(sides):
                        return True
    return False


def near_pairs(mesh: DomainMesh, within: float) -> np.ndarray:
    """Pairs of triangles of two sheets with near centers."""
    center = mesh.corners.mean(axis=1)
    away = ((center[:, None] - center[None]) ** 2).sum(axis=2)
    rows = np.argwhere((away < within**2) & (np.arange(len(center))[:, None] < np.arange(len(center))))
    common = (mesh.simplices[rows[:, 0]][:, :, None] == mesh.simplices[rows[:, 1]][:, None]).any(axis=(1, 2))
    return rows[~common]


@pytest.mark.parametrize("distance", [1e-2, 1e-3, 1e-4, 1e-9, 1e-12])
def test_two_walls_are_meshed_as_far_apart_ones(distance: float) -> None:
    """77,000 triangles, of which 3,500 crossed; at 1e-4 it did not end, nor did `surface_delaunay`."""
    surface, size = shell(distance), 0.2
    far = remesh(shell(0.3), size)
    for made in (remeshed, surface_delaunay_of):
        mesh = made(surface, size)
        assert mesh.size < 2 * far.size and unstruct.check(mesh, domain=surface)
        assert len(meeting_pairs(mesh.points, mesh.simplices)) == 0
        assert not meets_by_fractions(mesh, near_pairs(mesh, 0.05))
        assert not any("cross" in why or "embedded" in why for why in mesh.reasons)


def test_fractions_see_what_crosses() -> None:
    """The oracle of the test before, on sheets that are meshed each by itself."""
    sheets = shell(1e-3)
    half = sheets.size // 2
    parts = []
    for rows, size in ((sheets.simplices[:half], 0.2), (sheets.simplices[half:], 0.21)):
        mesh = remesh(Mesh(sheets.points, rows), size)
        parts.append((mesh.points, mesh.simplices))
    both = joined(*parts)
    assert meets_by_fractions(DomainMesh(both.points, both.simplices), near_pairs(both, 0.1))


@pytest.mark.parametrize("distance", [1e-6, 1e-9])
def test_finely_triangulated_sheets_stay_as_they_are(distance: float) -> None:
    """Larger triangles would cross, smaller ones too: the given ones are kept where they are near."""
    fine = icosphere(4)
    turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    order = np.random.default_rng(0).permutation(len(fine.simplices))
    surface = joined(
        (fine.points @ turn, fine.simplices), (fine.points @ turn * (1 + distance), fine.simplices[order])
    )
    for made in (remeshed, surface_delaunay_of):
        mesh = made(surface, 0.3)
        assert len(meeting_pairs(mesh.points, mesh.simplices)) == 0
        assert surface.size // 2 < mesh.size <= 1.2 * surface.size and unstruct.check(mesh, domain=surface)


def test_kept_edges_that_would_be_too_many_are_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """What cannot be resolved is told, and nothing is refined in vain."""
    surface = shell(1e-4)
    for module in ("remesh", "repairing"):
        monkeypatch.setattr(sys.modules[f"unstruct.generate.surface.{module}"], "KEEPINGS", 0)
    few = remeshed(surface, 0.2)
    crossing = set(meeting_pairs(few.points, few.simplices).ravel().tolist())
    assert few.size < 2000 and len(crossing) > 500 and crossing <= set(few.unrefined.tolist())
    assert {why.split(":")[0] for why in few.reasons} == {"crosses another triangle"}
    straight = surface_delaunay_of(surface, 0.2)
    crossing = set(meeting_pairs(straight.points, straight.simplices).ravel().tolist())
    assert straight.size < 2000 and len(crossing) > 500 and crossing <= set(straight.unrefined.tolist())
    assert all(NEAR_OTHERS in why for why in straight.reasons)


def test_edges_that_are_kept() -> None:
    surface = shell(1e-4)
    given = given_surface(surface, 40.0)
    support = given.support
    edges = creases_near(support, (support.points * support.factor)[surface.simplices[:3]], 0)
    assert 9 <= len(edges) < len(surface.edges) and len(support.features) == 0
    other = keeping(given, edges, 40.0)
    assert {tuple(sorted(e)) for e in other.support.features.tolist()} == {tuple(e) for e in edges.tolist()}
    again = keeping(other, np.array([[0, len(support.points) - 1]]), 40.0)  # no edge of it
    assert (again.support.features == other.support.features).all()
    points, rows = grid()
    plane = given_surface(Mesh(points, rows), 40.0).support
    assert len(creases_near(plane, (plane.points * plane.factor)[rows], 0)) == 0  # flat: none need be kept


def test_a_budget_that_ends_repairs_is_told() -> None:
    """An IndexError: faults were looked for in triangles of before the last halves."""
    for budget in (300, 450, 700, 1000):
        mesh = surface_delaunay_of(shell(1e-6), 0.2, budget=budget)
        assert len(mesh.points) <= budget + 20 and not mesh.complete
        assert all("budget" in why or NEAR_OTHERS in why or "meet" in why for why in mesh.reasons)


@pytest.mark.parametrize("power", [-900, -500, 500, 1000])
def test_units_of_length_whose_squares_no_double_can_hold(power: int) -> None:
    """At 1e150 normals were not finite, and all triangles faced the wrong way."""
    one = shell(1e-4)
    other = Mesh(one.points * 2.0**power, one.simplices)
    for made in (remeshed, surface_delaunay_of):
        few, many = made(one, 0.2), made(other, 0.2 * 2.0**power)
        assert (few.simplices == many.simplices).all() and (few.points * 2.0**power == many.points).all()
        assert few.counts == many.counts and few.counts["kept edges"] > 0


def test_a_crumpled_sheet_is_left_when_vertices_only_creep() -> None:
    """Creases nearer than the size: vertices crept in all sweeps, 413,000 moves; 22 triangles crossed."""
    x, y = np.meshgrid(np.linspace(0, 1, 7), np.linspace(0, 1, 7))
    z = 0.2 * np.sin(7 * x) * np.cos(5 * y)
    a = (np.arange(6)[:, None] * 7 + np.arange(6)).ravel()
    rows = np.concatenate([np.stack([a, a + 1, a + 8], axis=1), np.stack([a, a + 8, a + 7], axis=1)])
    surface = Mesh(np.column_stack([x.ravel() ** 8, y.ravel(), z.ravel()]), rows)
    mesh = remeshed(surface, 0.2)
    assert mesh.counts["moves"] < 250_000 and mesh.size < 2000 and unstruct.check(mesh, domain=surface)
    assert len(meeting_pairs(mesh.points, mesh.simplices)) == 0


# ---------------------------------------------------------------------- arguments and functions


def test_a_deviation_of_zero_cannot_be() -> None:
    for size in (None, 0.2):
        with pytest.raises(InputError, match=r"deviation = 0\.0 must be positive"):
            surface_delaunay(icosphere(1), size, deviation=0)


def test_a_function_that_raises_is_told_with_the_place() -> None:
    def onto(x: np.ndarray) -> np.ndarray:
        if (x[:, 2] > 0.99).any():
            raise ZeroDivisionError("no pole")
        return x

    with warnings.catch_warnings():
        warnings.simplefilter("error", IncompleteWarning)
        with pytest.raises(InputError, match=r"ZeroDivisionError \(no pole\) at x\[1\] = \[0.0, 0.0, 1.0\]"):
            remesh(
                Mesh([[1.0, 0, 0], [0, 0, 1], [0, 1, 0], [0, 0, -1]], [[0, 1, 2], [0, 2, 3]]), 0.3, onto=onto
            )
