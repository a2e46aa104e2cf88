"""Hard inputs, by name, shared by all tests (``from fixtures import lattice2``).

Every function returns a fresh float64 array, the same on each call. ``HARD_2D`` and ``HARD_3D`` hold
point sets that span their space, so that each must be triangulated; ``FLAT`` holds sets that do not,
with the dimension of their affine hull; ``LEDGER`` holds the named counterexamples of the claims ledger.
"""

from __future__ import annotations

from itertools import permutations, product

import numpy as np

__all__ = [
    "FLAT",
    "HARD_2D",
    "HARD_3D",
    "LEDGER",
    "all_equal",
    "circle_integer",
    "clustered",
    "collinear",
    "coplanar",
    "cross_polytope",
    "cube",
    "duplicates",
    "last_bit_neighbors",
    "lattice2",
    "lattice3",
    "moment_curve",
    "nearly_collinear",
    "offset_1e8",
    "permutohedron",
    "simplex_corner",
    "sphere_integer",
    "uniform",
    "wide_exponents",
]


def uniform(n: int = 200, d: int = 2, seed: int = 0) -> np.ndarray:
    """Random points of the unit cube: generic input."""
    return np.random.default_rng(seed).random((n, d))


def clustered(n: int = 200, d: int = 2, seed: int = 0) -> np.ndarray:
    """Tight clouds (widths from 1 to 1e-6) round random centers: steps of very unequal length."""
    rng = np.random.default_rng(seed)
    centers = rng.random((8, d))
    widths = 10.0 ** rng.uniform(-6, 0, size=(n, 1))
    return centers[rng.integers(8, size=n)] + widths * rng.standard_normal((n, d))


def lattice2(nx: int = 6, ny: int = 5) -> np.ndarray:
    """Integer points of the plane: every unit square is a tie, most hull points are collinear."""
    return np.array(list(product(range(nx), range(ny))), dtype=float)


def lattice3(nx: int = 4, ny: int = 3, nz: int = 3) -> np.ndarray:
    """Integer points of space: every unit cube is a tie of eight points."""
    return np.array(list(product(range(nx), range(ny), range(nz))), dtype=float)


def circle_integer(radius2: int = 4225) -> np.ndarray:
    """All integer points with x² + y² = ``radius2`` (4225 = 65²: 36 exactly cocircular points)."""
    r = int(radius2**0.5) + 1
    return np.array(
        [(x, y) for x in range(-r, r + 1) for y in range(-r, r + 1) if x * x + y * y == radius2], dtype=float
    )


def sphere_integer(radius2: int = 9) -> np.ndarray:
    """All integer points with x² + y² + z² = ``radius2`` (9: 30 exactly cospherical points)."""
    r = int(radius2**0.5) + 1
    box = range(-r, r + 1)
    return np.array([p for p in product(box, box, box) if sum(c * c for c in p) == radius2], dtype=float)


def cube(d: int = 3) -> np.ndarray:
    """The 2^d corners of the unit cube: one tie."""
    return np.array(list(product((0.0, 1.0), repeat=d)))


def cross_polytope(d: int = 3) -> np.ndarray:
    """The points ±e_i and the origin: a tie whose center is itself a site (unique triangulation)."""
    return np.vstack([np.eye(d), -np.eye(d), np.zeros((1, d))])


def simplex_corner(d: int = 2) -> np.ndarray:
    """The origin and the unit vectors: the smallest input that spans."""
    return np.vstack([np.zeros((1, d)), np.eye(d)])


def offset_1e8(d: int = 2) -> np.ndarray:
    """A lattice of spacing 1e-6 at an offset of 1e8: 26 leading bits in common, ties spoiled by rounding."""
    side = 6 if d == 2 else 4
    return 1e8 + 1e-6 * np.array(list(product(range(side), repeat=d)), dtype=float)


def last_bit_neighbors(d: int = 2) -> np.ndarray:
    """Points one last bit apart about (1/2, …, 1/2), and far points on the diagonal of the space."""
    side = 5 if d == 2 else 3
    near = 0.5 + np.array(list(product(range(side), repeat=d)), dtype=float) * 2.0**-53
    far = np.outer([12.0, 24.0, 18.0], np.ones(d))
    far[2, 0] = np.nextafter(18.0, 19.0)
    return np.vstack([near, far])


