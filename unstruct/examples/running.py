"""The book's running region, its size field and its points; bad triangulations to be mended.

The region is a lake in [0, 3] x [0, 2] with one island and a peninsula that bends along the shore.
Its outline is smooth and given by formulas, so that it can be sampled at any spacing. The strait
beside the peninsula is narrow: where the spacing is coarse (0.15 and above) the Delaunay triangulation
of the boundary points misses boundary edges, which is what later chapters mend.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import as_points
from ..base.elementary import cosine, cosines, exponentials, sines
from ..base.errors import DegenerateInputError, InputError
from ..base.jit import kernel
from ..connect.swapping import corner_facing, flip
from ..mesh.mesh import Mesh
from ..mesh.topology import neighbors
from ..predicates.batch import orient, scaled
from ..predicates.exact import exact_orient2
from ..predicates.kernels import orient2

__all__ = [
    "flip_at_random",
    "inside_polygon",
    "island_shore",
    "lake_shore",
    "random_triangulation",
    "running_points",
    "running_region",
    "running_size",
    "sweep_triangulation",
    "two_triangulations",
]

Array = NDArray[np.float64]

ISLAND_CENTER = np.array([2.1, 0.82])
ISLAND_RADIUS = 0.2
COARSEST = 0.4  # above this spacing the polygon no longer resembles the lake


def lake_shore(t: ArrayLike) -> Array:
    """The outer shore, counterclockwise, for parameters t in [0, 2 pi); shape (..., 2)."""
    t = np.asarray(t, dtype=float)
    radius = 0.93 + 0.04 * cosines(3.0 * t + 0.4) + 0.02 * sines(5.0 * t)
    cosine_t, sine_t = cosines(t), sines(t)
    x = 1.5 + 1.48 * radius * cosine_t
    y = 1.0 + 0.99 * radius * sine_t
    away = ((cosine_t - cosine(1.95)) / 0.05) ** 2
    land = exponentials(-away * away) * (sine_t > 0)  # 1 on the peninsula
    square = land * land
    return np.stack([x - 0.05 * land + square * square, y - 2.1 * land + 0.42 * (square * land)], axis=-1)


def island_shore(t: ArrayLike) -> Array:
    """The shore of the island, clockwise (water on its left), for t in [0, 2 pi); shape (..., 2)."""
    t = -np.asarray(t, dtype=float)
    radius = ISLAND_RADIUS * (1.15 + 0.15 * cosines(2.0 * t + 0.7))
    return ISLAND_CENTER + radius[..., None] * np.stack([1.15 * cosines(t), sines(t)], axis=-1)


def running_size(x: ArrayLike) -> Array:
    """The book's size field: 0.03 at the island, growing by 0.12 per unit of distance from it.

    Parameters
    ----------
    x : (..., 2) array

    Returns
    -------
    (...) array
        The wanted edge length, 0.03 + 0.12 * (distance to the disk of radius 0.2 in the island).
    """
    away = np.linalg.norm(np.asarray(x, dtype=float) - ISLAND_CENTER, axis=-1) - ISLAND_RADIUS
    return 0.03 + 0.12 * np.maximum(away, 0.0)


def running_region(spacing: float | Callable[[Array], Array]) -> tuple[Array, NDArray[np.int32]]:
    """The running region as a polygon with one hole.

    Parameters
    ----------
    spacing : float or function (k, 2) -> (k,)
        The wanted length of the boundary segments; `running_size` gives the graded boundary.

    Returns
    -------
    points : (n, 2) float64
        The outer shore counterclockwise, then the shore of the island clockwise.
    segments : (n, 2) int32
        The boundary edges as pairs of indices; the lake is on their left.

    Raises
    ------
    InputError
        Where the spacing is not a positive number or exceeds 0.4.
    """
    points, segments = [], []
    start = 0
    for shore in (lake_shore, island_shore):
        ring = np.round(shore(_equal_steps(shore, spacing)) * 2.0**30) / 2.0**30  # the same on any machine
        index = np.arange(start, start + len(ring))
        start += len(ring)
        points.append(ring)
        segments.append(np.stack([index, np.roll(index, -1)], axis=1))
    return np.concatenate(points), np.concatenate(segments).astype(np.int32)


def _equal_steps(shore: Callable[[ArrayLike], Array], spacing: float | Callable[[Array], Array]) -> Array:
    """Parameters on a closed curve at equal steps of the integral of ds / spacing."""
    t = np.linspace(0.0, 2.0 * np.pi, 32769)
    fine = shore(t)
    middle = (fine[1:] + fine[:-1]) / 2
    wanted = np.asarray(spacing(middle) if callable(spacing) else spacing, dtype=float)
    bad = ~((wanted > 0) & (wanted <= COARSEST))
    if bad.any():
        raise InputError(
            f"spacing {wanted[bad].flat[0]} must be in (0, {COARSEST}]: the region is about 3 by 2 long"
        )
    steps = np.linalg.norm(np.diff(fine, axis=0), axis=1) / wanted
    length = np.concatenate([[0.0], np.cumsum(steps)])
    n = max(round(length[-1]), 5)
    return np.interp(np.arange(n) * (length[-1] / n), length, t)


def running_points(seed: int = 0, *, scale: float = 1.0) -> Array:
    """Points for the running region: its graded boundary and blue noise inside.

    Parameters
    ----------
    seed : int
        Seed of the random numbers; the same seed gives the same points.
    scale : float
        Factor on `running_size`.

    Returns
    -------
    (n, 2) float64
        First the points of ``running_region(running_size)`` (with the size scaled), then the interior
        points: no two closer than about 0.75 times the wanted size, no gap much wider than it.
    """
    if not scale > 0:
        raise InputError(f"scale {scale} must be a positive number")
    boundary, segments = running_region(lambda x: scale * running_size(x))
    rng = np.random.default_rng(seed)
    total = int(60_000 / scale**2) + 1000
    candidates = rng.random((total, 2)) * [3.0, 2.0]
    keep = rng.random(total) * (running_size(candidates) / 0.03) ** 2 < 1.0  # denser where h is smaller
    candidates = candidates[keep & inside_polygon(candidates, boundary, segments)]
    distance = 0.75 * scale * running_size(candidates)
    points = np.empty((len(boundary) + len(candidates), 2))
    n = len(boundary)
    points[:n] = boundary
    for x, d in zip(candidates, distance):
        if ((points[:n] - x) ** 2).sum(axis=1).min() >= d * d:
            points[n] = x
            n += 1
    return points[:n].copy()


def inside_polygon(x: Array, points: Array, segments: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Even-odd rule in floating point, for samples that are kept away from the boundary anyway."""
    a, b = points[segments[:, 0]], points[segments[:, 1]]
    inside = np.zeros(len(x), dtype=bool)
    for (ax, ay), (bx, by) in zip(a, b):
        crosses = (ay > x[:, 1]) != (by > x[:, 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            inside ^= crosses & (x[:, 0] < ax + (x[:, 1] - ay) * (bx - ax) / (by - ay))
    return inside


# --- bad triangulations ----------------------------------------------------------------------------


def sweep_triangulation(points: ArrayLike) -> Mesh:
    """Join points from left to right, each to all hull edges that it sees: valid, and full of slivers.

    Parameters
    ----------
    points : (n, 2) array
        Copies are allowed: the first of each is used, the others are listed in `Mesh.duplicates`.

    Returns
    -------
    Mesh
        A triangulation of the convex hull that uses every distinct point; far from Delaunay.

    Raises
    ------
    InputError
        For other shapes and for coordinates that are not finite.
    DegenerateInputError
        Where all points lie on a line.

    Notes
    -----
    Exact; O(n log n). Book: 2.0, where diagonal swapping mends it.
    """
    points = as_points(points)
    if points.shape[1] != 2:
        raise InputError(f"points must have shape (n, 2), not {points.shape}")
    P, exact = scaled(points)
    P = P if exact else points
    order = np.lexsort((np.arange(len(P)), P[:, 1], P[:, 0]))
    copy = np.zeros(len(P), dtype=bool)
    copy[1:] = (P[order[1:]] == P[order[:-1]]).all(axis=1)
    kept = order[~copy]
    T, m = _sweep(P, kept, not exact)
    if m == 0:
        dimension = min(len(kept) - 1, 1)
        raise DegenerateInputError(
            f"all {len(P)} points lie on a line or coincide (dimension {dimension}): no triangle exists",
            dimension,
        )
    leader = order[np.maximum.accumulate(np.where(copy, 0, np.arange(len(P))))]
    duplicates = np.stack([order[copy], leader[copy]], axis=1)
    return Mesh(points, T[:m], duplicates=duplicates[np.argsort(duplicates[:, 0])])


def random_triangulation(
    points: ArrayLike, rng: int | np.random.Generator = 0, *, swaps: int | None = None
) -> Mesh:
    """A triangulation of the convex hull after random diagonal swaps of `sweep_triangulation`.

    Parameters
    ----------
    points : (n, 2) array
    rng : int or numpy Generator
    swaps : int, optional
        How many edges are tried; those of strictly convex quadrilaterals are swapped. 10 n by default.
    """
    mesh = sweep_triangulation(points)
    P, exact = scaled(mesh.points)
    T, N = mesh.simplices.copy(), neighbors(mesh.simplices)
    tries = 10 * len(P) if swaps is None else swaps
    slots = np.random.default_rng(rng).integers(T.size, size=tries)
    _swap_at(P if exact else np.array(mesh.points), T, N, slots, not exact)
    return Mesh(mesh.points, T, neighbors=N, duplicates=mesh.duplicates)


@kernel
def _turn(P, u, v, w, wide):
    a, b, c = P[u], P[v], P[w]
    if wide:
        return exact_orient2(a[0], a[1], b[0], b[1], c[0], c[1])
    return orient2(a[0], a[1], b[0], b[1], c[0], c[1])


@kernel
def _sweep(P, order, wide):
    """Triangles of the sweep over distinct sorted points, and their number (0: all collinear)."""
    n = len(order)
    T = np.empty((2 * n, 3), dtype=np.int32)
    following, preceding = np.empty(len(P), dtype=np.int64), np.empty(len(P), dtype=np.int64)
    k = 2
    while k < n and _turn(P, order[0], order[1], order[k], wide) == 0:
        k += 1
    if k >= n:
        return T, 0
    left = _turn(P, order[0], order[1], order[k], wide) > 0
    m = 0
    for r in range(k):  # the first k points lie on a line; the hull runs along them and over point k
        u, v = order[r], order[r + 1]
        if r + 1 < k:
            T[m, 0], T[m, 1], T[m, 2] = (u, v, order[k]) if left else (v, u, order[k])
            m += 1
        if left:
            following[u], preceding[v] = v, u
        else:
            following[v], preceding[u] = u, v
    if left:
        following[order[k]], preceding[order[0]] = order[0], order[k]
    else:
        following[order[0]], preceding[order[k]] = order[k], order[0]
    for r in range(k + 1, n):
        p, right, back = order[r], order[r - 1], order[r - 1]
        while _turn(P, right, following[right], p, wide) < 0:
            T[m, 0], T[m, 1], T[m, 2] = right, p, following[right]
            m, right = m + 1, following[right]
        while _turn(P, preceding[back], back, p, wide) < 0:
            T[m, 0], T[m, 1], T[m, 2] = back, preceding[back], p
            m, back = m + 1, preceding[back]
        following[back], preceding[p], following[p], preceding[right] = p, back, right, p
    return T, m


@kernel
def _swap_at(P, T, N, slots, wide):
    """Swap the edges at the given slots (3 t + i) where that leaves two proper triangles."""
    for code in slots:
        t, i = code // 3, code % 3
        s = N[t, i]
        if s < 0:
            continue
        p, u, v, q = T[t, i], T[t, (i + 1) % 3], T[t, (i + 2) % 3], T[s, corner_facing(N, s, t)]
        if _turn(P, p, u, q, wide) > 0 and _turn(P, q, v, p, wide) > 0:
            flip(T, N, t, i)


def flip_at_random(mesh: Mesh, tries: int, rng: int | np.random.Generator = 0) -> Mesh:
    """Exchange cells at random by bistellar flips (2-2; 2-3 and 3-2; ...): valid, and far from Delaunay.

    Parameters
    ----------
    mesh : Mesh
        Simplices of full dimension d >= 2, positively oriented.
    tries : int
        Two cells at a facet have d + 2 vertices, which have two triangulations (if no d + 1 are flat):
        leaving out one of some of them, or one of the others. A try that finds one whole in the mesh puts
        the other in its place. Vertices never vanish.
    rng : int or numpy Generator

    Returns
    -------
    Mesh
        The same points.
    """
    rng = np.random.default_rng(rng)
    cells: list[frozenset[int]] = []
    place: dict[frozenset[int], int] = {}
    owners: dict[frozenset[int], set[frozenset[int]]] = {}

    def put(cell: frozenset[int]) -> None:
        place[cell] = len(cells)
        cells.append(cell)
        for v in cell:
            owners.setdefault(cell - {v}, set()).add(cell)

    def take(cell: frozenset[int]) -> None:
        last = cells.pop()
        if last != cell:
            cells[place[cell]] = last
            place[last] = place[cell]
        del place[cell]
        for v in cell:
            owners[cell - {v}].remove(cell)

    for row in mesh.simplices.tolist():
        put(frozenset(row))
    for chosen, corner in rng.integers((2**31, mesh.dimension + 1), size=(tries, 2)).tolist():
        cell = cells[chosen % len(cells)]
        pair = owners[cell - {sorted(cell)[corner]}]
        if len(pair) == 2:
            old, new = two_triangulations(mesh.points, sorted(frozenset.union(*pair)))
            if not pair <= old:
                old, new = new, old
            if pair <= old and len(new) > 1 and all(cell in place for cell in old):
                for cell in sorted(old, key=sorted):
                    take(cell)
                for cell in sorted(new, key=sorted):
                    put(cell)
    simplices = np.array([sorted(cell) for cell in cells])
    return Mesh(mesh.points, simplices, origin=mesh.origin, duplicates=mesh.duplicates).oriented()


def two_triangulations(points: Array, vertices: list[int]) -> tuple[set[frozenset[int]], set[frozenset[int]]]:
    """Both triangulations of d + 2 points; two empty sets where d + 1 of them lie in a hyperplane.

    With the affine relation sum c_v p_v = 0, sum c_v = 0: the cells without one v of c_v > 0 are one, those
    without one v of c_v < 0 the other (Radon). Up to alternating sign c_v is the orientation of the others.
    """
    others = [[u for u in vertices if u != v] for v in vertices]
    signs = np.asarray(orient(points[others])) * (-1) ** np.arange(len(vertices))
    if not signs.all():
        return set(), set()
    halves = ({frozenset(o) for o, c in zip(others, signs) if c == sign} for sign in (1, -1))
    return next(halves), next(halves)
