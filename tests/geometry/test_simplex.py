"""Measures of simplices against rational arithmetic, closed forms, and invariance."""

from fractions import Fraction
from itertools import combinations, permutations
from math import acos, degrees, factorial, inf, pi, sqrt

import numpy as np
import pytest
import sympy
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from unstruct import InputError, simplex

EQUILATERAL = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, sqrt(3) / 2]])
REGULAR = np.array([[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]])
FLAT = {
    "all equal": np.zeros((3, 2)),
    "collinear": np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]),
    "two equal": np.array([[0.0, 0.0], [0.0, 0.0], [2.0, 1.0]]),
    "coplanar": np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0]]),
    "tetrahedron of equal points": np.ones((4, 3)),
    "collinear in space": np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0], [2.0, 4.0, 6.0]]),
}


def integer_simplices(d, size=60):
    row = st.lists(st.integers(-size, size), min_size=d, max_size=d)
    return st.lists(row, min_size=d + 1, max_size=d + 1)


def exact_determinant(rows):
    """By the definition: a sum over permutations."""
    total = Fraction(0)
    for p in permutations(range(len(rows))):
        sign = (-1) ** sum(p[i] > p[j] for i, j in combinations(range(len(p)), 2))
        term = Fraction(sign)
        for i, j in enumerate(p):
            term *= rows[i][j]
        total += term
    return total


def exact_center(corners):
    """Cramer's rule for 2 (p_i - p_0) . c = |p_i|^2 - |p_0|^2."""
    corners = [[Fraction(x) for x in row] for row in corners]
    first, *others = corners
    matrix = [[2 * (x - y) for x, y in zip(row, first)] for row in others]
    right = [sum(x * x for x in row) - sum(x * x for x in first) for row in others]
    below = exact_determinant(matrix)
    center = []
    for column in range(len(first)):
        replaced = [
            [right[i] if j == column else x for j, x in enumerate(row)] for i, row in enumerate(matrix)
        ]
        center.append(exact_determinant(replaced) / below)
    return center


@pytest.mark.parametrize("d", [1, 2, 3, 4])
@given(data=st.data())
@settings(deadline=None, max_examples=40)
def test_volume_and_circumsphere_against_fractions(d, data):
    corners = data.draw(integer_simplices(d))
    rows = [[Fraction(x - y) for x, y in zip(row, corners[0])] for row in corners[1:]]
    determinant = exact_determinant(rows)
    assert simplex.volume(corners) == pytest.approx(float(determinant) / factorial(d), rel=1e-12, abs=1e-9)
    assume(determinant != 0)
    center = exact_center(corners)
    square = float(sum((x - y) ** 2 for x, y in zip(center, corners[0])))
    assume(square < 1e8)
    assert simplex.circumradius(corners) == pytest.approx(sqrt(square), rel=1e-9)
    assert simplex.circumcenter(corners) == pytest.approx([float(x) for x in center], rel=1e-8, abs=1e-7)


@given(integer_simplices(2))
@settings(deadline=None, max_examples=60)
def test_triangle_against_sympy_free_closed_forms(corners):
    """Heron for area and radii, the law of cosines for angles: exact lengths squared, other formulas."""
    a2, b2, c2 = (
        sum((x - y) ** 2 for x, y in zip(corners[i], corners[j])) for i, j in ((1, 2), (2, 0), (0, 1))
    )
    sixteen = 2 * (a2 * b2 + b2 * c2 + c2 * a2) - a2 * a2 - b2 * b2 - c2 * c2
    assume(sixteen > 0)
    area, a, b, c = sqrt(sixteen) / 4, sqrt(a2), sqrt(b2), sqrt(c2)
    assert simplex.inradius(corners) == pytest.approx(2 * area / (a + b + c))
    assert simplex.circumradius(corners) == pytest.approx(a * b * c / (4 * area))
    wanted = [
        acos(max(-1.0, min(1.0, x)))
        for x in (
            (b2 + c2 - a2) / (2 * b * c),
            (c2 + a2 - b2) / (2 * c * a),
            (a2 + b2 - c2) / (2 * a * b),
        )
    ]
    assert simplex.angles(corners) == pytest.approx(wanted, abs=1e-6)
    assert simplex.angles(corners).sum() == pytest.approx(pi, abs=1e-12)
    assert simplex.dihedral_angles(corners) == pytest.approx(simplex.angles(corners)[::-1], abs=1e-9)