def nearly_collinear(d: int = 2) -> np.ndarray:
    """Multiples of (0.1, …, 0.1, 0.3) as rounded in floating point, and d points off that line."""
    t = np.arange(1, 25, dtype=float)
    line = np.column_stack([t * 0.1] * (d - 1) + [t * 0.3])
    off = 5.0 * np.eye(d)
    return np.vstack([line, off])


def wide_exponents(d: int = 2, reach: int = 60) -> np.ndarray:
    """Coordinates from 2^-reach to 2^reach, of both signs, and the origin."""
    rng = np.random.default_rng(7)
    exponents = rng.integers(-reach, reach + 1, size=(24, d))
    points = np.ldexp(rng.choice([-1.0, 1.0], size=(24, d)), exponents)
    extremes = np.ldexp(np.vstack([np.eye(d), -np.eye(d)]), reach)
    return np.vstack([points, extremes, np.zeros((1, d)), np.ldexp(np.eye(d), -reach)])


def collinear(n: int = 6, d: int = 2) -> np.ndarray:
    """Exactly collinear points, in no order along their line."""
    order = np.argsort([(7 * i) % n for i in range(n)], kind="stable")
    return np.outer(order, np.arange(1, d + 1)).astype(float) + 3.0


def coplanar(n: int = 4) -> np.ndarray:
    """An n × n lattice of the plane z = x + 2y + 1 in space."""
    xy = np.array(list(product(range(n), range(n))), dtype=float)
    return np.column_stack([xy, xy[:, 0] + 2 * xy[:, 1] + 1])


def all_equal(n: int = 5, d: int = 2) -> np.ndarray:
    """One point, n times."""
    return np.full((n, d), 0.1)


def duplicates(d: int = 2) -> np.ndarray:
    """Twelve random points; points 0, 3 and 3 come again as 12, 13, 14; 0.0 and -0.0 as 15 and 16."""
    points = uniform(12, d, seed=3)
    zeros = np.zeros((2, d))
    zeros[1] = -0.0
    return np.vstack([points, points[[0, 3, 3]], zeros])


def moment_curve(n: int = 9, d: int = 3) -> np.ndarray:
    """Points (i, i², …, i^d): in space their Delaunay triangulation has C(n - 2, 2) tetrahedra."""
    i = np.arange(n, dtype=float)
    return np.column_stack([i**k for k in range(1, d + 1)])


def permutohedron() -> np.ndarray:
    """Truncated octahedron, permutations of (0, ±1, ±2): 24 cospherical points, hull faces of 4 and 6."""
    signs = list(product((1, -1), repeat=3))
    return np.array(
        sorted({tuple(s * c for s, c in zip(sign, p)) for p in permutations((0, 1, 2)) for sign in signs}),
        dtype=float,
    )


def _array(*points: tuple[float, ...]) -> np.ndarray:
    return np.array(points, dtype=float)


# Named by what they refute or show. Each spans its space.
LEDGER = {
    # 12.2: properties of the Delaunay triangulation
    "needle": _array((0, 0), (100, 0), (50, 1)),
    "max_angle_not_minimized": _array((0, 0), (1, 3), (2, 3), (3, 2)),
    "min_angle_not_characteristic": _array((0, 0), (0, 1), (1, 1), (1, 2), (2, 0)),
    "min_dihedral_not_maximized": _array((0, 0, 0), (2, 1, 2), (2, 2, 1), (1, 2, 2), (2, 1, 0)),
    "unique_though_cocircular": _array((1, 0), (0, 1), (-1, 0), (0, -1), (0, 0)),
    "acute_but_not_delaunay_3d": _array((-3, 3, 0), (-1, -3, 0), (2, 0, 0), (-1, 1, 3), (0, 0, -3)),
    "u_shape": _array(
        (0, 0), (8, 0), (8, 8), (0, 8), (0, -8), (8, -8), (9, -8), (9, 0), (17, -8), (17, 0), (9, 4), (17, 4)
    ),
    "missing_edge": _array((-5, 0), (5, 0), (0, 1), (0, -1)),
    # 12.2.1: Voronoi cells
    "mutual_neighbors_no_simplex": _array((0, 0), (4, 0), (0, 4), (1, 1)),
    "facet_misses_its_edge": _array((0, 0), (0, 1), (1, 2), (3, 2)),
    "unit_square": _array((0, 0), (1, 0), (1, 1), (0, 1)),
    # 12.2.2: incremental techniques
    "smallest_area_face": _array((3, 0, 2), (3, 0, 3), (1, 3, 3), (0, 2, 0), (1, 2, 0)),
    "smallest_longest_edge_face": _array((1, 1, 3), (1, 2, 0), (3, 2, 0), (3, 3, 2), (2, 2, 3)),
    "smallest_perimeter_face": _array((3, 2, 2), (0, 0, 2), (2, 0, 3), (0, 1, 0), (3, 0, 0)),
    "interior_start_edge": _array((0, 0), (4, 0), (4, 4), (0, 4), (2, 1), (2, 2)),
    # 12.2.4: planar methods
    "obtuse": _array((0, 0), (4, 0), (2, 1)),
    "two_centers_in_one_triangle": _array((0, 0), (1, 3), (2, 3), (3, 1)),
    "centers_in_circles": _array((0, 0), (0, 1), (1, 0), (1, 2)),
    "min_angle_of_each": _array((0, 0), (0, 1), (1, 2), (2, 0)),
}

