"""Inside, outside and volume of triangles in space, beside rational arithmetic and cells of a grid."""

from __future__ import annotations

import os
import subprocess
import sys
from fractions import Fraction
from itertools import product

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from rational_space import cross, dot, in_triangle, parity, rational

from unstruct.geometry.inside_shell import (
    enclosed_volume,
    even_odd_in_space,
    front_inside,
    triangle_components,
    volumes_to_compare,
)
from unstruct.predicates.batch import power_of_two

NUDGE = 2.0**-52


def cells(filled: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The surface of cells of a grid: points, triangles in any direction, and whether the front is inside.

    Each square between a filled cell and another one is cut along one of its diagonals.
    """
    shape = np.array(filled.shape)
    padded = np.pad(filled, 1)
    number = np.arange(np.prod(shape + 1)).reshape(shape + 1)
    points = np.array(list(product(*(range(k + 1) for k in shape))), dtype=float)
    triangles, front = [], []
    for axis in range(3):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        for cell in product(*(range(k + 1) for k in shape)):
            upper = padded[tuple(np.array(cell) + 1)]
            below = np.array(cell) + 1
            below[axis] -= 1
            if upper == padded[tuple(below)] or cell[i] == shape[i] or cell[j] == shape[j]:
                continue
            ring = [np.array(cell) for _ in range(4)]
            ring[1][i] += 1
            ring[2][i] += 1
            ring[2][j] += 1
            ring[3][j] += 1
            ring = [number[tuple(corner)] for corner in ring]  # its normal points along the axis
            ring = ring[1:] + ring[:1] if rng.random() < 0.5 else ring
            for row in ([ring[0], ring[1], ring[2]], [ring[0], ring[2], ring[3]]):
                turned = rng.random() < 0.5
                row = np.roll(row, rng.integers(3))
                triangles.append(row[::-1] if turned else row)
                front.append(bool(upper) != turned)
    order = rng.permutation(len(triangles))
    used, again = np.unique(np.array(triangles)[order], return_inverse=True)
    return points[used], again.reshape(-1, 3).astype(np.int32), np.array(front)[order]


@st.composite
def bodies(draw: st.DrawFn) -> tuple:
    """Some cells of a 3 x 2 x 2 grid, sheared by integers, which need not be in one piece or manifold."""
    filled = np.array(draw(st.lists(st.booleans(), min_size=12, max_size=12))).reshape(3, 2, 2)
    filled[1, 1, 1] = True
    rng = np.random.default_rng(draw(st.integers(0, 99)))
    points, triangles, front = cells(filled, rng)
    shear = np.array(draw(st.lists(st.integers(-2, 2), min_size=9, max_size=9))).reshape(3, 3)
    det = round(np.linalg.det(shear))
    if det == 0:
        shear, det = np.eye(3, dtype=int), 1
    return points @ shear.T, triangles, front != (det < 0), int(filled.sum()) * abs(det)


@settings(max_examples=60)
@given(bodies(), st.sampled_from([1.0, 2.0**-40, 1e150, 1e-90]))
def test_front_and_volume_of_cells_of_a_grid(body: tuple, scale: float) -> None:
    points, triangles, front, volume = body
    assert (front_inside(points * scale, triangles) == front).all()
    outward = np.where(front[:, None], triangles[:, ::-1], triangles)
    assert enclosed_volume(points, outward) == volume
    assert enclosed_volume(points, outward[:, ::-1]) == -volume
    flat, against, many = triangle_components(outward)
    assert many == flat.max() + 1
    for part in range(many):  # a part may change its side only where more than two triangles meet
        assert len({*against[flat == part].tolist()}) == 1


@settings(max_examples=12)
@given(bodies(), st.integers(0, 999), st.sampled_from([0.25, 0.5, 0.1]))
def test_even_odd_of_rays_through_vertices_and_edges(body: tuple, seed: int, step: float) -> None:
    points, triangles, _, _ = body
    rng = np.random.default_rng(seed)
    low, high = points.min(axis=0), points.max(axis=0)
    x = low + np.round(rng.random((12, 3)) * (high - low) / step) * step
    x[::3] = points[rng.integers(len(points), size=4)] + rng.choice([-1, 1], (4, 3)) * [NUDGE, 0, 0]
    odd, on = even_odd_in_space(points, triangles, x)
    exact = [tuple(rational(points[v].tolist()) for v in row) for row in triangles.tolist()]
    for i, row in enumerate(x.tolist()):
        q = rational(row)
        touches = any(in_triangle(q, *t) for t in exact)
        assert on[i] == touches
        if not touches:
            assert odd[i] == parity(q, exact)


@settings(max_examples=30)
@given(st.integers(0, 10**6), st.sampled_from([1.0, 1e-8, 1e8]))
def test_volume_is_rounded_once(seed: int, spread: float) -> None:
    """A closed surface of random tetrahedra, which may overlap, far from the origin."""
    rng = np.random.default_rng(seed)
    points = rng.standard_normal((12, 3)) * spread + rng.choice([0.0, 1e5])
    triangles = []
    for a, b, c, d in rng.permuted(np.tile(np.arange(12), (5, 1)), axis=1)[:, :4].tolist():
        triangles += [(a, b, c), (a, c, d), (a, d, b), (b, d, c)]
    found = enclosed_volume(points, np.array(triangles))
    exact = [rational(row) for row in points.tolist()]
    total = sum((dot(exact[a], cross(exact[b], exact[c])) for a, b, c in triangles), Fraction(0))
    assert abs(Fraction(found) - total / 6) <= abs(total / 6) * Fraction(2) ** -52


def test_thin_and_nested_shells() -> None:
    """A plate of thickness one last bit; shells in shells take turns."""
    corners = np.array(list(product((0.0, 1.0), repeat=3)))
    rows = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    box = np.array([*rows, (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)])
    thin = corners * [1, 1, NUDGE] + 1
    center = np.array([[1.5, 1.5, 1.0], [1.5, 1.5, 1 + NUDGE], [1.5, 1.5, 1 + 2 * NUDGE]])
    assert even_odd_in_space(thin, box, center)[1].tolist() == [True, True, False]
    assert enclosed_volume(thin, np.where(front_inside(thin, box)[:, None], box[:, ::-1], box)) == NUDGE
    nested = np.concatenate([(corners - 0.5) * s for s in (8, 6, 4, 2)])
    shells = np.concatenate([box + 8 * k for k in range(4)])
    odd, on = even_odd_in_space(nested, shells, np.array([[3.5, 0, 0], [2.5, 0, 0], [1.5, 0, 0], [0, 0, 0]]))
    assert odd.tolist() == [True, False, True, False] and not on.any()
    front = front_inside(nested, shells)
    assert (front[:12] == front[24:36]).all() and (front[:12] != front[12:24]).all()


def test_nothing() -> None:
    none = np.empty((0, 3), dtype=np.int32)
    assert len(front_inside(np.eye(3), none)) == 0
    assert all(not part.any() for part in even_odd_in_space(np.eye(3), none, np.zeros((2, 3))))
    assert triangle_components(none)[2] == 0


PLAIN = """
import sys
sys.path.insert(0, "tests/geometry")
import numpy as np
from test_inside_shell import cells
from unstruct.geometry.inside_shell import even_odd_in_space, front_inside
rng = np.random.default_rng(3)
points, triangles, front = cells(rng.random((2, 2, 2)) < 0.5, rng)
assert (front_inside(points, triangles) == front).all()
print(even_odd_in_space(points, triangles, np.round(rng.random((9, 3)) * 4) / 2))
"""


def test_without_a_compiler_the_same() -> None:
    def run(**switch: str) -> str:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **switch}
        command = [sys.executable, "-c", PLAIN]
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout

    assert run() == run(NUMBA_DISABLE_JIT="1") != ""


@settings(max_examples=15)
@given(bodies(), st.sampled_from([0, -340, -1000, 900]), st.tuples(*[st.integers(-300, 0)] * 3))
def test_volumes_to_compare_keep_signs_and_order(body: tuple, scale: int, stretch: tuple) -> None:
    """Of shells whose volumes are no doubles, or are equal as doubles, in any unit of length."""
    points, triangles, front, _ = body
    outward = np.where(front[:, None], triangles[:, ::-1], triangles)
    points = np.ldexp(points, np.array(stretch) + scale)
    found = volumes_to_compare(points, [outward, outward[:0], outward[:, ::-1]])
    exact = [rational(row) for row in points.tolist()]
    total = sum((dot(exact[a], cross(exact[b], exact[c])) for a, b, c in outward.tolist()), Fraction(0))
    assert total > 0 and found[0] > 0 == found[1] > found[2]
    unit = power_of_two(points)
    assert abs(Fraction(found[0]) - total * Fraction(unit) ** 3) <= Fraction(found[0]) * Fraction(2) ** -50


def test_a_shell_within_another_by_one_last_bit_comes_first() -> None:
    corners = np.array(list(product((0.0, 1.0), repeat=3)))
    rows = [(0, 3, 1), (0, 2, 3), (4, 7, 6), (4, 5, 7), (0, 5, 4), (0, 1, 5)]
    box = np.array([*rows, (2, 7, 3), (2, 6, 7), (0, 6, 2), (0, 4, 6), (1, 7, 5), (1, 3, 7)])
    box = np.where(front_inside(corners, box)[:, None], box[:, ::-1], box)
    within = corners.copy()
    within[7, 0] -= 2.0**-53
    points = np.concatenate([corners, within, corners + 2.0])
    assert enclosed_volume(within, box) == enclosed_volume(corners, box)
    around, inner, apart = volumes_to_compare(points, [box, box + 8, box + 16])
    assert inner < around and isinstance(apart, float)
