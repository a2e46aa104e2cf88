"""Ready-made bodies: boxes, balls, tori, cylinders; all points of round ones lie on their true surfaces.

Each function gives the arguments of a `Domain`: points, facets, and options. Facets point outward.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, positive
from ...base.arrays import as_points
from ...base.elementary import angle_of, sines
from ...base.errors import InputError
from ...geometry.edge_vectors import determinant, lengths
from ..plane.shapes import Parts
from .rings import between, circle, disc, smoothed

__all__ = ["as_vector", "ball", "box", "cylinder", "torus"]

EDGES_A_RADIUS = 5.0  # without a size, so many edges have the length of the (smallest) radius
MOST_WITHOUT_SIZE = 500_000  # points of a surface; more are hardly wanted by who gives no size
FEWEST = 6  # points of a ring at least
ROW = np.sqrt(3) / 2  # the height of an equilateral triangle; unit: its side
BOX_SIDES = {  # corners are numbered so that z changes first
    "left": (0, 1, 3, 2),
    "right": (4, 6, 7, 5),
    "front": (0, 4, 5, 1),
    "back": (2, 3, 7, 6),
    "bottom": (0, 2, 6, 4),
    "top": (1, 5, 7, 3),
}


def as_vector(value: Any, name: str) -> np.ndarray:
    """Three coordinates, or an error that names the argument."""
    rows = as_points([value], name) if np.ndim(value) == 1 else np.empty((1, 0))
    if rows.shape[1] != 3:
        raise InputError(f"{name} must be three coordinates, not {value!r:.60}")
    return rows[0]


def box(lower: Any, upper: Any) -> Parts:
    """A box with its sides as six rectangles, each with its name."""
    low, high = as_vector(lower, "lower"), as_vector(upper, "upper")
    if not (low < high).all():
        raise InputError(f"lower {low.tolist()} must be less than upper {high.tolist()} in all coordinates")
    points = np.array(list(product(*zip(low.tolist(), high.tolist()))))
    facets = np.array(list(BOX_SIDES.values()))
    return {"points": points, "facets": facets, "markers": {name: [i] for i, name in enumerate(BOX_SIDES)}}


# ---------------------------------------------------------------------- ball


def _icosahedron() -> tuple[np.ndarray, NDArray[np.int64]]:
    """The corners, which have distance 1 from the origin, and the faces, counterclockwise from outside."""
    golden = (1 + np.sqrt(5)) / 2
    rows = [(0.0, y, z * golden) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
    points = np.array([np.roll(row, k) for k in range(3) for row in rows])
    apart = np.linalg.norm(points[:, None] - points, axis=2)
    near = (apart > 1) & (apart < 2.5)
    faces = []
    for a, b, c in product(range(12), repeat=3):
        if a < b < c and near[a, b] and near[b, c] and near[c, a]:
            outward = determinant(points[[a, b, c]]) > 0
            faces.append((a, b, c) if outward else (a, c, b))
    return points / lengths(points[0]), np.array(faces)


def _divided(n: int) -> tuple[np.ndarray, NDArray[np.int32]]:
    """The icosahedron with each edge in n equal angles: directions, which are no unit vectors, and triangles.

    A point of a face has whole weights i + j + k = n at the corners. Their sines, of i / n of the angle of an
    edge, make the angles along edges equal, and triangles inside more equal than plain weights do.
    """
    corners, faces = _icosahedron()
    angle = angle_of(2.0, 1.0)
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij"))
    i, j = i[i + j <= n], j[i + j <= n]
    weights = np.stack([i, j, n - i - j], axis=1)
    # A point is known by its corners with weights other than 0, so that faces share those of their edges.
    code = np.where(weights > 0, faces[:, None, :] * (n + 1) + weights + 1, 0)
    code = np.sort(code, axis=2)
    key = (code[..., 0] * (13 * n + 13) + code[..., 1]) * (13 * n + 13) + code[..., 2]
    _, first, number = np.unique(key.ravel(), return_index=True, return_inverse=True)
    face, row = np.divmod(first, len(i))
    share = sines(weights[row] / n * angle)
    every = corners[faces[face]]
    points = sum(share[:, m, None] * every[:, m] for m in range(3))
    at = np.full((n + 1, n + 1), -1)
    at[i, j] = np.arange(len(i))
    a, b = (x[i + j < n] for x in (i, j))
    up = np.stack([at[a + 1, b], at[a, b + 1], at[a, b]], axis=1)
    a, b = (x[i + j < n - 1] for x in (i, j))
    down = np.stack([at[a + 1, b], at[a + 1, b + 1], at[a, b + 1]], axis=1)
    cells = np.concatenate([up, down])
    return np.asarray(points), number.reshape(len(faces), -1)[:, cells].reshape(-1, 3).astype(np.int32)


def ball(center: Any, radius: Any, size: Any) -> Parts:
    """A ball: an icosahedron, its faces divided, and the points moved onto the sphere."""
    middle, r = as_vector(center, "center"), positive(radius, "radius")
    h = r / EDGES_A_RADIUS if size is None else positive(size, "size")
    # 20 n^2 equilateral triangles of side h have the area of the sphere
    n = max(
        1,
        _whole(
            r / h * np.sqrt(4 * np.pi / (5 * np.sqrt(3))), h, lambda n: 10 * n * n + 2, given=size is not None
        ),
    )
    points, triangles = _divided(n)
    return {"points": _sphere(points) * r + middle, "facets": triangles}


def _sphere(points: np.ndarray) -> np.ndarray:
    """The nearest points of the unit sphere."""
    once = points / np.linalg.norm(points, axis=1)[:, None]
    return once / np.linalg.norm(once, axis=1)[:, None] + 0.0


def _whole(count: float, size: float, total: Any, *, given: bool) -> int:
    """A number rounded, or an error if there would be more points than memory holds, or a default is for."""
    if not given and not total(count) < MOST_WITHOUT_SIZE:
        raise InputError(
            f"the default size, {size:.3g}, would make {total(count):.3g} points, because the shape is thin: "
            "give a size"
        )
    if not total(count) < DEFAULT_BUDGET:
        raise InputError(f"size = {size:g} would make {total(count):.3g} points; give a larger size")
    return round(count)


# ---------------------------------------------------------------------- torus and cylinder


def _frame(axis: np.ndarray, name: str) -> np.ndarray:
    """Two directions across an axis, and that of the axis, as rows; exact for axes of coordinates."""
    largest = np.abs(axis).max()
    if largest == 0.0:
        raise InputError(f"{name} has no direction: give a vector other than zero")
    w = axis / largest
    w = w / lengths(w)
    if np.count_nonzero(w) == 1:
        k = int(np.argmax(np.abs(w)))
        u, v = np.eye(3)[(k + 1) % 3], np.eye(3)[(k + 2) % 3]
        return np.stack([u, v if w[k] > 0 else -v, w])
    u = np.cross(w, np.eye(3)[int(np.argmin(np.abs(w)))])
    u = u / lengths(u)
    return np.stack([u, np.cross(w, u), w])


def torus(center: Any, radius: Any, tube: Any, size: Any, axis: Any) -> Parts:
    """A torus: rings around its axis, with fewer points on smaller ones."""
    middle, far, r = as_vector(center, "center"), positive(radius, "radius"), positive(tube, "tube")
    frame = _frame(as_vector(axis, "axis"), "axis")
    if not r < far:
        raise InputError(
            f"tube = {r:g} must be less than radius = {far:g}: the torus would pass through itself"
        )
    h = r / EDGES_A_RADIUS if size is None else min(positive(size, "size"), r)
    rows = max(
        FEWEST,
        _whole(2 * np.pi * r / (h * ROW), h, lambda n: n * 2 * np.pi * far / h, given=size is not None),
    )
    turn = circle(np.arange(rows) / rows)
    counts = np.maximum(FEWEST, np.round(2 * np.pi * (far + r * turn[:, 0]) / h).astype(int))
    first = np.concatenate([[0], np.cumsum(counts)])
    phase, phases, points, triangles = 0.0, [], [], []
    for k in range(rows):
        phases.append(phase)
        round_ = (far + r * turn[k, 0]) * circle(phase + np.arange(counts[k]) / counts[k])
        points.append(np.column_stack([round_, np.full(counts[k], r * turn[k, 1])]))
        phase = (phase + 0.5 / counts[k]) % (1 / counts[(k + 1) % rows])
    for k in range(rows):
        j = (k + 1) % rows
        triangles.append(between(first[k], counts[k], phases[k], first[j], counts[j], phases[j]))
    cells = np.concatenate(triangles)

    def onto(x: np.ndarray) -> np.ndarray:
        return _on_torus(x, far, r)

    found = onto(smoothed(np.concatenate(points), cells, np.ones(first[-1], dtype=bool), onto))
    return {"points": (found[:, :, None] * frame).sum(axis=1) + middle, "facets": cells}


def _on_torus(x: np.ndarray, radius: float, tube: float) -> np.ndarray:
    """The nearest points of a torus about the axis of z."""
    away = lengths(x[:, :2])
    across, up = away - radius, x[:, 2]
    length = lengths(np.stack([across, up], axis=1))
    rho = radius + tube * (across / length)
    return np.column_stack([x[:, 0] / away * rho, x[:, 1] / away * rho, tube * (up / length)])


def cylinder(start: Any, end: Any, radius: Any, size: Any) -> Parts:
    """A cylinder between two points; names of its facets are "side", "bottom" and "top"."""
    low, high, r = as_vector(start, "start"), as_vector(end, "end"), positive(radius, "radius")
    frame = _frame(high - low, "the axis from start to end")
    length = float(lengths(high - low))
    h = r / EDGES_A_RADIUS if size is None else min(positive(size, "size"), r)
    n = max(FEWEST, _whole(2 * np.pi * r / h, h, lambda n: n * (n / 5 + length / h), given=size is not None))
    layers = max(1, round(length / (h * ROW)))
    bottom, below = disc(n, 0.0)
    top, above = disc(n, layers % 2 / (2 * n))
    x, y = (r * frame[0], r * frame[1])
    points = [low + bottom[:, :1] * x + bottom[:, 1:] * y]
    first, triangles = len(bottom), []
    before = 0
    for k in range(1, layers):
        ring = circle((k % 2 / 2 + np.arange(n)) / n)
        points.append(low + k / layers * (high - low) + ring[:, :1] * x + ring[:, 1:] * y)
        triangles.append(_between_layers(before, first, n, k))
        before, first = first, first + n
    triangles.append(_between_layers(before, first, n, layers))
    points.append(high + top[:, :1] * x + top[:, 1:] * y)
    side = np.concatenate(triangles)
    cells = np.concatenate([side, below[:, ::-1], above + np.int32(first)])
    ends = np.cumsum([len(side), len(below), len(above)])
    names = dict(zip(("side", "bottom", "top"), np.split(np.arange(ends[-1]), ends[:-1])))
    return {"points": np.concatenate(points), "facets": cells, "markers": names}


def _between_layers(first: int, other: int, n: int, layer: int) -> NDArray[np.int32]:
    """The triangles between a ring and the one above, which is turned by half a step."""
    i = np.arange(n)
    j = (i + 1) % n
    one, two = (i, j) if layer % 2 else (j, i)  # whether the upper ring runs half a step ahead
    rows = np.concatenate(
        [
            np.column_stack([first + i, first + j, other + one]),
            np.column_stack([other + j, other + i, first + two]),
        ]
    )
    return rows.astype(np.int32)
