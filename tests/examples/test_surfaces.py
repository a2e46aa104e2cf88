"""Surfaces of even triangles: closed, oriented, on what they are surfaces of, the same each time."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError, examples


def shape(domain: Domain) -> tuple[np.ndarray, np.ndarray, float]:
    """Edge lengths, angles in degrees, and the volume that facets enclose, positive if they point outward."""
    x = domain.points[np.asarray(domain.facets)]
    length = np.linalg.norm(x - np.roll(x, 1, axis=1), axis=2)
    a, b, c = length.T
    cosine = [(q * q + r * r - p * p) / (2 * q * r) for p, q, r in ((a, b, c), (b, c, a), (c, a, b))]
    volume = (x[:, 0] * np.cross(x[:, 1], x[:, 2])).sum() / 6
    return length, np.degrees(np.arccos(np.clip(cosine, -1, 1))), float(volume)


def turned_alike(domain: Domain) -> bool:
    """Whether each edge has one triangle in either direction."""
    t = np.asarray(domain.facets)
    halves = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    both = np.unique(np.concatenate([halves, halves[:, ::-1]]), axis=0)
    return len(np.unique(halves, axis=0)) == len(halves) == len(both)


@pytest.mark.parametrize("seed", range(4))
def test_merged_bodies(seed: int) -> None:
    body = examples.merged_body(seed)
    domain = examples.level_surface(body, 0.15)
    length, angle, volume = shape(domain)
    assert turned_alike(domain) and angle.min() > 15 and 0.3 < length.min() / 0.15 < length.max() / 0.15 < 2
    x = np.random.default_rng(0).uniform(*body.box, (50_000, 3))
    assert volume == pytest.approx((body(x) > 0).mean() * np.prod(body.box[1] - body.box[0]), rel=0.08)
    assert np.abs(body(domain.points)).max() < 0.01
    assert np.array_equal(domain.points, examples.level_surface(examples.merged_body(seed), 0.15).points)


def test_level_surfaces_of_smooth_bodies() -> None:
    ball = examples.level_surface(examples.sphere(), 0.2)
    _, angle, volume = shape(ball)
    assert angle.min() > 25 and volume == pytest.approx(4 / 3 * np.pi, rel=0.02)
    assert np.abs(np.linalg.norm(ball.points, axis=1) - 1).max() < 1e-9
    rough = examples.level_surface(examples.noisy_ball(2), 0.15, rounds=0)
    fine = examples.level_surface(examples.noisy_ball(2), 0.15)
    assert shape(rough)[1].min() < shape(fine)[1].min()


def test_plane_sides() -> None:
    cube = examples.meshed_sides(Domain.box((-1, -1, -1), (1, 1, 1)), 0.25)
    length, angle, volume = shape(cube)
    assert turned_alike(cube) and angle.min() > 35 and volume == pytest.approx(8, rel=1e-12)
    assert length.max() < 0.5 and set(cube.markers) == set(Domain.box().markers)
    for name, column, end in (("left", 0, -1), ("top", 2, 1)):
        assert (cube.points[np.asarray(cube.facets)[cube.markers[name]]][..., column] == end).all()
    notch = examples.meshed_sides(examples.notched_box(), 0.3)
    assert shape(notch)[2] == pytest.approx(7.2) and turned_alike(notch)
    assert {len(rows) > 0 for rows in notch.markers.values()} == {True}


def test_refused() -> None:
    with pytest.raises(InputError, match="body must be a LevelSet"):
        examples.level_surface(Domain.ball(), 0.2)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="body must be a Domain in space"):
        examples.meshed_sides(Domain.rectangle(), 0.2)
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
    pipe = Domain.extruded(Domain.polygon(square, [0.25 + square / 2]))
    with pytest.raises(InputError, match="facet 8 has holes"):
        examples.meshed_sides(pipe, 0.2)
    with pytest.raises(InputError, match="parts must be at least 1"):
        examples.merged_body(parts=0)
    with pytest.raises(InputError):
        examples.level_surface(examples.noisy_ball(0), -1.0)


def test_scans_are_closed_and_near_the_body() -> None:
    ball = examples.scanned_surface(examples.sphere(), 12, 48, error=0.0)
    domain = Domain.surface(ball)
    assert turned_alike(domain) and ball.size == 2 * 12 * 48 and ball.euler_characteristic == 2
    assert np.abs(np.linalg.norm(ball.points, axis=1) - 1).max() < 1e-12
    assert shape(domain)[2] == pytest.approx(4 / 3 * np.pi, rel=0.03)
    body = examples.noisy_ball(1)
    for slices, around, error in ((24, 96, 1e-4), (1, 3, 0.0)):
        scan = examples.scanned_surface(body, slices, around, error=error)
        assert turned_alike(Domain(scan.points, scan.simplices)) and shape(Domain.surface(scan))[2] > 0
        assert np.abs(body(scan.points)).max() < 10 * error + 1e-9
    again = examples.scanned_surface(body, 24, 96)
    assert np.array_equal(again.points, examples.scanned_surface(body, 24, 96).points)
    assert again.quality("min_angle").min() < 2
    assert not np.array_equal(again.points, examples.scanned_surface(body, 24, 96, seed=1).points)


def test_scans_refused() -> None:
    ball = examples.sphere()
    with pytest.raises(InputError, match="body must be a LevelSet"):
        examples.scanned_surface(Domain.ball())  # type: ignore[arg-type]
    for wrong in ({"slices": 0}, {"around": 2}, {"error": -1.0}):
        with pytest.raises(InputError, match=r"slices = .* must be at least 1"):
            examples.scanned_surface(ball, **wrong)
    with pytest.raises(InputError, match="body must contain the origin"):
        examples.scanned_surface(examples.torus())
