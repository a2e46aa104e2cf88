"""Sizes by region: which region lies on each side of a piece, and which size each piece takes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...connect.planar.complex import PlanarComplex
from ...connect.planar.flood import mark_regions
from ...connect.planar.inserting import insert_all
from ...geometry.outline import Outline
from ...geometry.segment_tree import SegmentTree
from ...mesh.locate import Locator
from ...mesh.mesh import Mesh
from ...sizing.directions import as_metric, intersect_rows, intersection
from ...sizing.field import SizeField, as_size, minimum
from ...sizing.metric import InverseMetric, Metric
from ...sizing.metric_table import inverted
from .sample import Sampled

__all__ = ["PieceSizes", "no_entry", "per_region", "piece_sizes", "size_by_region"]


class PieceSizes(NamedTuple):
    """The size along each piece.

    Attributes
    ----------
    fields : list of SizeField, Metric or None
        None asks for no more subsegments than are safe.
    group : (p,) int
        The field of each piece.
    """

    fields: list[SizeField | Metric | None]
    group: np.ndarray

    def at(self, piece: np.ndarray, x: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """The sizes at points x (k, 2) of pieces (k,), in directions (k, 2); infinite without one."""
        if len(self.fields) == 1 and self.fields[0] is not None:
            return _size_along(self.fields[0], x, direction)
        sizes, group = np.full(len(x), np.inf), self.group[piece]
        for g, one in enumerate(self.fields):
            rows = np.flatnonzero(group == g)
            if one is not None and len(rows):
                sizes[rows] = _size_along(one, x[rows], direction[rows])
        return sizes

    def even(self) -> np.ndarray:
        """For which pieces the size is constant."""
        constant = [one is None or one.constant is not None for one in self.fields]
        return np.array(constant)[self.group]


def _size_along(field: SizeField | Metric, x: np.ndarray, direction: np.ndarray) -> np.ndarray:
    return field.along(x, direction) if isinstance(field, Metric) else field(x)


def size_or_metric(size: Any) -> SizeField | Metric:
    """A metric as it is, anything else as a size field."""
    return size if isinstance(size, Metric) else as_size(size)


def per_region(value: Any, names: list[str], what: str) -> list[Any]:
    """One value for each region: the same for all, or that of its name, or that of the key None.

    Without that key regions that are not named have the value None. Parts without a name are called "".
    """
    if not isinstance(value, Mapping):
        return [value] * len(names)
    known = set(names)
    unknown = [name for name in value if name is not None and name not in known]
    if unknown:
        raise InputError(
            f"{what} names region {unknown[0]!r}, but the regions of the domain are "
            f"{sorted(known - {''}, key=str)}; the key None stands for all that are not named"
        )
    rest = value.get(None)
    return [value.get(name, rest) for name in names]


def no_entry(name: str, x: np.ndarray) -> InputError:
    """The error for a region that has no size, with a place in it."""
    where = f"region {name!r}" if name else "a region without a name"
    place = ", ".join(f"{value:.6g}" for value in x.tolist())
    return InputError(
        f"size has no entry for {where} (near ({place})): give one, or a default by the key None"
    )


def region_names(regions: Mapping[str, Any], c: PlanarComplex) -> list[str]:
    """The names of all regions of a complex, by number; "" for those without."""
    return [*regions, *[""] * (c.parts() - len(regions))]


def piece_sizes(outline: Outline, sampled: Sampled, size: Mapping[Any, Any]) -> PieceSizes:
    """The size of each piece by regions: the smaller one of those on its two sides.

    Parameters
    ----------
    outline : Outline
    sampled : Sampled
        Its pieces, cut coarsely.
    size : mapping of name to size
    """
    c = PlanarComplex(sampled.points)
    facets = len(outline.facets)
    insert_all(c, sampled.ends, sampled.piece, sampled.span, facets=facets)
    mark_regions(c, facets, outline.regions, not facets)
    given = per_region(size, region_names(outline.regions, c), "size")
    fields = [None if one is None else size_or_metric(one) for one in given]
    half = c.where[: c.segments].astype(np.int64)
    sides = np.sort(np.stack([c.region[half // 3], c.region[c.twin[half] // 3]], axis=1), axis=1)
    low = np.full((len(outline.pieces), 2), -1, dtype=np.int64)
    low[c.piece[: c.segments]] = sides
    both, group = np.unique(low, axis=0, return_inverse=True)
    found = []
    for pair in both.tolist():
        own = [fields[r] for r in sorted(set(pair)) if r >= 0]
        wanted = [one for one in own if one is not None]
        both_of = intersection if any(isinstance(one, Metric) for one in wanted) else minimum
        found.append(both_of(*wanted) if len(wanted) > 1 else wanted[0] if wanted else None)
    return PieceSizes(found, group.reshape(-1))


def size_by_region(c: PlanarComplex, size: Any, names: Mapping[str, Any]) -> Any:
    """A size given by region as one field over a triangulated domain; any other size as it is.

    Parameters
    ----------
    c : PlanarComplex
        The triangulation that is to be refined, with its regions marked.
    size : size, or mapping of names to sizes
    names : mapping or sequence of str
        The named regions, in the order of their numbers.

    Returns
    -------
    SizeField or Metric
        At a point that lies in several regions the smallest of their sizes, or the intersection of their
        metrics; outside those of the region beside the nearest subsegment.

    Raises
    ------
    InputError
        For a region without a size.

    Notes
    -----
    O(log n) for each point.
    """
    if not isinstance(size, Mapping):
        return size
    called = region_names(dict.fromkeys(names), c)
    given = per_region(size, called, "size")
    number = c.region[: c.triangles]
    cells = c.vertex[: 3 * c.triangles].reshape(-1, 3)[number >= 0]
    number, xy = number[number >= 0], c.xy[: c.size] / c.factor
    for r, one in enumerate(given):
        if one is None:
            raise no_entry(called[r], xy[cells[int(np.argmax(number == r))]].mean(axis=0))
    metrics = [as_metric(one) for one in given] if any(isinstance(one, Metric) for one in given) else []
    fields = [] if metrics else [as_size(one) for one in given]
    constants = {field.constant for field in fields}
    if len(constants) == 1 and None not in constants:
        return fields[0]
    half = c.where[: c.segments].astype(np.int64)
    beside = np.maximum(c.region[half // 3], c.region[c.twin[half] // 3])
    rows = np.flatnonzero(beside >= 0)
    name = f"{len(set(size))} {'metrics' if metrics else 'sizes'} by region"
    regions = RegionMap(
        Locator(Mesh(xy, cells, neighbors=None)), number.copy(), SegmentTree(xy[c.ends[rows]]), beside[rows]
    )
    given = metrics or fields
    marks = [xy[cells].mean(axis=1), *[field.landmarks for field in given if len(field.landmarks)]]
    if metrics:
        function = partial(_metric_by_region, metrics, regions)
        return InverseMetric(function, landmarks=np.concatenate(marks), name=name)
    return SizeField(partial(_by_region, fields, regions), landmarks=np.concatenate(marks), name=name)


class RegionMap(NamedTuple):
    """Which regions there are at a point."""

    locator: Locator
    number: NDArray[np.int32]  # the region of each cell
    tree: SegmentTree
    beside: NDArray[np.int32]  # a region beside each segment of the tree

    def at(self, x: NDArray[np.float64]) -> Iterator[tuple[int, NDArray[np.int64]]]:
        """Each region, with the rows of the points that it contains; outside, the one beside the boundary."""
        query, cell = self.locator.holding(np.ascontiguousarray(x))
        region = self.number[cell]
        out = np.setdiff1d(np.arange(len(x)), query)
        if len(out):
            _, nearest = self.tree.least(x[out], 1.0)
            query, region = np.concatenate([query, out]), np.concatenate([region, self.beside[nearest]])
        for r in np.unique(region).tolist():
            yield r, np.unique(query[region == r])


def _by_region(fields: list[SizeField], regions: RegionMap, x: NDArray[np.float64]) -> NDArray[np.float64]:
    sizes = np.full(len(x), np.inf)
    for r, rows in regions.at(x):
        sizes[rows] = np.minimum(sizes[rows], fields[r](x[rows]))
    return sizes


def _metric_by_region(
    fields: list[Metric], regions: RegionMap, x: NDArray[np.float64]
) -> NDArray[np.float64]:
    found, seen = np.empty((len(x), 3)), np.zeros(len(x), dtype=bool)
    for r, rows in regions.at(x):
        matrices = inverted(fields[r].inverses(x[rows]))
        again = seen[rows]
        common = found[rows[again]]
        intersect_rows(common, matrices[again])
        matrices[again] = common
        found[rows], seen[rows] = matrices, True
    return inverted(found)
