"""A triangle mesh as the start of a refinement: its boundary and marked edges become subsegments."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET
from ...base.arrays import distinct, frozen
from ...base.errors import InputError, MeshError
from ...base.jit import lean
from ...connect.insertion.halfedges import SEGMENTS
from ...connect.planar.complex import PlanarComplex
from ...connect.planar.inserting import insert_all
from ...geometry.edge_vectors import content, lengths
from ...mesh.domain_mesh import DomainMesh
from ...mesh.grouping import group_rows
from ...mesh.marked import marked_sides
from ...mesh.mesh import Mesh, is_planar
from ...mesh.naming import names_by_number
from ...mesh.periodic import renumbered
from ...predicates.batch import orient
from ..boundary.kept import SplitBoundary
from .encroachment import STRAIGHT
from .matched import NO_PARTS, Cut, Longest, Matched, Parts, cut, longest_edges, matched_edges
from .run import Planned

__all__ = ["by_name", "carry", "plan_mesh"]

STRAIGHT_TURN = 1e-9  # radians: edges whose directions differ by less are parts of one straight piece


def plan_mesh(
    mesh: Mesh,
    *,
    size: Any = None,
    max_area: Any = None,
    split_boundary: SplitBoundary = True,
    budget: int | None = None,
) -> Planned:
    """The constrained Delaunay triangulation of a mesh's vertices and of the edges that must stay.

    Parameters
    ----------
    mesh : Mesh
        Counterclockwise triangles in the plane.
    size, max_area, split_boundary, budget
        As for `refine`. Edges that match (``mesh.periodic``) are cut already as far as these ask for it, and
        are to be kept then: ``rest["held"]`` has their pieces.

    Returns
    -------
    Planned
        Cells with equal values of all cell markers have the same region. Its name is that of the value of
        the marker "region", if there is one, or else the value. Pieces are straight chains of edges with
        equal markers.

    Raises
    ------
    MeshError
        For other meshes, for cells that are not counterclockwise, and for cells that overlap.
    """
    _judge(mesh)
    used, place = _used(mesh)
    values, group = _groups(mesh)
    edges, left, right, (kinds, sets) = _constraints(mesh, group)
    links = matched_edges(mesh, edges)
    labels = np.column_stack([kinds, left < 0, right < 0, links.label])
    ends, chain, span, flipped = chains(mesh.points, edges, labels)
    left, right = np.where(flipped, right, left), np.where(flipped, left, right)
    joints = _joints(ends, span, chain)
    outer = (left < 0) | (right < 0)
    inner = np.bincount(chain, outer) == 0
    order = np.argsort(inner, kind="stable")  # facets first
    number = np.empty(len(order), dtype=np.int32)
    number[order] = np.arange(len(order))
    chain, joints = number[chain], joints[order]
    called = names_by_number(mesh.regions)
    names: list[Any] = [""] * len(values)
    if "region" in mesh.markers:
        names = [called.get(row["region"], row["region"]) for row in values]
    pieces = _Pieces(ends, chain, span, left, right)
    some = links.without(outer if split_boundary == "inner" else np.full(len(ends), not split_boundary))
    longest = longest_edges(names, size, max_area) if len(some.first) else None
    c, cut_ = _cut_complex(mesh, used, place, pieces, some, longest, budget)
    place = np.append(place, len(used) + np.arange(len(cut_.points), dtype=np.int32))
    inputs = np.ones(len(used), dtype=bool)
    inputs[place[pieces.ends]], inputs[place[joints]] = False, True
    held = np.zeros(len(joints), dtype=bool)
    held[chain[links.label > 0]] = True
    return Planned(
        c, names, place[joints].astype(np.int32), np.full(len(joints), STRAIGHT, np.int8),
        np.zeros((len(joints), 5)), _never, {
            "inputs": np.flatnonzero(inputs),
            "values": values,
            "held": held,
            "periodic": renumbered(cut_.periodic, place),
            "mesh": {
                "facets": int((~inner).sum()), "origin": mesh.origin[used],
                "points": np.concatenate([mesh.points[used], cut_.points]),
                "markers": {name: np.unique(chain[part]) for name, part in zip(_names(mesh), sets)},
            },
        },
    )  # fmt: skip


class _Pieces(NamedTuple):
    """The edges that stay, as parts of straight pieces, and the groups of cells on their sides."""

    ends: NDArray[np.int32]
    chain: NDArray[np.int32]
    span: NDArray[np.float64]
    left: NDArray[np.int64]
    right: NDArray[np.int64]

    def cut(self, parts: Parts) -> _Pieces:
        """The same with some edges replaced by parts of them."""
        stay = np.setdiff1d(np.arange(len(self.ends)), parts.edge)
        rows = np.concatenate([stay, parts.edge])
        low, high = self.span[parts.edge].T
        inside = low[:, None] + parts.span * (high - low)[:, None]
        return _Pieces(
            np.concatenate([self.ends[stay], parts.ends.astype(np.int32)]), self.chain[rows],
            np.concatenate([self.span[stay], inside]), self.left[rows], self.right[rows],
        )  # fmt: skip


def _cut_complex(
    mesh: Mesh, used: NDArray[np.int64], place: NDArray[np.int32], pieces: _Pieces, links: Matched,
    longest: Longest | None, budget: int | None,
) -> tuple[PlanarComplex, Cut]:  # fmt: skip
    """The complex with matched edges cut; or whole, if rounded points on them are in the way of others."""
    whole = Cut(np.empty((0, 2)), NO_PARTS, mesh.periodic)
    if longest is not None:
        sides = np.column_stack([pieces.left, pieces.right])
        most = max((DEFAULT_BUDGET if budget is None else budget) - len(used), 0)
        found = cut(mesh, pieces.ends, sides, links, longest, most)
        try:
            return _complex(mesh, used, place, pieces.cut(found.parts), found.points), found
        except MeshError:
            pass
    return _complex(mesh, used, place, pieces, whole.points), whole


def _complex(
    mesh: Mesh, used: NDArray[np.int64], place: NDArray[np.int32], pieces: _Pieces, new: NDArray[np.float64]
) -> PlanarComplex:
    """The triangulation of the vertices and new points with these pieces, its regions marked."""
    ends = np.append(place, len(used) + np.arange(len(new), dtype=np.int32))[pieces.ends]
    try:
        c = PlanarComplex(np.concatenate([mesh.points[used], new]))
        insert_all(c, ends, pieces.chain, pieces.span, facets=-1)
    except InputError as error:
        raise MeshError(f"cells of the mesh overlap: among the vertices that are used, {error}") from error
    if c.segments != len(ends):
        raise MeshError("a vertex of the mesh lies on an edge of which it is not an end: see unstruct.check")
    _color(c, pieces.left, pieces.right)
    _compare(mesh, c)
    return c


def by_name(mesh: Mesh, value: Any) -> Any:
    """A limit by region with the names of regions instead of their numbers, where they have names."""
    if not isinstance(value, Mapping):
        return value
    called = names_by_number(mesh.regions)
    found = {called.get(key, key): limit for key, limit in value.items()}
    if len(found) < len(value):
        twice = next(key for key in value if called.get(key, key) != key)
        raise InputError(f"region {called[twice]!r} is named twice: by its name, and by its number {twice}")
    return found


def _never(piece: NDArray[Any], t: NDArray[np.float64]) -> NDArray[np.float64]:
    raise AssertionError("all pieces of a mesh are straight")


def _judge(mesh: Mesh) -> None:
    if not is_planar(mesh) or mesh.size == 0:
        raise MeshError(f"refine needs a Domain or a triangle mesh of the plane, not {mesh!r}")
    turned = np.asarray(orient(mesh.corners)) <= 0
    if turned.any():
        t = int(np.argmax(turned))
        raise MeshError(
            f"simplices[{t}] = {mesh.simplices[t].tolist()} is not counterclockwise: see mesh.oriented()"
        )


def _used(mesh: Mesh) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """The vertices that cells use, and the place of each vertex among them."""
    mask = np.zeros(len(mesh.points), dtype=bool)
    mask[mesh.simplices.ravel()] = True
    return np.flatnonzero(mask), np.cumsum(mask, dtype=np.int32) - np.int32(1)


def _names(mesh: Mesh) -> list[str]:
    return [k for k, rows in mesh.markers.items() if rows.ndim == 2 and rows.shape[1] == 2 and k not in _OWN]


_OWN = ("facets", "inner")  # made anew by `PlanarComplex.mesh`


def _groups(mesh: Mesh) -> tuple[list[dict[str, Any]], NDArray[np.int64]]:
    """The different combinations of values of cell markers, and the number of that of each cell."""
    names = [name for name, rows in mesh.markers.items() if rows.ndim == 1]
    columns = [np.unique(mesh.markers[name], return_inverse=True)[1] for name in names]
    table = np.stack(columns, axis=1) if columns else np.zeros((mesh.size, 1), dtype=np.int64)
    _, first, group = np.unique(table, axis=0, return_index=True, return_inverse=True)
    rows = [{name: mesh.markers[name][t].item() for name in names} for t in first]
    return rows, group.reshape(-1)


def _constraints(
    mesh: Mesh, group: NDArray[np.int64]
) -> tuple[NDArray[np.int32], NDArray[np.int64], NDArray[np.int64], Any]:
    """Edges (a < b) that must stay, the groups of cells on the left and right, and `_named_edges`."""
    n = len(mesh.points)
    stay = (mesh.neighbors < 0) | (group[mesh.neighbors] != group[:, None])
    named = {name: rows for name, rows in mesh.markers.items() if rows.ndim == 2 and rows.shape[1] == 2}
    if named:  # all at once: there may be thousands
        every = np.concatenate(list(named.values()))
        sides, found = marked_sides(mesh.simplices, every, n)
        if not found.all():
            row = int(np.argmin(found))
            name = list(named)[
                int(np.searchsorted(np.cumsum([len(r) for r in named.values()]), row, "right"))
            ]
            raise MeshError(f"markers[{name!r}]: {every[row].tolist()} is not an edge of the mesh: drop it")
        stay |= sides
    cells, corner = np.nonzero(stay)
    start, end = (mesh.simplices[cells, (corner + k) % 3].astype(np.int64) for k in (1, 2))
    key, where = np.unique(np.minimum(start, end) * n + np.maximum(start, end), return_inverse=True)
    side = np.full((2, len(key)), -1, dtype=np.int64)
    side[(start > end).astype(int), where] = group[cells]
    edges = np.column_stack([key // n, key % n]).astype(np.int32)
    return edges, side[0], side[1], _named_edges(mesh, key)


def _named_edges(mesh: Mesh, key: NDArray[np.int64]) -> tuple[NDArray[np.int64], list[NDArray[np.int64]]]:
    """A number for the set of markers of each edge, and the edges of each marker, which ``key`` contains."""
    names = _names(mesh)
    if not names:
        return np.zeros(len(key), dtype=np.int64), []
    edges = [np.sort(mesh.markers[name].astype(np.int64), axis=1) for name in names]
    rows = [ends[:, 0] * len(mesh.points) + ends[:, 1] for ends in edges]
    owner = np.repeat(np.arange(len(names)), [len(part) for part in rows])
    edge, owner = np.divmod(
        distinct(np.searchsorted(key, np.concatenate(rows)) * len(names) + owner), len(names)
    )
    count = np.bincount(edge, minlength=len(key))
    table = np.full((len(key), max(int(count.max(initial=0)), 1)), -1)
    table[edge, np.arange(len(edge)) - (np.cumsum(count) - count)[edge]] = owner
    order = np.argsort(owner, kind="stable")
    sets = np.split(edge[order], np.searchsorted(owner[order], np.arange(1, len(names))))
    return group_rows(table)[0], sets


# --- straight chains -------------------------------------------------------------------------------


def chains(
    points: NDArray[np.float64], edges: NDArray[np.int32], labels: NDArray
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64], NDArray[np.bool_]]:
    """Edges as parts of straight pieces: ends along the piece, its number, parameters; which are reversed."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    m = len(edges)
    vertex, edge = edges.ravel(), np.repeat(np.arange(m), 2)
    order = np.argsort(vertex, kind="stable")
    vertex, edge = vertex[order], edge[order]
    head = np.flatnonzero(np.diff(vertex, prepend=-1))
    two = head[np.diff(np.append(head, len(vertex))) == 2]
    v, e, f = vertex[two], edge[two], edge[two + 1]
    u, w = (_direction(points[edges[k].sum(axis=1) - v] - points[v]) for k in (e, f))
    cross, dot = u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0], (u * w).sum(axis=1)
    join = (np.abs(cross) <= -STRAIGHT_TURN * dot) & (labels[e] == labels[f]).all(axis=1)
    graph = coo_matrix((np.ones(join.sum()), (e[join], f[join])), shape=(m, m))
    chain = connected_components(graph, directed=False)[1].astype(np.int32)
    span, flipped = _spans(points, edges, chain)
    lost = span[:, 0] >= span[:, 1]
    if lost.any():  # parameters of the whole chain cannot tell the ends of its shortest edges apart
        alone = np.isin(chain, chain[lost])
        chain = np.unique(np.where(alone, m + np.arange(m), chain), return_inverse=True)[1].astype(np.int32)
        span, flipped = _spans(points, edges, chain)
    ends = np.where(flipped[:, None], edges[:, ::-1], edges)
    return np.ascontiguousarray(ends, dtype=np.int32), chain, span, flipped


