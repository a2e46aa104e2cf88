"""Bodies with good surfaces for the suite ``volume``: round, gridded, implicit by formulas and by seeds.

An implicit surface is sampled evenly and triangulated by the Delaunay tetrahedra of its samples: those whose
circumcenter is inside are the inside, and its triangles are the faces between inside and outside. For samples
that are dense this is the restricted Delaunay triangulation (N. Amenta, M. Bern, *Surface reconstruction by
Voronoi filtering*, 1999). A few rounds of moving each sample to the mean of its triangles make them even.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Function = Callable[[Array], Array]  # negative inside
Size = float | Callable[[Array], Array]
Sized = tuple[Any, Any, str]  # a body, a size, and its formula as text
NEWTON_STEPS = 6
THINNED = 0.81  # how near samples may be to each other; unit: the wanted edge length
EVEN_ROUNDS = 12
STEEPEST = 1.5  # gradients of the functions below are not longer
DIFFERENCE = 1e-5  # for gradients


# ---------------------------------------------------------------------- implicit surfaces


def noisy(seed: int) -> Function:
    """A ball whose radius is a sum of waves by seed."""
    rng = np.random.default_rng(seed)
    waves = 2.6 * rng.normal(size=(8, 3))
    phase = 2 * np.pi * rng.random(8)
    height = 0.07 + 0.05 * rng.random(8)

    def function(x: Array) -> Array:
        radius = np.linalg.norm(x, axis=1)
        unit = x / np.maximum(radius, 1e-9)[:, None]
        return radius - 1.0 - np.sin(unit @ waves.T + phase) @ height

    return function


def bone(x: Array) -> Array:
    """Two pairs of knobs, joined by a shaft that is thinner in the middle."""
    knobs = [(s * 1.25, t * 0.32, 0.06 * t, 0.42) for s in (-1, 1) for t in (-1, 1)]
    distances = [np.linalg.norm(x - knob[:3], axis=1) - knob[3] for knob in knobs]
    along = np.clip(x[:, 0], -1.2, 1.2)
    shaft = np.hypot(np.hypot(x[:, 0] - along, x[:, 1]), x[:, 2]) - (0.26 + 0.05 * along**2)
    return _blended([*distances, shaft], 0.12)


def tee(x: Array) -> Array:
    """A pipe with a branch, both hollow and closed at their ends by rounded walls."""
    run = np.hypot(x[:, 1], x[:, 2]) - 0.5
    branch = np.where(x[:, 2] > 0, np.hypot(x[:, 0], x[:, 1]), np.linalg.norm(x, axis=1)) - 0.4
    outer = _blended([run, branch], 0.08)
    bore = _blended([run + 0.22, branch + 0.2], 0.05)
    ends = _united([x[:, 0] - 1.3, -x[:, 0] - 1.3, x[:, 2] - 1.2], 0.03)
    return _united([outer, -bore, ends], 0.03)


def _blended(distances: list[Array], width: float) -> Array:
    """A smooth minimum."""
    every = np.stack(distances)
    least = every.min(axis=0)
    return least - width * np.log(np.exp(-(every - least) / width).sum(axis=0))


def _united(distances: list[Array], width: float) -> Array:
    """A smooth maximum."""
    return -_blended([-d for d in distances], width)


def _onto(function: Function, x: Array) -> Array:
    """Points near the surface, moved onto it by Newton's steps along the gradient."""
    for _ in range(NEWTON_STEPS):
        value = function(x)
        slope = np.stack([function(x + d) - function(x - d) for d in DIFFERENCE * np.eye(3)], axis=1)
        slope /= 2 * DIFFERENCE
        x = x - (value / np.maximum((slope**2).sum(axis=1), 1e-12))[:, None] * slope
    return x