def test_right_triangle_and_corner_tetrahedron_by_sympy():
    """A 3-4-5 triangle, and the corner of a cube with edges 1, 2, 3: exact values by sympy."""
    triangle = [[0, 0], [3, 0], [0, 4]]
    assert simplex.circumradius(triangle) == pytest.approx(2.5, rel=1e-15)
    assert simplex.inradius(triangle) == pytest.approx(1, rel=1e-15)
    assert simplex.quality("radius_ratio", triangle) == pytest.approx(2.5, rel=1e-15)
    corner = [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]]
    edges = [sympy.Matrix(p) for p in ((1, 0, 0), (0, 2, 0), (0, 0, 3))]
    volume = sympy.Matrix.hstack(*edges).det() / 6
    slant = (edges[1] - edges[0]).cross(edges[2] - edges[0]).norm() / 2
    surface = slant + 1 + sympy.Rational(3, 2) + 3
    assert simplex.volume(corner) == pytest.approx(float(volume), rel=1e-15)
    assert simplex.inradius(corner) == pytest.approx(float(3 * volume / surface), rel=1e-15)
    assert simplex.circumradius(corner) == pytest.approx(float(sympy.sqrt(14) / 2), rel=1e-15)
    assert simplex.solid_angles(corner)[0] == pytest.approx(pi / 2, rel=1e-14)
    # Girard: a solid angle is the sum of the dihedral angles at the corner less pi.
    dihedral = dict(zip(combinations(range(4), 2), simplex.dihedral_angles(corner)))
    for v in range(4):
        at_corner = [angle for (i, j), angle in dihedral.items() if v not in (i, j)]
        assert simplex.solid_angles(corner)[v] == pytest.approx(sum(at_corner) - pi, rel=1e-12)


def test_regular_simplices_are_perfect():
    assert simplex.quality("2r/R", EQUILATERAL) == pytest.approx(1, rel=1e-14)
    assert simplex.quality("2r/R", REGULAR) == pytest.approx(1, rel=1e-14)
    assert simplex.quality("radius_ratio", EQUILATERAL) == pytest.approx(2, rel=1e-14)
    assert simplex.quality("radius_ratio", REGULAR) == pytest.approx(3, rel=1e-14)
    assert simplex.quality("radius_edge", EQUILATERAL) == pytest.approx(1 / sqrt(3), rel=1e-14)
    assert simplex.quality("radius_edge", REGULAR) == pytest.approx(sqrt(3 / 8), rel=1e-14)
    assert simplex.quality("aspect", REGULAR) == pytest.approx(1, rel=1e-14)
    assert simplex.quality("min_dihedral", REGULAR) == pytest.approx(degrees(acos(1 / 3)), rel=1e-12)
    for d in (4, 5):
        corners = np.vstack([np.eye(d), np.full(d, (1 + sqrt(d + 1)) / d)])
        for name in ("2r/R", "aspect"):
            assert simplex.quality(name, corners) == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("name", FLAT)
@pytest.mark.filterwarnings("error")
def test_flat_simplices_have_limits_and_no_warnings(name):
    flat = FLAT[name]
    assert simplex.measure(flat) == 0
    assert simplex.inradius(flat) == 0
    assert simplex.circumradius(flat) == inf
    assert np.isnan(simplex.circumcenter(flat)).all()
    assert simplex.quality("2r/R", flat) == 0
    for quality in ("radius_ratio", "radius_edge", "aspect"):
        assert simplex.quality(quality, flat) == inf
    for quality in simplex.QUALITIES:
        simplex.quality(quality, flat)


def test_collinear_triangle_has_angles_zero_and_pi():
    assert simplex.angles(FLAT["collinear"]).tolist() == [0, pi, 0]


@pytest.mark.parametrize("scale", [2.0**-1000, 2.0**-200, 2.0**300, 2.0**1000])
@pytest.mark.parametrize("corners", [EQUILATERAL, REGULAR], ids=["triangle", "tetrahedron"])
@pytest.mark.filterwarnings("error")
def test_tiny_and_huge_ones_keep_all_figures(scale, corners):
    for name, function in simplex.QUALITIES.items():
        assert function(corners * scale) == function(corners), name
    assert simplex.circumradius(corners * scale) == simplex.circumradius(corners) * scale
    assert simplex.inradius(corners * scale) == simplex.inradius(corners) * scale


def test_the_largest_doubles_do_not_overflow():
    big = np.array([[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]]) * 1.5e308
    assert simplex.quality("min_angle", big) == pytest.approx(simplex.quality("min_angle", big / 2**10))
    assert simplex.inradius(big) == pytest.approx(simplex.inradius(big / 2**10) * 2**10)


WIDE = {  # one edge vanishes beside the others: from which corner one looks must not matter
    "short edge": [
        [1.9427882136218634e-170, -2.0],
        [2.3755993464796328e-09, 0.0],
        [8.01652379184349e-176, -2.0],
    ],
    "short edge at the end": [[2.0, 2.8116205812066204e-194], [-1.0059229919734227, 1.0], [2.0, 0.0]],
    "short and far": [[1e-200, 3e-200], [1.0, 0.0], [0.0, 0.0]],
}


