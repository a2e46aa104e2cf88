"""Ready-made bodies: points on true surfaces, shapes of triangles, orientation, names, hostile arguments."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from unstruct import Domain, InputError, UnstructError


def triangles_of(domain: Domain) -> np.ndarray:
    return domain.points[np.asarray(domain.facets)]


def angles(corners: np.ndarray) -> np.ndarray:
    """All angles in degrees, (t, 3)."""
    found = []
    for k in range(3):
        a, b = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        cosine = (a * b).sum(axis=1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
        found.append(np.degrees(np.arccos(cosine)))
    return np.stack(found, axis=1)


def edges(corners: np.ndarray) -> np.ndarray:
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)


def euler(domain: Domain) -> int:
    rows = np.asarray(domain.facets)
    sides = np.sort(rows[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return len(domain.points) - len(np.unique(sides, axis=0)) + len(rows)


def outward(domain: Domain) -> bool:
    """Whether the triangles, as they are turned, enclose the volume: then normals point out."""
    signed = np.linalg.det(triangles_of(domain)).sum() / 6
    return bool(abs(signed - domain.volume) <= 1e-10 * abs(domain.volume))


def test_box() -> None:
    box = Domain.box((-1, 0, 2), (2, 1, 4))
    assert box.volume == 6.0 and len(box.facets) == 6
    middle = {
        name: box.points[box.facets[rows[0]]].mean(axis=0).tolist() for name, rows in box.markers.items()
    }
    assert middle == {
        "left": [-1, 0.5, 3], "right": [2, 0.5, 3], "front": [0.5, 0, 3], "back": [0.5, 1, 3],
        "bottom": [0.5, 0.5, 2], "top": [0.5, 0.5, 4],
    }  # fmt: skip
    for row in np.asarray(box.facets):
        a, b, c = box.points[row[:3]]
        assert np.cross(b - a, c - a) @ (a - [0.5, 0.5, 3]) > 0


@pytest.mark.parametrize("size", [3.0, 0.8, 0.31, 0.1])
def test_ball(size: float) -> None:
    ball = Domain.ball(radius=1.5, size=size)
    assert np.abs(np.linalg.norm(ball.points, axis=1) - 1.5).max() <= 2 * np.spacing(1.5)
    assert euler(ball) == 2 and outward(ball)
    found, lengths = angles(triangles_of(ball)), edges(triangles_of(ball))
    assert found.min() > 53.9 and found.max() < 72.1
    assert lengths.max() < 1.36 * lengths.min()
    if size < 1:
        assert 0.85 < lengths.mean() / size < 1.2
        assert 0 < 4 / 3 * pi * 1.5**3 - ball.volume < size**2 * ball.volume


def test_ball_elsewhere() -> None:
    ball = Domain.ball((7, -3, 2), 2.0, regions={"core": (7, -3, 2)})
    assert np.abs(np.linalg.norm(ball.points - [7, -3, 2], axis=1) - 2).max() <= 2 * np.spacing(9.0)
    assert len(ball.facets) == 720 and ball.regions["core"].tolist() == [[7, -3, 2]]
    assert ball.contains([(7, -3, 2), (7, -3, 4.1)]).tolist() == [True, False]


@pytest.mark.parametrize(
    ("radius", "tube", "size"),
    [(1, 0.4, 0.1), (1, 0.9, 0.15), (3, 0.5, 5.0), (1, 0.05, 0.03), (1, 0.4, 0.25)],
)
def test_torus(radius: float, tube: float, size: float) -> None:
    torus = Domain.torus(radius=radius, tube=tube, size=size)
    x, y, z = torus.points.T
    away = np.abs(np.hypot(np.hypot(x, y) - radius, z) - tube)
    assert away.max() <= 2 * np.spacing(float(radius + tube))
    assert euler(torus) == 0 and outward(torus)
    found, lengths = angles(triangles_of(torus)), edges(triangles_of(torus))
    assert found.min() > 38 and found.max() < 96 and found.min(axis=1).mean() > 52
    wanted = min(size, tube)
    assert 0.5 * wanted < lengths.min() and lengths.max() < 1.5 * wanted
    assert 0.9 < lengths.mean() / wanted < 1.1


def test_torus_about_an_axis() -> None:
    torus = Domain.torus((1, 2, 3), 1.0, 0.25, axis=(1, 1, 1))
    away = (torus.points - [1, 2, 3]) @ np.ones(3) / np.sqrt(3)
    assert np.abs(away).max() == pytest.approx(0.25, abs=0.01) and outward(torus)
    assert torus.volume == pytest.approx(2 * pi**2 * 0.25**2, rel=0.02)


@pytest.mark.parametrize(
    ("start", "end", "radius", "size"),
    [
        ((0, 0, 0), (0, 0, 1), 0.5, 0.1),
        ((0, 0, 0), (0, 0, -3), 0.5, 0.21),
        ((1, 2, 3), (1, 5, 3), 1.0, 0.3),
        ((0, 0, 0), (1, 2, 2), 0.7, 0.2),
        ((0, 0, 0), (10, 0, 0), 0.2, 5.0),
    ],
)
def test_cylinder(start: tuple, end: tuple, radius: float, size: float) -> None:
    body = Domain.cylinder(start, end, radius, size)
    assert list(body.markers) == ["side", "bottom", "top"] and euler(body) == 2 and outward(body)
    low, high = np.array(start, dtype=float), np.array(end, dtype=float)
    axis = (high - low) / np.linalg.norm(high - low)
    rows = {name: np.asarray(body.facets)[pieces] for name, pieces in body.markers.items()}
    side = np.unique(rows["side"])
    from_axis = np.linalg.norm(np.cross(body.points - low, axis), axis=1)
    largest = np.abs(body.points).max()
    assert np.abs(from_axis[side] - radius).max() <= 4 * np.spacing(largest)
    along = (body.points - low) @ axis
    assert np.abs(along[np.unique(rows["bottom"])]).max() <= 4 * np.spacing(largest)
    assert np.abs(along[np.unique(rows["top"])] - along.max()).max() <= 4 * np.spacing(largest)
    found = angles(triangles_of(body))
    assert found.min() > 37 and found[body.markers["side"]].min() > 48
    assert body.volume == pytest.approx(pi * radius**2 * np.linalg.norm(high - low), rel=0.2)


def test_a_flat_cylinder_and_one_around_an_axis_are_exact() -> None:
    flat = Domain.cylinder((0, 0, 0), (0, 0, 0.01), 1.0, 0.2)
    assert len(np.unique(flat.points[:, 2])) == 2
    assert {(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)} <= {
        tuple(x) for x in Domain.cylinder((0, 0, 0), (0, 0, 1), 1.0, pi / 16).points[:, :2].tolist()
    }


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: Domain.box((0, 0, 0), (1, 0, 1)), "must be less than upper"),
        (lambda: Domain.box((0, 0), (1, 1)), "lower must be three coordinates"),
        (lambda: Domain.box(None), "lower must be three coordinates"),
        (lambda: Domain.ball(radius=-1), "radius = -1"),
        (lambda: Domain.ball(size=0), "size = 0"),
        (lambda: Domain.ball(size=1e-9), "would make .* points; give a larger size"),
        (lambda: Domain.ball(size=1e-320), "give a larger size"),
        (lambda: Domain.ball((0, np.nan, 0)), r"center\[0\]"),
        (lambda: Domain.ball(curves={0: 1}), "curves are for planar domains"),
        (lambda: Domain.torus(tube=1.0), "tube = 1 must be less than radius = 1"),
        (lambda: Domain.torus(axis=(0, 0, 0)), "axis has no direction"),
        (lambda: Domain.torus(size="a"), "size must be a number"),
        (lambda: Domain.cylinder((1, 1, 1), (1, 1, 1)), "the axis from start to end has no direction"),
        (lambda: Domain.cylinder(size=1e-7), "give a larger size"),
        (
            lambda: Domain.torus(tube=1e-3),
            "the default size, 0.0002, would make 1.14e.06 points.* give a size",
        ),
        (lambda: Domain.torus(tube=1e-30), "the default size"),
        (lambda: Domain.cylinder(radius=1e-4), "the default size, 2e-05, would make"),
    ],
)
def test_bad_arguments(make: object, told: str) -> None:
    with pytest.raises(InputError, match=told):
        make()


@pytest.mark.parametrize("scale", [1e-150, 1e-3, 1e6, 1e150])
def test_units(scale: float) -> None:
    for make in (Domain.ball, Domain.torus, Domain.cylinder):
        one, size = make().volume, {"radius": scale}
        if make == Domain.torus:
            size["tube"] = 0.4 * scale
        if make == Domain.cylinder:
            size = {"radius": 0.5 * scale, "end": (0, 0, scale)}
        body = make(**size)
        if 1e-90 < scale < 1e90:
            assert body.volume == pytest.approx(one * scale**3, rel=1e-9)


def test_inner_pieces_are_added() -> None:
    box = Domain.box(inner=[(0, 7)], markers={"diagonal": [6]})
    assert box.inner[0].tolist() == [0, 7] and box.markers["diagonal"].tolist() == [6]
    with pytest.raises(UnstructError, match="have the same points"):
        Domain.box(inner=[(0, 1, 3)])