# Sets that must be triangulated exactly: no flat cell, the true hull, all points but copies used.
HARD_2D = {
    "simplex": simplex_corner(2),
    "uniform": uniform(150, 2),
    "clustered": clustered(150, 2),
    "lattice": lattice2(),
    "lattice_column": lattice2(2, 12),
    "circle": circle_integer(),
    "circle_with_center": np.vstack([circle_integer(), np.zeros((1, 2))]),
    "square": cube(2),
    "cross": cross_polytope(2),
    "offset_1e8": offset_1e8(2),
    "last_bit_neighbors": last_bit_neighbors(2),
    "nearly_collinear": nearly_collinear(2),
    "wide_exponents": wide_exponents(2),
    "duplicates": duplicates(2),
    "parabola": moment_curve(20, 2),
    "line_and_one": np.vstack([collinear(12, 2), [[0.0, 1.0]]]),
    "tiny": 2.0**-500 * lattice2(4, 4),
    "huge": 2.0**500 * lattice2(4, 4),
} | {name: points for name, points in LEDGER.items() if points.shape[1] == 2}

HARD_3D = {
    "simplex": simplex_corner(3),
    "uniform": uniform(80, 3),
    "clustered": clustered(80, 3),
    "lattice": lattice3(),
    "sphere": sphere_integer(),
    "sphere_with_center": np.vstack([sphere_integer(), np.zeros((1, 3))]),
    "permutohedron": permutohedron(),
    "cube": cube(3),
    "cross": cross_polytope(3),
    "offset_1e8": offset_1e8(3),
    "last_bit_neighbors": last_bit_neighbors(3),
    "nearly_collinear": nearly_collinear(3),
    "wide_exponents": wide_exponents(3),
    "duplicates": duplicates(3),
    "moment_curve": moment_curve(12, 3),
    "plane_and_one": np.vstack([coplanar(), [[0.0, 0.0, 9.0]]]),
    "line_and_two": np.vstack([collinear(8, 3), [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]]),
    "tiny": 2.0**-300 * lattice3(3, 3, 3),
    "huge": 2.0**300 * lattice3(3, 3, 3),
} | {name: points for name, points in LEDGER.items() if points.shape[1] == 3}

# Sets without a triangulation of full dimension, with the dimension of their affine hull.
FLAT = {
    "equal_2d": (all_equal(5, 2), 0),
    "equal_3d": (all_equal(5, 3), 0),
    "collinear_2d": (collinear(6, 2), 1),
    "collinear_3d": (collinear(6, 3), 1),
    "collinear_huge_2d": (2.0**700 * collinear(6, 2), 1),
    "collinear_tiny_2d": (2.0**-700 * collinear(6, 2), 1),
    "coplanar_3d": (coplanar(), 2),
    "coplanar_offset_3d": (coplanar() + 2.0**40, 2),
    "equal_but_one_2d": (np.vstack([all_equal(4, 2), [[0.2, 0.1]]]), 1),
}
