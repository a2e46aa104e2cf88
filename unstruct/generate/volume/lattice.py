"""Points inside a body for cells of a wanted size: body-centered lattices, nested where the size varies.

The Delaunay tetrahedra of a body-centered lattice are all alike, with dihedral angles of 60 and 90 degrees.
There is no fifth point on their spheres, since four Voronoi cells (truncated octahedra) meet at each corner.
But parts of the lattice, which are there while points are inserted, are full of cospherical points, such as
the corners of cubes; their ties make insertion slow. So each point is moved by about a thousandth of its
cell, by a hash of its place in the lattice. See the book, 2.8c.

Points of the same lattice are kept outside, too, next to the surface. Their cells are thrown away in the end,
but they make the facets easier to recover: without them the void of a round hole is a triangulation of rings
of cospherical points, in which the given diagonals of a wall often exist together in no triangulation.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.jit import kernel
from ...domain.domain import Domain
from ...domain.space.cutting import Shell
from ...geometry.boxes import BoxTree, bounding_boxes
from ...geometry.edge_vectors import lengths
from ...geometry.inside_shell import even_odd_in_space
from ...geometry.segment_tree import SegmentTree
from ...mesh.grouping import group_rows
from ...predicates.batch import power_of_two
from ...sizing.field import SizeField
from .coarse import COARSE_FALL, CoarseFacets, square_from_triangle

__all__ = ["FROM_SURFACE", "MOST_INNER", "REACH_OUTSIDE", "Lattice", "lattice_points"]

Array = NDArray[np.float64]
CELL = 1.1  # the side of a cubic cell over the wanted length, so that the mean edge has it
FROM_SURFACE = 0.6  # how near to the surface points may be; unit: the wanted length there
REACH_OUTSIDE = 1.7  # how near to the surface points outside are: about one layer of cells; in the same unit
JITTER = 1e-3  # of the side of a cell
MOST_INNER = 2_000_000  # points, unless a budget is given
SPARSE = (
    4  # times as many lattice points in the box are made and sorted out, for bodies that fill little of it
)
FINER = 0.7  # mean edges at a vertex of the surface over the size, from which the surface is called finer
SURFACE_GROWTH = 0.4  # of the size from the finer surface, per length
TOWARDS = 0.35  # within which distance of its center the size of a cell is seen; unit: a side
NEARER = 0.75  # cells near a finer surface over the limit of their size, because levels are rounded
FEW_PLACES = 4096  # are always allowed
PROBES_ALONG = 8  # along each side of the box, to find the least size
DEEPEST_LATTICE = 40  # levels of nested lattices: the coordinates of their places are exact
DEEPEST_KEY = 18  # levels of nested lattices with places that fit into one number of 64 bits
LOOKED_UP = 16  # places along the box where sizes are looked up at least, so that small features are met
LOOKED_UP_AT_ONCE = 1 << 17  # places, to bound the memory


class Lattice(NamedTuple):
    """Points inside, for the mesh, and points outside, which only help to recover the surface.

    ``beside`` are further points inside, which are so near to a coarse facet that they would be in the way of
    its recovery; ``coarse`` are these facets, if there are any.
    """

    inside: Array
    outside: Array
    beside: Array
    coarse: CoarseFacets | None


class _Wanted(NamedTuple):
    """The size, smaller near parts of the surface that are finer, and larger near facets that are coarser."""

    field: SizeField
    finer: SegmentTree | None
    coarse: CoarseFacets | None

    def __call__(self, x: Array) -> Array:
        size = _limited(self.finer, x, self.field(x))
        return size if self.coarse is None else self.coarse.least(x, size)


def lattice_points(
    domain: Domain, field: SizeField, budget: int | None = None, coarse: CoarseFacets | None = None
) -> Lattice:
    """Points farther than 0.6 of the wanted length from all facets, segments and points of the body.

    Parameters
    ----------
    domain : Domain
        In space.
    field : SizeField
        The wanted length of edges.
    budget : int, optional
        The largest number of points inside.
    coarse : CoarseFacets, optional
        Facets near which the size is larger, and points are set apart.

    Returns
    -------
    Lattice
        Those inside the body, and those outside that are nearer than 1.7 of the wanted length; all in the
        order of the lattice.

    Raises
    ------
    InputError
        If there would be more than ``budget`` points, or more levels of size than can be nested.
    """
    shell = domain.triangulated
    low, high = domain.bounds
    wanted = _Wanted(field, _finer(shell, field), coarse)
    most = MOST_INNER if budget is None else budget
    if field.constant is None or wanted.finer is not None or coarse is not None:
        places, side, unit, origin = _nested(wanted, shell, low, high, most)
    else:
        places, side, unit, origin = _uniform(field.constant, low, high, most)
    rows = origin + unit * places + JITTER * side[:, None] * _hashed(places)
    size = wanted(rows) if len(rows) else np.empty(0)
    far = ~_near(shell, domain, rows, FROM_SURFACE * size)
    rows, size = rows[far], size[far]
    within = even_odd_in_space(shell.points, shell.bounding, rows)[0]
    count = int(np.count_nonzero(within))
    if count > most:
        raise InputError(_too_many(count, most))
    inside, outside = rows[within], rows[~within]
    outside = outside[_near(shell, domain, outside, REACH_OUTSIDE * size[~within])]
    if coarse is None:
        return Lattice(inside, outside, np.empty((0, 3)), None)
    beside = coarse.beside(inside)
    return Lattice(inside[~beside], outside[~coarse.beside(outside)], inside[beside], coarse)


def _too_many(count: float, most: int) -> str:
    return (
        f"the size asks for about {count:.0f} points inside, more than the {most} that are allowed; give a "
        "larger size, or a budget"
    )


def _uniform(h: float, low: Array, high: Array, most: int) -> tuple[NDArray[np.int64], Array, float, Array]:
    """Both cubic lattices over the box; places in units of half a cell, sides, that unit, the origin."""
    side = CELL * h
    with np.errstate(over="ignore"):
        spans = (high - low) / side
        count = 2.0 * float(np.prod(spans + 1))
    if not count <= SPARSE * most + FEW_PLACES:
        raise InputError(_too_many(count, most))
    reach = (np.ceil(spans / 2) + 1).astype(np.int64)
    axes = [2 * np.arange(-k, k + 1) for k in reach]
    corners = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    places = np.concatenate([corners, corners + 1])
    return places, np.full(len(places), side), side / 2, low / 2 + high / 2


def _nested(wanted_size: _Wanted, shell: Shell, low: Array, high: Array, most: int) -> tuple:
    """Corners and centers of leaves of an octree, as in `_uniform`; the unit is half the least side."""
    field = wanted_size.field
    root = _root(wanted_size, shell, low, high)
    spans = (high - low) / root
    cells, side, level = np.zeros((1, 3), dtype=np.int64), root, 0
    leaves: list[tuple[NDArray[np.int64], int]] = []
    found = 0
    marks = field.landmarks if field.landmarks.shape[1:] == (3,) else np.empty((0, 3))
    marked = field(marks) if len(marks) else np.empty(0)
    while len(cells):
        inside = (cells * 0.5**level < spans).all(axis=1)
        cells = cells[inside]
        wanted = _least_size(wanted_size, low, cells, (side, level))
        at, here = _cell_of(cells, np.floor((marks - low) / side).astype(np.int64))
        np.minimum.at(wanted, at, marked[here])
        split = side > np.sqrt(2.0) * CELL * wanted
        leaves.append((cells[~split], level))
        found += int(np.count_nonzero(~split))
        if 8 * np.count_nonzero(split) + found > SPARSE * most + FEW_PLACES:
            raise InputError(_too_many(8.0 * np.count_nonzero(split) + found, most))
        if split.any() and level == DEEPEST_LATTICE:
            raise InputError(
                f"the size asks for cells below 2^-{DEEPEST_LATTICE} of the body; give a larger size"
            )
        steps = np.array(list(np.ndindex(2, 2, 2)))
        cells = (2 * cells[split][:, None] + steps).reshape(-1, 3)
        side, level = side / 2, level + 1
    return _corners_of(leaves, root, low)


def _finer(shell: Shell, field: SizeField) -> SegmentTree | None:
    """Those vertices of the surface whose edges are much shorter than the size, with the means of these."""
    corners = shell.points[shell.triangles]
    length = lengths(corners - np.roll(corners, -1, axis=1))  # of the edges k, k + 1
    at_corner = (length + np.roll(length, 1, axis=1)).ravel() / 2
    vertex, n = shell.triangles.ravel(), len(shell.points)
    share = np.bincount(vertex, minlength=n)
    mean = np.bincount(vertex, at_corner, minlength=n) / np.maximum(share, 1)
    used = np.flatnonzero(share)
    fine = used[mean[used] < FINER * field(shell.points[used])]
    return SegmentTree(shell.points[fine], mean[fine]) if len(fine) else None


def _limited(surface: SegmentTree | None, x: Array, size: Array) -> Array:
    """The size, made smaller near parts of the surface that are finer: it grows from there."""
    return size if surface is None or len(x) == 0 else surface.least(x, SURFACE_GROWTH, size)[0]


def _root(size: _Wanted, shell: Shell, low: Array, high: Array) -> float:
    """The side of the first cell: the extent at least, and such that halves of it fit most cells.

    The sides of leaves are those of the root, halved, so they miss sizes by up to the square root of 2 either
    way. In the logarithm of base 2 they miss by what is left of whole numbers: the root is chosen by the mean
    of these remainders, as of angles, where each probe counts as many cells as there would be around it. The
    probe next to that mean is met exactly, and so is a size that is constant but for some places.
    """
    share = (np.array(list(np.ndindex(PROBES_ALONG, PROBES_ALONG, PROBES_ALONG))) + 0.5) / PROBES_ALONG
    probes = low + share * (high - low)
    within = probes[even_odd_in_space(shell.points, shell.bounding, probes)[0]]
    probes = within if len(within) else probes
    wanted = CELL * size(probes)
    turn = np.exp(2j * np.pi * np.log2(np.frexp(wanted)[0]))  # the same in each unit of length
    off = np.abs(turn - np.exp(1j * np.angle(((wanted.min() / wanted) ** 3 * turn).sum())))
    least = float(
        wanted[np.argmin(np.round(off, 6))]
    )  # the last bits of logarithms differ between processors
    share, exponent = np.frexp(float((high - low).max()) / least)
    return least * 2.0 ** float(exponent - (share == 0.5))  # a whole number of halvings, up from the least


def _cell_of(cells: NDArray[np.int64], at: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Which cells of a level some places are in, and which of the places are in one."""
    if len(cells) == 0 or len(at) == 0:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    number, first = group_rows(np.concatenate([cells, at]))
    inside = np.flatnonzero(first[number[len(cells) :]] < len(cells))
    return first[number[len(cells) :]][inside].astype(np.int64), inside