def _samples(function: Function, size: Size, reach: float) -> Array:
    """Points of the surface, none nearer than 0.81 of the size to another, and no room for more."""
    from scipy.spatial import cKDTree

    half, cells = reach, np.zeros((1, 3))  # of an octree, as long as they may meet the surface
    found = []
    while len(cells):
        done = 2 * half < _lengths(size, cells) / 3
        found.append(cells[done])
        steps = np.array(list(np.ndindex(2, 2, 2))) - 0.5
        half, cells = half / 2, (cells[~done][:, None] + half * steps).reshape(-1, 3)
        cells = cells[np.abs(function(cells)) < STEEPEST * np.sqrt(3) * half]
    points = _onto(function, np.concatenate(found))
    points = points[np.abs(function(points)) < 1e-9]
    near = THINNED * _lengths(size, points)
    points, near = points[np.argsort(near, kind="stable")], np.sort(near)
    pairs = cKDTree(points).query_pairs(near.max(), output_type="ndarray")
    apart = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    pairs = pairs[apart < near[pairs].min(axis=1)]
    order = np.argsort(pairs.max(axis=1), kind="stable")
    pairs = np.sort(pairs[order], axis=1)
    kept = np.ones(len(points), dtype=bool)
    start = np.searchsorted(pairs[:, 1], np.arange(len(points) + 1))
    for i in range(len(points)):
        kept[i] = not kept[pairs[start[i] : start[i + 1], 0]].any()
    return points[kept]


def _lengths(size: Size, x: Array) -> Array:
    return np.asarray(size(x)) if callable(size) else np.full(len(x), size)


def surface_of(function: Function, size: Size, reach: float) -> tuple[Array, NDArray[np.int32]]:
    """Points and outward triangles with edges of about a wanted length of an implicit surface in a box."""
    from unstruct import delaunay
    from unstruct.simplex import circumcenter

    points = _samples(function, size, reach)
    for round_ in range(EVEN_ROUNDS + 1):
        mesh = delaunay(points)
        with np.errstate(all="ignore"):
            centers = circumcenter(mesh.points[mesh.simplices])
        inside = np.zeros(mesh.size + 1, dtype=bool)
        good = np.isfinite(centers).all(axis=1) & (np.abs(centers).max(axis=1) < 4 * reach)
        inside[:-1][good] = function(centers[good]) < 0
        t, k = np.nonzero(inside[:-1, None] & ~inside[mesh.neighbors])
        sides = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
        triangles = mesh.simplices[t[:, None], sides[k]]
        if round_ == EVEN_ROUNDS:
            break
        points = _onto(function, _evened(points, triangles, size))
    used, numbers = np.unique(triangles, return_inverse=True)
    return points[used], numbers.reshape(-1, 3).astype(np.int32)


def _evened(points: Array, triangles: NDArray[np.int32], size: Size) -> Array:
    """Each point at the mean of the centroids of its triangles, weighted by their areas over size^4."""
    corners = points[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    area /= _lengths(size, corners.mean(axis=1)) ** 4
    flat = triangles.ravel()
    weight = np.bincount(flat, np.repeat(area, 3), len(points))
    middle = np.repeat(corners.mean(axis=1) * area[:, None], 3, axis=0)
    total = np.stack([np.bincount(flat, middle[:, k], len(points)) for k in range(3)], axis=1)
    return np.where(weight[:, None] > 0, total / np.maximum(weight, 1e-300)[:, None], points)


# ---------------------------------------------------------------------- bodies


def implicit(function: Function, reach: float = 2.0) -> Callable[[Size], Any]:
    """A body from a function, for each edge length."""

    def make(size: Size) -> Any:
        from unstruct import Domain

        return Domain(*surface_of(function, size, reach))

    return make


def gridded(h: float) -> Any:
    """A cube whose sides are squares, each with one of its diagonals by chance."""
    from unstruct import Domain

    n = round(2.0 / h)
    rng = np.random.default_rng(0)
    number: dict[tuple[int, ...], int] = {}
    faces = []
    for axis in range(3):
        for end in (0, n):
            for i, j in np.ndindex(n, n):
                square = []
                for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    row = [0, 0, 0]
                    row[axis], row[(axis + 1) % 3], row[(axis + 2) % 3] = end, i + u, j + v
                    square.append(number.setdefault(tuple(row), len(number)))
                if end == 0:
                    square.reverse()
                k = int(rng.integers(2))
                a, b, c, d = (square[(k + m) % 4] for m in range(4))
                faces += [(a, b, c), (a, c, d)]
    return Domain(np.array(list(number), dtype=float) * (2.0 / n) - 1.0, np.array(faces))


def spiral(h: float) -> Any:
    """A ball with points along a spiral, in directions that no lattice has."""
    from unstruct import Domain, delaunay

    n = round(4 * np.pi / (h * h * np.sqrt(3) / 2))
    height = 1 - (2 * np.arange(n) + 1) / n
    turn = np.pi * (1 + np.sqrt(5)) * np.arange(n)
    radius = np.sqrt(1 - height**2)
    points = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])
    return Domain(points, delaunay(points).boundary)