@pytest.mark.parametrize("name", WIDE)
@pytest.mark.filterwarnings("error")
def test_exponents_too_wide_for_squares(name):
    """Found by fuzzing: circumradii were 0 or infinite, lengths 0 and angles nan."""
    exact = np.array(WIDE[name])
    (ax, ay), (bx, by), (cx, cy) = ([Fraction(x) for x in row] for row in WIDE[name])
    squares = [
        (bx - ax) ** 2 + (by - ay) ** 2,
        (cx - ax) ** 2 + (cy - ay) ** 2,
        (cx - bx) ** 2 + (cy - by) ** 2,
    ]
    twice = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    scale = Fraction(2) ** 1200  # no double has such roots
    length = [
        sqrt(x) if x > 1e-200 else float(Fraction(sqrt(x * scale)) / Fraction(2) ** 600) for x in squares
    ]
    radius2 = squares[0] * squares[1] * squares[2] / (4 * twice * twice)
    for turn in permutations(range(3)):
        corners = exact[list(turn)]
        assert simplex.circumradius(corners) == pytest.approx(sqrt(radius2), rel=1e-12)
        assert np.sort(simplex.edge_lengths(corners)) == pytest.approx(np.sort(length), rel=1e-15, abs=0)
        assert simplex.angles(corners).sum() == pytest.approx(pi, rel=1e-12)
        assert not np.isnan([f(corners) for f in simplex.QUALITIES.values()]).any()
    many = simplex.circumradius(np.stack([exact, EQUILATERAL, np.zeros((3, 2))]))
    assert many == pytest.approx([sqrt(radius2), 1 / sqrt(3), inf])


def test_needle_angles_are_accurate():
    """An angle of 1e-9: arccos of a cosine would return 0."""
    needle = [[0.0, 0.0], [1.0, 0.0], [1.0, 1e-9]]
    assert simplex.angles(needle)[0] == pytest.approx(1e-9, rel=1e-12)
    assert simplex.circumradius(needle) == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize("shape", [(3, 3), (3, 5), (2, 4), (4, 6)])
def test_embedded_simplices_are_measured_as_in_their_own_space(shape):
    """Isometric copies in more dimensions have the same measures."""
    rng = np.random.default_rng(3)
    corners, d = shape
    k = corners - 1
    flat = rng.random((50, corners, k))
    frame = np.linalg.qr(rng.standard_normal((d, d)))[0][:k]
    lifted = flat @ frame + rng.random(d)
    for function in (simplex.measure, simplex.circumradius, simplex.inradius):
        assert function(lifted) == pytest.approx(function(flat), rel=1e-8)
    assert simplex.circumcenter(lifted) == pytest.approx(
        simplex.circumcenter(flat) @ frame + (lifted[0, 0] - flat[0, 0] @ frame), rel=1e-6, abs=1e-6
    )
    if k >= 2:
        assert simplex.dihedral_angles(lifted) == pytest.approx(simplex.dihedral_angles(flat), rel=1e-8)


def test_vectorized_over_leading_axes():
    block = np.random.default_rng(1).random((2, 3, 4, 3))
    for name in simplex.QUALITIES:
        together = simplex.quality(name, block)
        assert together.shape == (2, 3)
        for i, j in np.ndindex(2, 3):
            assert together[i, j] == pytest.approx(simplex.quality(name, block[i, j]), rel=1e-12)
    assert simplex.solid_angles(block).shape == (2, 3, 4)
    assert simplex.edge_lengths(block).shape == (2, 3, 6)
    assert simplex.angles(block).shape == (2, 3, 4, 3)
    assert simplex.quality("2r/R", np.empty((0, 3, 2))).shape == (0,)


def test_solid_angles_of_a_tetrahedralized_cube_sum_to_its_corner_angles():
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    around = np.zeros(8)
    for p in permutations(range(3)):
        path = [0]
        for axis in p:
            path.append(path[-1] + (4 >> axis))
        np.add.at(around, path, simplex.solid_angles(cube[path]))
    assert around == pytest.approx(np.full(8, pi / 2), rel=1e-12)


def test_euler_inequality_on_random_triangles():
    """R >= 2r (Euler): 2r/R never exceeds 1."""
    ratio = simplex.quality("2r/R", np.random.default_rng(2).random((2000, 3, 2)))
    assert (ratio > 0).all() and (ratio <= 1).all()


def test_errors_name_shape_and_names():
    with pytest.raises(InputError, match="points\\[cells\\]"):
        simplex.volume(np.zeros((4, 2)))
    with pytest.raises(InputError, match=r"'nice'.*min_angle"):
        simplex.quality("nice", EQUILATERAL)
    with pytest.raises(InputError, match="segments have no angles"):
        simplex.angles(np.zeros((2, 2)))
    with pytest.raises(InputError, match="no dihedral"):
        simplex.dihedral_angles(np.zeros((2, 2)))
    with pytest.raises(InputError, match="tetrahedra"):
        simplex.solid_angles(EQUILATERAL)
