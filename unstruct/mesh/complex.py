"""CellComplex: points and cells as flat arrays, their adjacency and counts, computed when asked for.

`Mesh` is built on it; it has what measures, searches and files need. See the book, chapter 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property, partial
from typing import Any

import numpy as np

from ..base.arguments import as_mapping
from ..base.arrays import INT32, as_points, as_weights, counted_off, distinct, frozen, refrozen, within
from ..base.checked import CheckedDict
from ..base.errors import InputError, MeshError
from . import topology
from .adjacency import facet_pairs, stars_of_cells, two_cells
from .cells import (
    as_cells,
    cell_dimension,
    counted,
    incident_edges,
    incident_facets,
    simplex_dimension,
    simplex_type,
)
from .naming import as_marker, as_region_names, as_region_number
from .periodic import Periodic, as_periodic, pairs_of

__all__ = ["NO_PAIRS", "CellComplex", "checked_markers", "checked_regions"]

NO_PAIRS, NO_VERTICES = frozen(np.empty((0, 2), dtype=np.int32)), frozen(np.empty(0, dtype=np.int32))


class CellComplex:
    """Points, cells, and the record of where the points came from, without any measures: see `Mesh`."""

    weights: np.ndarray | None = None
    hidden: np.ndarray = NO_VERTICES
    periodic: tuple[Periodic, ...] = ()

    def __init__(
        self,
        points: Any,
        simplices: Any = None,
        *,
        neighbors: Any = None,
        origin: Any = None,
        duplicates: Any = None,
        markers: Mapping[str, Any] | None = None,
        cells: Mapping[str, Any] | None = None,
        weights: Any = None,
        hidden: Any = None,
        regions: Mapping[str, int] | None = None,
        periodic: Iterable[Any] | None = None,
    ):
        self.points: np.ndarray = frozen(as_points(points))
        n, d = self.points.shape
        if (simplices is None) == (cells is None):
            raise InputError("give either simplices or cells")
        if simplices is not None:
            rows = frozen(topology.as_simplices(simplices, vertices=n))
            self.dimension: int = rows.shape[1] - 1
            self.cells: dict[str, Any] = {simplex_type(self.dimension): rows}
        else:
            self.cells = as_cells(cells or {}, n)
            self.dimension = cell_dimension(next(iter(self.cells)))
        if self.dimension > d:
            raise InputError(f"cells of dimension {self.dimension} cannot lie in {d} dimensions")
        if neighbors is not None:
            given = self._integers(neighbors, "neighbors", self.simplices.shape)
            if not within(given, self.size, -1):
                row = int(np.argmax(((given < -1) | (given >= self.size)).any(axis=1)))
                raise InputError(
                    f"neighbors[{row}] = {given[row].tolist()}: cells are 0..{self.size - 1}, or -1"
                )
            self.__dict__["neighbors"] = given
        self.origin: np.ndarray = counted_off(n) if origin is None else self._integers(origin, "origin", (n,))
        self.duplicates: np.ndarray = NO_PAIRS
        if duplicates is not None:
            self.duplicates = self._integers(duplicates, "duplicates", (None, 2))
            if not within(self.duplicates, n):
                raise InputError(f"duplicates refers to vertices outside 0..{n - 1}")
        if weights is not None:
            self.weights = frozen(as_weights(weights, n).copy())
        if hidden is not None:
            self.hidden = self._integers(hidden, "hidden", (None,))
            if not within(self.hidden[:, None], n):
                raise InputError(f"hidden refers to vertices outside 0..{n - 1}")
        self.markers: dict[str, np.ndarray] = checked_markers({}, self)
        if markers is not None:
            self.markers.update(as_mapping(markers, "markers"))
        self.regions: dict[str, int] = checked_regions({})
        if regions is not None and len(as_mapping(regions, "regions")):
            self.regions = checked_regions(as_region_names(regions, self.markers))
        if periodic is not None:
            self.periodic = as_periodic(periodic, n, d)

    @staticmethod
    def _integers(values: Any, name: str, shape: tuple[int | None, ...]) -> np.ndarray:
        try:
            array = np.asarray(values)
        except ValueError:  # ragged lists
            raise InputError(f"{name} must be an array of integers of shape {shape}") from None
        if array.dtype is INT32 and array.shape == shape and array.flags.c_contiguous:
            return frozen(array)
        if array.ndim != len(shape) or any(s is not None and s != a for s, a in zip(shape, array.shape)):
            raise InputError(f"{name} must have shape {shape}, not {array.shape}")
        if array.size and array.dtype.kind not in "iu":
            raise InputError(f"{name} must be integers, not {array.dtype}")
        if array.size and not (-(2**31) <= int(array.min()) <= int(array.max()) < 2**31):
            raise InputError(f"{name} has entries beyond 32 bits: there are no such vertices or cells")
        return frozen(np.ascontiguousarray(array, dtype=np.int32))

    @property
    def pairs(self) -> np.ndarray:
        """Vertices on sides that match (`Domain.matched`), and their images: int32, (k, 2), sorted.

        ``periodic`` has them motion by motion; a vertex at a corner may have several images.
        """
        return pairs_of(self.periodic)

    # ------------------------------------------------------------------ cells and adjacency

    @property
    def size(self) -> int:
        """The number of cells."""
        return sum(map(len, self.cells.values()))

    @property
    def is_simplicial(self) -> bool:
        """Whether all cells are simplices of one kind, so that `simplices` and `neighbors` exist."""
        return len(self.cells) == 1 and simplex_dimension(next(iter(self.cells))) is not None

    @property
    def simplices(self) -> np.ndarray:
        """The cells, int32 of shape (m, k + 1); `MeshError` if cells are of other or several kinds."""
        if not self.is_simplicial:
            raise MeshError(f"this mesh has cells of kind {', '.join(self.cells)}: use .cells")
        return next(iter(self.cells.values()))

    @cached_property
    def neighbors(self) -> np.ndarray:
        """``neighbors[t, i]``: the cell across the facet opposite vertex i of cell t, -1 for none.

        For simplices of one kind; `facet_cells` gives the same for cells of any kinds.
        """
        if not self.is_simplicial:
            raise MeshError(f"this mesh has cells of kind {', '.join(self.cells)}: use .facet_cells")
        return frozen(topology.neighbors(self.simplices))

    @cached_property
    def edges(self) -> np.ndarray:
        """Edges (i, j), i < j, in lexicographic order: int32, shape (e, 2)."""
        return frozen(topology.edges(self.simplices) if self.is_simplicial else incident_edges(self.cells))

    @cached_property
    def facets(self) -> np.ndarray:
        """Faces of codimension one, rows sorted, lexicographic: int32, shape (f, k).

        For kinds other than simplices the rows are as long as the largest facet that a cell may have, and
        shorter ones are padded by -1 at the end, as in `boundary`: triangles among quadrilaterals are
        (i, j, k, -1).
        """
        if self.is_simplicial:
            return frozen(topology.facets(self.simplices))
        return frozen(facet_pairs(self.cells)[0])

    @cached_property
    def facet_cells(self) -> np.ndarray:
        """The two cells of each facet: int32, shape (f, 2), in the order of `facets`.

        For cells of any kinds, numbered through the kinds in their order. The lower number comes first; on
        the boundary the second is -1.

        Raises
        ------
        MeshError
            If more than two cells share a facet; the message names the facets.
        """
        facets, pairs = two_cells(self.cells)
        self.__dict__.setdefault("facets", frozen(facets))
        return frozen(pairs)

    @cached_property
    def boundary(self) -> np.ndarray:
        """Facets with one cell, outward for positively oriented cells (2D: the mesh on the left).

        If facets have several sizes, shorter rows are padded by -1 at the end, as in `facets`.
        """
        if self.is_simplicial:
            return frozen(topology.boundary(self.simplices, self.neighbors))
        rows, _, group = incident_facets(self.cells)
        return frozen(rows[np.bincount(group)[group] == 1])

    @cached_property
    def vertex_neighbor_vertices(self) -> tuple[np.ndarray, np.ndarray]:
        """(indptr, indices): vertex v is joined to ``indices[indptr[v]:indptr[v + 1]]``, increasing."""
        if self.is_simplicial:
            return topology.vertex_neighbors(self.simplices, len(self.points))
        return topology.vertex_neighbors(self.edges, len(self.points))

    @cached_property
    def stars(self) -> tuple[np.ndarray, np.ndarray]:
        """(indptr, cells): vertex v belongs to the cells ``cells[indptr[v]:indptr[v + 1]]``, increasing."""
        if self.is_simplicial:
            return topology.stars(self.simplices, len(self.points))
        return stars_of_cells(self.cells, len(self.points))

    def face_counts(self) -> tuple[int, ...]:
        """(f_0, ..., f_k): used vertices, edges, ..., cells."""
        if self.is_simplicial:
            return topology.face_counts(self.simplices)
        used = len(distinct(self.edges))
        middle = [len(self.edges)] if self.dimension == 2 else [len(self.edges), len(self.facets)]
        return (used, *middle, self.size)

    @property
    def euler_characteristic(self) -> int:
        """f_0 - f_1 + f_2 - ...; 1 for a ball, 0 for an annulus, 2 for a sphere."""
        return sum((-1) ** j * f for j, f in enumerate(self.face_counts()))

    @property
    def corners(self) -> Any:
        """Coordinates of the cells' corners, shape (m, k + 1, d), as `unstruct.simplex` takes them.

        For other or several kinds a dictionary: kind -> shape (m, corners, d); for "polygon" a list of
        arrays (corners, d).
        """
        if self.is_simplicial:
            return self.points[self.simplices]
        return {
            name: [self.points[row] for row in block] if name == "polygon" else self.points[block]
            for name, block in self.cells.items()
        }

    def __len__(self) -> int:
        return self.size

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(refrozen(state))

    def __repr__(self) -> str:
        kinds = ", ".join(counted(len(block), name) for name, block in self.cells.items())
        extra = f", {len(self.duplicates)} duplicates" if len(self.duplicates) else ""
        extra += f", {len(self.hidden)} hidden" if len(self.hidden) else ""
        return f"<Mesh: {len(self.points)} points, {kinds} in {self.points.shape[1]}D{extra}>"


def checked_markers(markers: dict[str, np.ndarray], mesh: CellComplex) -> CheckedDict[np.ndarray]:
    """Markers that are right, to which others are added only if they are right, too."""
    check = partial(as_marker, size=mesh.size, vertices=len(mesh.points), padded=not mesh.is_simplicial)
    return CheckedDict(markers, "markers", check)


def checked_regions(regions: dict[str, int]) -> CheckedDict[int]:
    """Numbers of regions that are right, as `checked_markers`."""
    return CheckedDict(regions, "regions", as_region_number)