def ball(h: float) -> Any:
    """A ball: an icosahedron, divided."""
    from unstruct import Domain

    return Domain.ball(size=h)


def torus(h: float) -> Any:
    """A torus."""
    from unstruct import Domain

    return Domain.torus(size=h)


def cylinder_from_stl(h: float) -> Any:
    """A cylinder with uniform triangles, written as binary STL (32-bit floats) and read again."""
    import tempfile
    from pathlib import Path

    from unstruct import Domain

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cylinder.stl"
        Domain.cylinder((0, 0, -0.8), (0, 0, 0.8), 0.7, size=h).write(path)
        return Domain.read(path)


# name -> the body for an edge length, and its volume, roughly
GOOD: dict[str, tuple[Callable[[float], Any], float]] = {
    "ball": (ball, 4.19),
    "spiral ball": (spiral, 4.19),
    "torus": (torus, 3.16),
    "gridded cube": (gridded, 8.0),
    "STL cylinder": (cylinder_from_stl, 2.46),
    "bone": (implicit(bone), 1.93),
    "pipe tee": (implicit(tee), 1.66),
    "noisy 1": (implicit(noisy(1), 2.6), 5.87),
    "noisy 2": (implicit(noisy(2), 2.6), 4.99),
    "noisy 3": (implicit(noisy(3), 2.6), 3.37),
}
# ---------------------------------------------------------------------- graded sizes


def to_a_point(n: int) -> Sized:
    """A ball that is fine at a point inside."""
    from unstruct import sizing

    h = 0.08 * np.cbrt(1e5 / n)
    near = f"({h / 12:.9g}+0.2*Sqrt((x-0.31)*(x-0.31)+(y-0.17)*(y-0.17)+(z-0.11)*(z-0.11)))"
    text = f"({near}+{h:.9g}-Fabs({near}-{h:.9g}))/2"  # the minimum
    return ball(h), sizing.points([(0.31, 0.17, 0.11)], h / 12, growth=0.2, far=h), text


def from_the_surface(n: int) -> Sized:
    """A torus with a fine surface; the size grows inward."""
    from unstruct import Domain

    h = 0.044 * np.cbrt(1e5 / n)

    def size(x: Array) -> Array:
        return h + 0.3 * np.maximum(0.4 - np.hypot(np.hypot(x[:, 0], x[:, 1]) - 1.0, x[:, 2]), 0.0)

    axis = "Sqrt((Sqrt(x*x+y*y)-1)*(Sqrt(x*x+y*y)-1)+z*z)"
    return Domain.torus(size=h), size, f"{h:.9g}+0.15*(0.4-{axis}+Fabs(0.4-{axis}))"


def along(n: int) -> Sized:
    """A noisy body that is four times as fine at one end, on the surface and inside."""
    h = 0.038 * np.cbrt(1e5 / n)

    def size(x: Array) -> Array:
        return h * (1.0 + 3.0 * np.clip((x[:, 0] + 1.2) / 2.4, 0.0, 1.0))

    share = "((x+1.2)/2.4)"
    text = f"{h:.9g}*(1+1.5*(1+Fabs({share})-Fabs(1-{share})))"  # clipped to 0 and 1
    return implicit(noisy(2), 2.6)(size), size, text


GRADED: dict[str, Callable[[int], Sized]] = {
    "to a point inside": to_a_point,
    "from the surface inward": from_the_surface,
    "along a body": along,
}
CELL_VOLUME = 0.116  # the mean volume of a cell in a mesh by a size h; unit: h^3


def edge_length(volume: float, cells: int) -> float:
    """The size for about so many cells."""
    return float(np.cbrt(volume / (cells * CELL_VOLUME)))
