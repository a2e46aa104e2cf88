"""Smooth rings with corners, against SciPy's splines."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from unstruct import Domain, InputError, check, refine
from unstruct.domain.plane.sections import section_parts

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]


def section(n: int = 40) -> np.ndarray:
    """Points of a symmetric airfoil, from the trailing edge along the upper side and back; it is sharp."""
    turn = np.linspace(0, 2 * np.pi, n, endpoint=False)
    x = (1 + np.cos(turn)) / 2
    half = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    return np.column_stack([x, np.where(turn <= np.pi, half, -half)])


def star(n: int, seed: int) -> np.ndarray:
    """A ring around the origin with uneven angles and radii."""
    random = np.random.default_rng(seed)
    turn = 2 * np.pi * (np.arange(n) + random.uniform(-0.2, 0.2, n)) / n
    return np.column_stack([np.cos(turn), np.sin(turn)]) * random.uniform(0.9, 1.1, n)[:, None]


def scipy_spline(points: np.ndarray, ends: str) -> CubicSpline:
    knots = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
    return CubicSpline(knots, points, bc_type=ends)


@settings(deadline=None, max_examples=60)
@given(st.integers(6, 14), st.integers(0, 10**6), st.sets(st.integers(0, 5), max_size=5))
def test_every_stretch_is_the_natural_spline(n: int, seed: int, corners: set[int]) -> None:
    ring = star(n, seed)
    domain = Domain.smooth(ring, corners=sorted(corners), resolve=False)
    here = sorted(corners) or [0]
    for first, last in zip(here, [*here[1:], here[0] + n]):
        along = np.arange(first, last + 1) % n
        if corners and len(along) == 2:
            assert int(first) not in domain.curves, "a stretch of one edge is straight"
            continue
        spline = scipy_spline(ring[along], "natural" if corners else "periodic")
        for i, row in enumerate(along[:-1].tolist()):
            t = np.linspace(0, 1, 5)
            expected = spline(spline.x[i] + t * (spline.x[i + 1] - spline.x[i]))
            assert np.allclose(domain.at(row, t), expected, rtol=0, atol=1e-12)


def turn(domain: Domain, before: int, after: int) -> float:
    """The angle in degrees by which the direction changes from the end of a piece to the start of another."""
    one, two = (
        np.diff(domain.at(before, [1 - 1e-6, 1]), axis=0)[0],
        np.diff(domain.at(after, [0, 1e-6]), axis=0)[0],
    )
    return abs(float(np.degrees(np.arctan2(one[0] * two[1] - one[1] * two[0], one @ two))))


def test_a_trailing_edge() -> None:
    ring = section()
    for domain in (Domain.smooth(ring, corners=[0]), Domain.smooth(ring, corner_angle=60)):
        assert len(domain.curves) == len(ring)
        assert 140 < turn(domain, len(ring) - 1, 0) < 170
        assert all(turn(domain, i - 1, i) < 0.01 for i in range(1, len(ring)))
        mesh = refine(domain, 0.05)
        assert check(mesh, domain=domain)
    assert turn(Domain.smooth(ring), len(ring) - 1, 0) < 0.01, "without a corner it is rounded"


def test_a_section_read_from_a_file_is_the_same_curve() -> None:
    """The reader of airfoils has one piece for each side; a ring with a corner has one for each point."""
    ring = section()
    parts = section_parts(np.vstack([ring, ring[:1]]), "spline")
    domain = Domain.smooth(ring, corners=[0])
    nose = len(ring) // 2
    for k, curve in parts["curves"].items():
        rows = range(nose) if k == 0 else range(nose, len(ring))
        lengths = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)[list(rows)]
        knots = np.append(0.0, np.cumsum(lengths)) / lengths.sum()
        for i, row in enumerate(rows):
            t = np.linspace(0, 1, 4)
            theirs = curve.point(knots[i] + t * (knots[i + 1] - knots[i]))
            assert np.allclose(domain.at(row, t), theirs, rtol=0, atol=1e-12)


def test_corners_by_angle() -> None:
    ring = [(0, 0), (2, -0.2), (4, 0), (4.2, 2), (4, 4), (2, 4.2), (0, 4), (-0.2, 2)]  # a cushion
    assert len(Domain.smooth(ring, corner_angle=100).curves) == 8
    cushion = Domain.smooth(ring, corner_angle=60)
    for vertex in range(8):
        ends = [cushion.at(vertex - 1 if vertex else 7, [1 - 1e-7, 1]), cushion.at(vertex, [0, 1e-7])]
        along = [np.diff(x, axis=0)[0] / np.linalg.norm(np.diff(x, axis=0)) for x in ends]
        assert (along[0] @ along[1] < 0.9) == (vertex % 2 == 0)
    both = Domain.smooth(ring, corners=[1], corner_angle=60)
    assert set(both.curves) == {2, 3, 4, 5, 6, 7}, "straight where two corners follow each other"
    assert not Domain.smooth(SQUARE, corner_angle=45).curves
    assert Domain.smooth(SQUARE, corner_angle=45).area == 16


def test_corners_are_numbered_along_all_rings() -> None:
    hole = np.array([(1, 1), (2, 1), (2.3, 1.5), (2, 2), (1, 2)])
    domain = Domain.smooth(
        SQUARE, [hole, np.add(hole[:3], (0.3, 1.6))], corners=[0, 1, 2, 3, 6], resolve=False
    )
    assert set(domain.curves) == set(range(4, 12))
    assert check(refine(domain, 0.5), domain=domain)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"corners": [4]}, r"vertex 4: there are vertices 0\.\.3"),
        ({"corners": [-1]}, "vertex -1"),
        ({"corners": [0.5]}, "corner_angle"),
        ({"corners": [[0], [1, 2]]}, "list of vertex numbers"),
        ({"corner_angle": 0}, "between 0 and 180"),
        ({"corner_angle": "sharp"}, "corner_angle must be a number"),
        ({"corner_angle": float("nan")}, "between 0 and 180"),
    ],
)
def test_wrong_corners(options: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Domain.smooth(SQUARE, **options)
