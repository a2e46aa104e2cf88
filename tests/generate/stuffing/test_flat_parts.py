"""Flat parts of surfaces of triangles in doubles and in single precision, and what is said of others."""

from __future__ import annotations

import re

import numpy as np
import pytest

from unstruct import Domain, InputError, Mesh, check, examples, isosurface_stuffing
from unstruct.generate.stuffing.flat_parts import flat_parts

TURN = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
SIDES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
TRIANGLES = [t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))]


def single(points: np.ndarray) -> np.ndarray:
    return points.astype(np.float32).astype(np.float64)


def grid_cube(n: int) -> tuple[np.ndarray, np.ndarray]:
    """A cube with 2 n^2 triangles on each side."""
    s = np.linspace(-1, 1, n + 1)
    corners, rows = [], []
    for axis in range(3):
        for end in (-1.0, 1.0):
            for i in range(n):
                for j in range(n):
                    square = [(s[i + p], s[j + q]) for p, q in ((0, 0), (1, 0), (1, 1), (0, 1))][:: int(end)]
                    ring = np.insert(np.array(square), 0, end, axis=1)
                    rows += [[len(corners) + k for k in t] for t in ((0, 1, 2), (0, 2, 3))]
                    corners += np.roll(ring, axis, axis=1).tolist()
    points, number = np.unique(np.array(corners), axis=0, return_inverse=True)
    return points, number.reshape(-1)[np.array(rows)]


@pytest.mark.parametrize("angle", [30.0, 1.0])
def test_a_turned_cube_in_single_precision(angle: float) -> None:
    body = Domain(single(CORNERS @ TURN.T), TRIANGLES)
    assert 1e-9 < flat_parts(body, angle).deviation < 1e-6
    mesh = isosurface_stuffing(body, 0.5, features=angle)
    assert mesh.complete
    assert check(mesh)
    assert mesh.volume == pytest.approx(body.volume, rel=1e-6)
    origin = np.asarray(mesh.origin)
    assert np.array_equal(np.sort(origin[origin >= 0]), np.arange(8))
    assert np.array_equal(mesh.points[origin >= 0], body.points[origin[origin >= 0]])


@pytest.mark.parametrize("n", [1, 3, 24])
@pytest.mark.parametrize("rounded", [False, True])
def test_six_parts_and_twelve_creases(n: int, rounded: bool) -> None:
    points, rows = grid_cube(n)
    points = points @ TURN.T
    parts = flat_parts(Domain(single(points) if rounded else points, rows), 20.0)
    assert len(parts.frames) == 6
    assert len(parts.edges) == 12 * n
    assert (parts.beside[:, 0] != parts.beside[:, 1]).all()
    side = np.abs((points[rows] @ TURN).mean(axis=1)).argmax(axis=1)
    assert len(set(zip(side.tolist(), parts.part.tolist(), strict=True))) == 6


def test_thin_triangles_whose_normals_are_noise() -> None:
    """A chain of vertices almost on a diagonal: beside it are triangles without a normal to speak of."""
    share = np.linspace(0, 1, 9)[1:-1, None]
    inner = CORNERS[0] + share * (CORNERS[3] - CORNERS[0])
    inner += 1e-6 * share * (1 - share) * (CORNERS[2] - CORNERS[1])
    inner[:, 0] += np.random.default_rng(1).choice([-2e-7, 2e-7], 7)
    points = np.concatenate([single(CORNERS @ TURN.T), inner @ TURN.T])
    chain = [0, *range(8, 15), 3]
    fans = [(0, 1, 3), *[(chain[k], 3, chain[k + 1]) for k in range(7)]]
    fans += [(chain[k], chain[k + 1], 2) for k in range(8)]
    body = Domain(points, [*fans, *TRIANGLES[2:]])
    u, v = (points[np.array(body.facets)[:, k]] - points[np.array(body.facets)[:, 0]] for k in (1, 2))
    normal = np.cross(u, v)
    normal /= np.sqrt((normal**2).sum(axis=1))[:, None]
    assert (np.abs(normal @ TURN).max(axis=1) < 0.9).any()
    parts = flat_parts(body, 30.0)
    assert len(parts.frames) == 6
    assert len(parts.edges) == 12
    mesh = isosurface_stuffing(body, 0.5, features=30)
    assert mesh.complete
    assert check(mesh)


