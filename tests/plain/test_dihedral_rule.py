"""The angle rule at front edges in space: where it changes, by search; angles and points on known bodies."""

from __future__ import annotations

from itertools import combinations
from math import acos, cos, degrees, radians, sin, sqrt

import numpy as np
import pytest

from unstruct import InputError
from unstruct.plain.advancing_front_space import FrontInSpace, front_of
from unstruct.plain.dihedral_rule import angle_ahead, cells_around, changes_at, point_by_angle


@pytest.mark.parametrize(
    ("best", "expected"),
    [
        (degrees(acos(1 / 3)), [94.04, 169.27, 241.81, 313.46]),
        (60.0, [80.0, 144.0, 205.71, 266.67]),
    ],
)
def test_where_it_changes(best: float, expected: list[float]) -> None:
    """By the formula, and by looking at all angles."""
    assert np.allclose([changes_at(k, best) for k in (1, 2, 3, 4)], expected, atol=0.01)
    for k in (1, 2, 3, 4):
        assert cells_around(changes_at(k, best) - 1e-9, best) == k
        assert cells_around(changes_at(k, best) + 1e-9, best) == k + 1


def wedge(angle: float) -> tuple[FrontInSpace, tuple[int, int, int]]:
    """Two regular triangles at a common edge, with an angle between them ahead of the first one."""
    r, t = sqrt(3) / 2, radians(angle)
    points = [(0, 0, 0), (0, 0, 1), (r, 0, 0.5), (r * cos(t), r * sin(t), 0.5)]
    return front_of(points, [(0, 1, 2), (1, 0, 3)]), (0, 1, 2)


@pytest.mark.parametrize("angle", [10, 60, 94, 95, 169, 170, 200, 300, 359])
def test_a_wedge(angle: float) -> None:
    """The angle; what is connected; the point halves the angle, at distance 1 from both ends."""
    front, face = wedge(angle)
    found, v = angle_ahead(front, face, 2)
    assert np.isclose(found, angle) and v == 3
    front.faces |= {(0, 2, 9): 0, (1, 9, 2): 0}  # the other two edges have room
    front.points += [(0.0, 0.0, 0.0)] * 5 + [(2.0, -1e-3, 0.5)]
    x, connected = point_by_angle(front, face, lambda place: 1.0)
    assert connected == (3 if angle <= 94 else None)
    assert (x is None) == (angle <= 94 or angle >= 170)
    if x is not None:
        assert np.allclose([np.linalg.norm(x), np.linalg.norm(np.subtract(x, (0, 0, 1)))], 1)
        assert np.isclose(degrees(np.arctan2(x[1], x[0])), angle / 2)


def test_the_edge_of_an_inner_facet() -> None:
    """Both sides of one triangle: the whole angle is ahead."""
    front = front_of([(0, 0, 0), (0, 0, 1), (1, 0, 0)], [(0, 1, 2), (0, 2, 1)])
    assert angle_ahead(front, (0, 1, 2), 0) == (360.0, 0)


def test_a_regular_tetrahedron() -> None:
    points = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
    for face in combinations(range(4), 3):
        inward = [f for f in ((0, 1, 2), (1, 0, 3), (2, 1, 3), (0, 2, 3)) if set(f) == set(face)]
        front = front_of(points, [(0, 1, 2), (1, 0, 3), (2, 1, 3), (0, 2, 3)])
        if np.linalg.det(np.subtract(points[1:], points[0])) < 0:
            front = front_of(points, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])
            inward = [f for f in front.faces if set(f) == set(face)]
        for k in range(3):
            assert np.isclose(
                angle_ahead(front, min(front.faces, key=lambda f: f != inward[0]), k)[0], 70.5288
            )


def test_wrong_angles() -> None:
    with pytest.raises(InputError, match="360"):
        cells_around(0.0)