def _least_size(size: _Wanted, low: Array, cells: NDArray[np.int64], scale: tuple[float, int]) -> Array:
    """The wanted length in each cell: that at the center, or twice the least one if this is less."""
    if len(cells) == 0:
        return np.empty(0)
    field, surface = size.field, size.finer
    side, level = scale
    centers = low + side * (cells + 0.5)
    wanted = field(centers)
    least = wanted.copy()
    if field.growth is not None:
        least = wanted - TOWARDS * side * field.growth
    else:
        k = max(2, LOOKED_UP >> level)
        places = (np.array(list(np.ndindex(k, k, k))) + 0.5) / k
        at_once = max(1, LOOKED_UP_AT_ONCE // len(places))
        for i in range(0, len(cells), at_once):
            x = low + side * (cells[i : i + at_once, None] + places)
            seen = field(x.reshape(-1, 3)).reshape(len(x), -1).min(axis=1)
            least[i : i + at_once] = np.minimum(wanted[i : i + at_once], seen)
    near = _limited(surface, centers, wanted + TOWARDS * side * SURFACE_GROWTH)
    least = np.minimum(least, near - TOWARDS * side * SURFACE_GROWTH)
    at_center = np.where(near < wanted, NEARER * near, wanted)
    found = np.minimum(at_center, np.maximum(2 * least, at_center / 4))
    if size.coarse is None:
        return found
    beside = size.coarse.least(centers, np.zeros(len(centers)))
    return np.maximum(
        found, np.minimum(beside, np.maximum(2 * (beside - TOWARDS * side * COARSE_FALL), beside / 4))
    )


def _corners_of(leaves: list[tuple[NDArray[np.int64], int]], root: float, low: Array) -> tuple:
    last = max(level for cells, level in leaves if len(cells))
    places, sides = [], []
    for cells, level in leaves:
        step = 2 ** (last - level)
        for corner in [2 * np.array(place) for place in np.ndindex(2, 2, 2)] + [np.ones(3, dtype=np.int64)]:
            places.append((2 * cells + corner) * step)
            sides.append(np.full(len(cells), root * 0.5**level))
    every, side = np.concatenate(places), np.concatenate(sides)
    if last > DEEPEST_KEY:
        order = np.argsort(side, kind="stable")
        first = order[group_rows(every[order])[1]]
        return every[first], side[first], root * 0.5 ** (last + 1), low
    bits = DEEPEST_KEY + 3
    key = (every[:, 0] << 2 * bits) | (every[:, 1] << bits) | every[:, 2]
    order = np.lexsort((side, key))
    key = key[order]
    first = order[np.append(True, key[1:] != key[:-1])] if len(key) else order
    return every[first], side[first], root * 0.5 ** (last + 1), low


def _hashed(places: NDArray[np.int64]) -> Array:
    """Three numbers between -1 and 1 for each place, the same in each run."""
    x, y, z = (places.astype(np.uint64) + np.uint64(1 << 40)).T
    found = np.empty((len(places), 3))
    with np.errstate(over="ignore"):
        key = (
            x * np.uint64(0x9E3779B97F4A7C15)
            ^ y * np.uint64(0xC2B2AE3D27D4EB4F)
            ^ z * np.uint64(0x165667B19E3779F9)
        )
        for k in range(3):
            key = (key ^ (key >> np.uint64(31))) * np.uint64(0xBF58476D1CE4E5B9)
            key = (key ^ (key >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
            found[:, k] = (key >> np.uint64(11)) * 2.0**-52 - 1.0
    return found


def _near(shell: Shell, domain: Domain, rows: Array, reach: Array) -> NDArray[np.bool_]:
    """Whether points are nearer than ``reach`` to a triangle, a segment or a vertex of the body."""
    near = np.zeros(len(rows), dtype=np.bool_)
    used = np.zeros(len(domain.points), dtype=bool)
    used[shell.triangles.ravel()], used[shell.segments.ravel()] = True, True
    loose = np.flatnonzero(~used)
    simplices = np.concatenate([shell.triangles, shell.segments[:, [0, 1, 1]], np.stack([loose] * 3, axis=1)])
    corners = np.ascontiguousarray(shell.points[simplices])
    if len(rows) and len(corners):
        tree = BoxTree(*bounding_boxes(corners))
        query, hit = tree.pairs(rows - reach[:, None], rows + reach[:, None])
        factor = power_of_two(corners)  # fourth powers of very small or large lengths are no doubles
        _measure(rows * factor, reach * factor, corners * factor, query, hit, near)
    return near


@kernel
def _measure(rows, reach, corners, query, hit, near):
    for i in range(query.shape[0]):
        q = query[i]
        if not near[q] and square_from_triangle(rows[q], corners[hit[i]]) < reach[q] * reach[q]:
            near[q] = True