def test_a_short_crease_pinches_nothing() -> None:
    """The end of a wedge is an edge of 1e-5: cells beside it have small volumes, but are not flat."""
    points = CORNERS.copy()
    points[[3, 7]] = points[[2, 6]] + [(0, 0, 1e-5)] * 2
    body = Domain(single(points @ TURN.T), TRIANGLES)
    mesh = isosurface_stuffing(body, 0.4, features=30)
    assert len(mesh.reasons) and all("in the strip along a sharp edge" in reason for reason in mesh.reasons)
    assert check(mesh)
    assert mesh.volume == pytest.approx(body.volume, rel=1e-6)


@pytest.mark.parametrize(
    ("body", "angle"),
    [(Domain.cylinder(size=0.4), 50.0), (Domain.ball(size=0.6), 80.0)],
    ids=["cylinder", "ball"],
)
def test_the_angle_that_is_named_works(body: Domain, angle: float) -> None:
    with pytest.raises(InputError, match="of the extent away from a plane: take features") as caught:
        isosurface_stuffing(body, 0.4, features=angle)
    named = float(re.search("features = ([0-9.]+)", str(caught.value))[1])
    mesh = isosurface_stuffing(body, 0.4, features=named)
    assert mesh.complete
    assert check(mesh)
    assert mesh.volume == pytest.approx(body.volume, rel=1e-12)


def test_the_check_for_sides_in_triangles() -> None:
    """Edges within sides are not kept: the domain to compare with has each side as one polygon."""
    points = CORNERS @ TURN.T
    mesh = isosurface_stuffing(Domain(points, TRIANGLES), 0.5, features=30)
    assert check(mesh, domain=Domain(points, SIDES))
    assert check(mesh, domain=Domain(points, TRIANGLES).simplified())
    kinds = {problem.kind for problem in check(mesh, domain=Domain(points, TRIANGLES)).problems}
    assert kinds == {"facet", "side"}
    assert mesh.volume == pytest.approx(8.0, rel=1e-12)


def test_a_closed_part_is_not_flat() -> None:
    """The normals of a ball in single precision, as of an STL file, may add up to nothing exactly."""
    ball = Domain.ball(size=0.35)
    body = Domain(single(ball.points), ball.triangulated.bounding)
    with pytest.raises(InputError, match="away from a plane: take features"):
        isosurface_stuffing(body, 0.25, features=20)


@pytest.mark.parametrize("turn", [False, True])
def test_the_check_for_sides_of_many_triangles(turn: bool) -> None:
    """With a notch, and with vertices inside of sides: each side is a union of faces in its plane."""
    points, rows = grid_cube(3)
    cube = Domain(points @ TURN.T if turn else points, rows)
    shell = examples.notched_box().triangulated
    notch = Domain(shell.points @ TURN.T if turn else shell.points, shell.bounding)
    for body in (cube, notch):
        mesh = isosurface_stuffing(body, 0.45, features=20)
        assert mesh.complete
        assert check(mesh, domain=body.simplified())
        moved = Mesh(mesh.points + 1e-3 * (np.asarray(mesh.origin) < 0)[:, None], mesh.simplices)
        assert not check(moved, domain=body.simplified())


@pytest.mark.parametrize("unit", [1e-280, 1e-100, 1e200])
def test_features_in_any_unit(unit: float) -> None:
    box = Domain.box()
    body = Domain(box.points * unit, box.facets)
    mesh = isosurface_stuffing(body, lambda x: np.full(len(x), 0.4 * unit), features=30)
    assert mesh.complete
    assert check(mesh)
    assert check(mesh, domain=body)
    assert mesh.figures["cells missed"] < 1e-9
