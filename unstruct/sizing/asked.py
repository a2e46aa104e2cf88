"""Whether a finished mesh keeps to a size at the places where it is asked, once more, of the size itself.

Methods read a table of the size, which may have missed a small feature between its samples. So in the end the
size is asked again where the mesh is: in the middle of each cell, at each vertex, and at the landmarks of the
field. Where a field cannot change by more than a known growth, the answer in the middle of a
cell proves most of them without asking. See the book, 2.8c.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import distinct
from ..base.jit import kernel
from ..geometry.edge_vectors import lengths
from ..mesh.domain_mesh import DomainMesh
from ..mesh.locate import Locator
from ..mesh.mesh import Mesh
from ..predicates.batch import power_of_two
from .field import SizeField, as_size
from .metric import Metric

__all__ = ["COARSE_BOUNDARY", "MISSED_SIZE", "MUCH_LONGER", "asked_again", "too_large"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
MUCH_LONGER = 2.5  # edges more times as long as wanted miss the size
TRIES = 2  # how often a mesh is made again with the places where it missed the size
MISSED_SIZE = "large: asked once more, the size in it is much less than its edges"
COARSE_BOUNDARY = "; near a coarse boundary remesh that first, or give split_boundary=True"


class TooLarge(NamedTuple):
    """Cells that miss a size, and the places that tell so.

    Attributes
    ----------
    cells : (k,) int64
    places : (p, d) float64
    """

    cells: Integers
    places: Array


class _Seen(SizeField):
    """A field with further landmarks."""

    def __init__(self, field: SizeField, places: Array):
        marks = [field.landmarks] if field.landmarks.shape[1] == places.shape[1] else []
        super().__init__(
            field.function, landmarks=np.concatenate([*marks, places]), name=field.name, growth=field.growth
        )
        self.of = field

    @property
    def thorough(self) -> bool:  # type: ignore[override]
        return self.of.thorough

    def below(self, x: Array, bound: Array) -> Array:
        return self.of.below(x, bound)


@kernel
def _measure(points, cells, rows, center, longest, reach):
    """For some cells the barycenter, the longest edge, and how far corners are from the barycenter."""
    d, k = points.shape[1], cells.shape[1]
    for i in range(rows.shape[0]):
        t = rows[i]
        for j in range(d):
            total = 0.0
            for a in range(k):
                total += points[cells[t, a], j]
            center[i, j] = total / k
        most = far = 0.0
        for a in range(k):
            away = 0.0
            for j in range(d):
                away += (points[cells[t, a], j] - center[i, j]) ** 2
            far = max(far, away)
            for b in range(a):
                square = 0.0
                for j in range(d):
                    square += (points[cells[t, a], j] - points[cells[t, b], j]) ** 2
                most = max(most, square)
        longest[i], reach[i] = np.sqrt(most), np.sqrt(far)


@kernel
def _shortest_at(points, cells, shortest):
    """The shortest edge at each vertex."""
    for t in range(cells.shape[0]):
        for a in range(cells.shape[1]):
            for b in range(a):
                u, v, square = cells[t, a], cells[t, b], 0.0
                for j in range(points.shape[1]):
                    square += (points[u, j] - points[v, j]) ** 2
                length = np.sqrt(square)
                shortest[u], shortest[v] = min(shortest[u], length), min(shortest[v], length)


def too_large(mesh: Mesh, size: Any, longer: float = MUCH_LONGER) -> TooLarge:
    """The cells of a mesh of simplices whose edges are much longer than wanted, by the size itself.

    Parameters
    ----------
    mesh : Mesh
    size : size, or mapping of region name to size
    longer : float
        How many times as long as wanted edges may be.

    Returns
    -------
    TooLarge
        Cells whose longest edge is too long for the size at the barycenter; those at vertices of which each
        edge is; and those with a landmark of the field for which each of their edges is.

    Notes
    -----
    Where the growth of a field is known, only barycenters are asked, if they prove that the size is nowhere
    in the cell less. O(n).
    """
    if mesh.size == 0:
        return TooLarge(np.empty(0, dtype=np.int64), np.empty((0, mesh.points.shape[1])))
    cells, places = [], []
    for field, rows in _by_region(mesh, size):
        if field.constant is None:
            found = _asked(mesh, field, rows, longer)
            cells.append(found.cells)
            places.append(found.places)
    if not cells:
        return TooLarge(np.empty(0, dtype=np.int64), np.empty((0, mesh.points.shape[1])))
    return TooLarge(distinct(np.concatenate(cells)), np.concatenate(places))


def _by_region(mesh: Mesh, size: Any) -> list[tuple[SizeField, Integers]]:
    """The fields with the cells for which they are."""
    every = np.arange(mesh.size)
    if size is None or isinstance(size, Metric):
        return []
    if not isinstance(size, Mapping):
        return [(as_size(size), every)]
    number = mesh.markers["region"]
    names = {k: name for name, k in mesh.regions.items()}
    found = []
    for k in np.unique(number).tolist():
        one = size.get(names.get(k), size.get(None))
        if one is not None and not isinstance(one, Metric):
            found.append((as_size(one), np.flatnonzero(number == k)))
    return found


def _asked(mesh: Mesh, field: SizeField, rows: Integers, longer: float) -> TooLarge:
    points, cells, factor = mesh.points, mesh.simplices, power_of_two(mesh.points)
    center, longest, reach = np.empty((len(rows), points.shape[1])), np.empty(len(rows)), np.empty(len(rows))
    _measure(points * factor, cells, rows, center, longest, reach)  # squares of lengths may be no doubles
    center, longest, reach = center / factor, longest / factor, reach / factor
    bound = longest / longer
    slack = np.zeros(len(rows)) if field.growth is None else field.growth * reach
    h = field.below(center, bound + slack)
    bad = h < bound
    still = ~bad if field.growth is None else (h < bound + slack) & ~bad
    found, places = [rows[bad]], [center[bad]]
    rest = rows[still]
    if len(rest):
        for more, x in (
            _at_vertices(points, cells, field, rest, longer),
            _at_landmarks(points, cells, field, rest, longer),
        ):
            found.append(more)
            places.append(x)
    return TooLarge(distinct(np.concatenate(found)), np.concatenate(places))


def _at_vertices(
    points: Array, cells: NDArray[np.int32], field: SizeField, rows: Integers, longer: float
) -> tuple[Integers, Array]:
    shortest = np.full(len(points), np.inf)
    factor = power_of_two(points)
    _shortest_at(points * factor, cells, shortest)
    shortest /= factor
    used = distinct(cells[rows])
    bound = shortest[used] / longer
    bad = used[field.below(points[used], bound) < bound]
    return rows[np.isin(cells[rows], bad).any(axis=1)] if len(bad) else rows[:0], points[bad]


def _at_landmarks(
    points: Array, cells: NDArray[np.int32], field: SizeField, rows: Integers, longer: float
) -> tuple[Integers, Array]:
    marks = field.landmarks
    if len(marks) == 0 or marks.shape[1] != points.shape[1]:
        return rows[:0], points[:0]
    own = cells[rows]
    low, high = points[own].min(axis=(0, 1)), points[own].max(axis=(0, 1))
    marks = marks[((marks >= low) & (marks <= high)).all(axis=1)]
    if len(marks) == 0:
        return rows[:0], points[:0]
    query, cell = Locator(Mesh(points, own, neighbors=None)).holding(np.ascontiguousarray(marks))
    shortest = np.full(len(own), np.inf)
    for i in range(own.shape[1]):
        for j in range(i):
            np.minimum(shortest, lengths(points[own[:, i]] - points[own[:, j]]), out=shortest)
    bound = shortest[cell] / longer
    bad = field.below(marks[query], bound) < bound
    return rows[cell[bad]], marks[query[bad]]


def _with_places(size: Any, places: Array) -> Any:
    if isinstance(size, Mapping):
        return {
            name: one if isinstance(one, Metric) else _with_places(one, places) for name, one in size.items()
        }
    field = as_size(size)
    return field if field.constant is not None else _Seen(field, places)


def asked_again(
    make: Callable[[Any], DomainMesh], size: Any, *, longer: float = MUCH_LONGER, again: bool = True
) -> DomainMesh:
    """A mesh whose account says where it misses the size, made again where that helps.

    Parameters
    ----------
    make : callable
        Makes the mesh for a size.
    size : size, or mapping of region name to size
    longer : float
        As for `too_large`.
    again : bool
        Whether the mesh is made again, at most twice, with a size that has the places where it was missed as
        landmarks; not where a budget was spent.

    Returns
    -------
    DomainMesh
        Cells that miss the size are in ``unrefined``.
    """
    mesh = make(size)
    if size is None:
        return mesh
    for tries in range(TRIES + 1):
        found = too_large(mesh, size, longer)
        if len(found.cells) == 0:
            return mesh
        # Near cells that are listed already (at facets that stay, say) places are known, and do not help.
        spent = bool((mesh.reasons == "budget").any())
        new = np.setdiff1d(found.cells, mesh.unrefined)
        near = np.zeros(len(mesh.points), dtype=bool)
        near[mesh.simplices[mesh.unrefined]] = True
        if not again or spent or tries == TRIES or near[mesh.simplices[new]].any(axis=1).all():
            break
        size = _with_places(size, found.places)
        mesh = make(size)
    return _listed(mesh, found.cells)


def _listed(mesh: DomainMesh, cells: Integers) -> DomainMesh:
    why = dict.fromkeys(cells.tolist(), MISSED_SIZE) | dict(
        zip(mesh.unrefined.tolist(), mesh.reasons.tolist())
    )
    rows = sorted(why)
    mesh.unrefined = np.array(rows, dtype=np.int32)
    mesh.reasons = np.array([why[cell] for cell in rows], dtype=str)
    return mesh