def _direction(edges: NDArray[np.float64]) -> NDArray[np.float64]:
    return edges / lengths(edges)[:, None]


def _spans(
    points: NDArray[np.float64], edges: NDArray[np.int32], chain: NDArray[np.int32]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The parameters of the ends of each edge on its straight chain, sorted; which edges run against it."""
    m = len(edges)
    longest = np.lexsort((np.arange(m), chain))
    lead = longest[np.flatnonzero(np.diff(chain[longest], prepend=-1))]  # an edge that gives the direction
    start = points[edges[lead, 0]]
    direction = _direction(points[edges[lead, 1]] - start)[chain]
    along = ((points[edges] - start[chain, None]) * direction[:, None]).sum(axis=2)
    flipped = along[:, 0] > along[:, 1]
    along = np.sort(along, axis=1)
    low, high = np.full(len(lead), np.inf), np.full(len(lead), -np.inf)
    np.minimum.at(low, chain, along[:, 0])
    np.maximum.at(high, chain, along[:, 1])
    return (along - low[chain, None]) / (high - low)[chain, None], flipped


def _joints(ends: NDArray, span: NDArray, chain: NDArray) -> NDArray[np.int32]:
    """The end vertices of each chain."""
    joints = np.empty((int(chain.max()) + 1, 2), dtype=np.int32)
    for column, t in ((0, 0.0), (1, 1.0)):
        rows = span[:, column] == t
        joints[chain[rows], column] = ends[rows, column]
    return joints


# --- regions ---------------------------------------------------------------------------------------


@lean
def _spread(twin, mark, region, count, stack):
    """Spread the numbers of regions across unmarked edges; False if two different ones meet."""
    size = 0
    for t in range(count):
        if region[t] >= 0:
            stack[size] = t
            size += 1
    while size > 0:
        size -= 1
        t = stack[size]
        for k in range(3):
            if mark[3 * t + k] < 0:
                o = twin[3 * t + k] // 3
                if region[o] < 0:
                    region[o] = region[t]
                    stack[size] = o
                    size += 1
                elif region[o] != region[t]:
                    return False
    return True


def _color(c: PlanarComplex, left: NDArray, right: NDArray) -> None:
    """Give every triangle the group of the cells that lie on the same side of the edges that stay."""
    half = c.where[: c.state[SEGMENTS]]
    for side, group in ((half, left), (c.twin[half], right)):
        rows = group >= 0
        c.region[side[rows] // 3] = group[rows]
    if not _spread(c.twin, c.mark, c.region, c.triangles, np.empty(c.triangles, dtype=np.int32)):
        raise MeshError("cells of the mesh overlap: see unstruct.check")


def _compare(mesh: Mesh, c: PlanarComplex) -> None:
    """Raise if cells overlap without crossing boundaries: then their area is too large."""
    rows = c.vertex[: 3 * c.triangles].reshape(-1, 3)[c.kept()]
    if (rows < 0).any():
        raise MeshError("the boundary of the mesh does not close: see unstruct.check")
    area = float(content(c.xy[rows[:, 1:]] - c.xy[rows[:, :1]]).sum() / 2)  # scaled, as doubles hold it
    corners = mesh.corners * c.factor
    cells = float(content(corners[:, 1:] - corners[:, :1]).sum() / 2)
    if abs(area - cells) > 1e-9 * cells and (
        _exact_area(mesh.points, mesh.simplices) != _exact_area(mesh.points[_used(mesh)[0]], rows)
    ):
        raise MeshError(
            f"cells of the mesh overlap: their area is {cells / c.factor / c.factor}, that of the region "
            f"{area / c.factor / c.factor}; see unstruct.check"
        )


def _exact_area(points: NDArray[np.float64], triangles: NDArray[np.integer]) -> Fraction:
    """Twice the sum of signed areas, for thin triangles whose area in doubles is only rounding."""
    total = Fraction(0)
    for triangle in points[triangles].tolist():
        (ax, ay), (bx, by), (cx, cy) = ((Fraction(x), Fraction(y)) for x, y in triangle)
        total += (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return total


def carry(mesh: Mesh, planned: Planned, result: DomainMesh) -> None:
    """Give the refined mesh the markers of cells and vertices of the given mesh, and its pairs."""
    group = result.markers.pop("region")
    values = planned.rest["values"]
    for name in values[0]:
        result.markers[name] = frozen(np.array([row[name] for row in values])[group])
    result.regions = mesh.regions.copy()
    result.periodic = planned.rest["periodic"]
    place = np.full(len(mesh.points), -1, dtype=np.int32)
    used = _used(mesh)[0]
    place[used] = np.arange(len(used))  # the first vertices of the result, in the same order
    for name, rows in mesh.markers.items():
        if rows.ndim == 2 and rows.shape[1] == 1:
            result.markers[name] = frozen(place[rows][place[rows[:, 0]] >= 0])
