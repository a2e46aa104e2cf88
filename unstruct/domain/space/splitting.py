"""One round of splitting in the repair of a surface: at vertices on facets, along edges in their planes."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.triangle_pairs import (
    EDGES_CROSS,
    Meetings,
    clear_view,
    points_on_edges,
    points_on_triangles,
    turn,
    unit_points,
)
from .cutting import Shell, at, place
from .faults import crossing_place
from .flat import sides_of, triangulated
from .overlaps import Arrangement, Group, arranged, groups_in_planes, in_plane

__all__ = ["Splitting"]

Touches = dict[int, list[tuple[int, int]]]  # triangle -> vertices on it, with their places


class Splitting:
    """A round of splitting.

    Parameters
    ----------
    repairer : SpaceRepairer
        It is told what goes, what comes, and why.
    shell : Shell
    edges : (e, 2) int32
        The edges of the triangles, then the inner segments.
    met : Meetings

    Attributes
    ----------
    stuck : list of Group
        Groups that have no exact arrangement.
    """

    def __init__(self, repairer: Any, shell: Shell, edges: np.ndarray, met: Meetings):
        self.repairer, self.shell, self.edges, self.met = repairer, shell, edges, met
        self.xyz = unit_points(repairer.points)
        self.gone = np.zeros(len(repairer.polygons), dtype=bool)
        self.rings: list[Any] = []
        self.sources: list[int] = []
        self.labels: dict[int, int] = {}
        self.fresh: dict[tuple[float, ...], int] = {}
        self.stuck: list[Group] = []

    def run(self) -> bool:
        """Split what is to be split; return whether there was anything."""
        repairer, shell = self.repairer, self.shell
        in_use = np.zeros(len(repairer.points), dtype=bool)
        in_use[repairer.polygons.vertices] = True
        live = np.flatnonzero(in_use | ~(repairer.used | repairer.gone))
        on: Touches = {}
        if len(shell.triangles):
            for v, t, where in zip(
                *map(np.ndarray.tolist, points_on_triangles(repairer.points, live, shell.triangles))
            ):
                on.setdefault(t, []).append((v, where))
        kept = self._arrange(on)
        for row in sorted({int(shell.piece[t]) for t in on} - kept):
            self._split_piece(row, on)
        self._split_segments(live)
        self._mark_crossings()
        if not self.gone.any() and not self.fresh:
            return False
        if self.fresh:
            more = np.array(list(self.fresh))
            repairer.points = np.concatenate([repairer.points, more])
            repairer.gone = np.concatenate([repairer.gone, np.zeros(len(more), dtype=bool)])
            repairer.used = np.concatenate([repairer.used, np.zeros(len(more), dtype=bool)])
        repairer.exchange(self.gone, self.rings, self.sources, self.labels)
        return True

    def _add(self, ring: Any, source: int) -> None:
        self.rings.append([ring])
        self.sources.append(source)

    # ------------------------------------------------------------------ groups in a plane

    def _arrange(self, on: Touches) -> set[int]:
        """Replace groups by their arrangements; return the rows of all groups."""
        repairer, shell = self.repairer, self.shell
        rows: set[int] = set()
        for group in groups_in_planes(shell, repairer.polygons, self.edges, self.met):
            rows.update(group.rows)
            bent = [row for row in group.rows if not self._is_flat(row)]
            if bent:  # such a polygon is its triangles, which are flat
                for row in bent:
                    self._explode(row)
                continue
            touching = sorted(
                {v for row in group.rows for t in self._triangles(row) for v, _ in on.get(t, ())}
            )
            found = arranged(repairer.points, repairer.polygons, group, np.array(touching, dtype=np.int32))
            if found is None:
                self.stuck.append(group)
            else:
                self._take(group, found)
        return rows

    def _triangles(self, row: int) -> range:
        first, last = np.searchsorted(self.shell.piece, [row, row + 1])
        return range(int(first), int(last))

    def _is_flat(self, row: int) -> bool:
        first = self.shell.triangles[self._triangles(row)[0]]
        return in_plane(self.xyz, first, tuple(self.repairer.polygons.vertices_of(row).tolist()))

    def _explode(self, row: int) -> None:
        text = (
            f"{self.repairer.called(row)} is met in its plane, which is not exact; it was cut into triangles"
        )
        where = place(self.repairer.points[self.repairer.polygons.vertices_of(row)[0]])
        self.repairer.account("edge in a facet", text, where, [row])
        self.gone[row] = True
        for t in self._triangles(row):
            self._add(self.shell.triangles[t], row)

    def _take(self, group: Group, found: Arrangement) -> None:
        """The parts of an arrangement that bound, or are inner, as pieces."""
        repairer, shell = self.repairer, self.shell
        n, number = len(repairer.points), {}
        for k, row in enumerate(found.fresh):
            number[n + k] = self.fresh.setdefault(place(row), n + len(self.fresh))
        dropped = 0
        i, j = found.view // 3, found.view % 3
        for part, rows in zip(found.parts.tolist(), found.covers):
            facets = [row for row in rows if repairer.facet[row]]
            kept = facets if len(facets) % 2 else [row for row in rows if not repairer.facet[row]]
            if not kept:
                dropped += 1
                continue
            ahead = turn(self.xyz, i, j, *shell.triangles[self._triangles(kept[0])[0]]) > 0
            ring = [number.get(v, v) for v in part]
            self.labels[len(self.rings)] = repairer.named(rows)
            self._add(ring if ahead else ring[::-1], kept[0])
        self.gone[group.rows] = True
        corners = np.concatenate([repairer.polygons.vertices_of(row) for row in group.rows])
        middle = place(repairer.points[corners].mean(axis=0))
        if len(group.rows) == 1:
            text = f"sides of others lie in {repairer.called(group.rows[0])}, which was cut along them"
            repairer.account("edge in a facet", text, middle, group.rows)
            return
        text = (
            f"{repairer.called_all(group.rows)} overlap in a plane; they were cut along each other's sides, "
            f"and {dropped} triangles in an even number of them were dropped"
        )
        repairer.account("overlap", text, middle, group.rows)

    def _mark_crossings(self) -> None:
        """If there is nothing else to do, new vertices where edges cross, if the places are doubles."""
        if self.gone.any():
            return
        points, triangles = self.repairer.points, self.shell.triangles
        for e, t in zip(*(part[self.met.kind == EDGES_CROSS].tolist() for part in self.met[:2])):
            p, q = self.edges[e].tolist()
            exact = crossing_place(points, p, q, triangles[t])
            where = tuple(map(float, exact))
            if all(x == y for x, y in zip(exact, where)) and where not in self.fresh:
                self.fresh[where] = len(points) + len(self.fresh)
                text = (
                    f"edges cross {at(np.array(where))}; a vertex was put there (inside is what an odd "
                    "number of facets encloses)"
                )
                rows = [int(self.shell.piece[t])]
                self.repairer.account("crossing", text, where, rows)

    # ------------------------------------------------------------------ vertices on pieces

    def _split_piece(self, row: int, on: Touches) -> None:
        """Split a polygon or triangle at the vertices on it."""
        triangles = self._triangles(row)
        touches = [(t, v, where) for t in triangles for v, where in on.get(t, ())]
        for v in dict.fromkeys(v for _, v, _ in touches):
            name = self.repairer.point(v)
            text = f"{name} lies on {self.repairer.called(row)}, which was split there"
            self.repairer.account("vertex on a facet", text, place(self.repairer.points[v]), [row], [v])
        self.gone[row] = True
        rings = self._with_vertices(row, touches) if len(triangles) > 1 else None
        if rings is not None:
            self.rings.append(rings)
            self.sources.append(row)
            return
        for t in triangles:
            for ring in self._split_triangle(t, on.get(t, [])):
                self._add(ring, row)

    def _with_vertices(self, row: int, touches: list[tuple[int, int, int]]) -> Any:
        """The rings of a polygon with vertices on its sides; None if one is inside, or it is not flat."""
        polygons = self.repairer.polygons
        corners = self.shell.triangles
        sides: dict[tuple[int, int], set[int]] = {}
        for ring in polygons.rings(row):
            for pair in sides_of((ring,)).tolist():
                sides[min(pair), max(pair)] = set()
        for t, v, where in touches:
            if where == 1:
                return None
            u, w = sorted(corners[t, [(where - 1) % 3, where % 3]].tolist())
            if (u, w) not in sides:
                return None
            sides[u, w].add(v)
        if not self._is_flat(row):
            return None
        result = []
        for ring in polygons.rings(row):
            new: list[int] = []
            for u, w in sides_of((ring,)).tolist():
                new += [u, *self._along(u, w, sides[min(u, w), max(u, w)])]
            result.append(new)
        return result

    def _along(self, u: int, w: int, vertices: Any) -> list[int]:
        """Vertices between u and w, in order."""
        points = self.repairer.points
        chain = sorted({u, w, *vertices}, key=lambda v: tuple(points[v].tolist()))
        return (chain if chain[0] == u else chain[::-1])[1:-1]

    def _split_triangle(self, t: int, touches: list[tuple[int, int]]) -> list[Any] | NDArray[np.int32]:
        corners = self.shell.triangles[t].tolist()
        on: list[list[int]] = [[], [], []]
        inside: list[int] = []
        for v, where in touches:
            (inside if where == 1 else on[where - 2]).append(v)
        if not inside and sum(map(bool, on)) <= 1:  # a fan, seen from the vertex opposite
            k = next((k for k in range(3) if on[k]), 0)
            top, u, w = corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]
            return [[top, *pair] for pair in pairwise([u, *self._along(u, w, on[k]), w])]
        ring: list[int] = []
        for k in (2, 0, 1):
            u, w = corners[(k + 1) % 3], corners[(k + 2) % 3]
            ring += [u, *self._along(u, w, on[k])]
        view = int(clear_view(self.xyz, *corners))
        sides = sides_of((np.array(ring),))
        found, wrong = triangulated(self.xyz, sides, view, also=np.array(inside, dtype=np.int32))
        assert wrong is None, wrong
        return found if turn(self.xyz, view // 3, view % 3, *corners) > 0 else found[:, ::-1]

    def _split_segments(self, live: np.ndarray) -> None:
        shell = self.shell
        if len(shell.segments) == 0:
            return
        inside: dict[int, list[int]] = {}
        points = self.repairer.points
        for v, s in zip(*map(np.ndarray.tolist, points_on_edges(points, live, shell.segments))):
            inside.setdefault(s, []).append(v)
        for s, vertices in inside.items():
            row, (p, q) = int(shell.segment_piece[s]), shell.segments[s].tolist()
            for v in vertices:
                text = f"{self.repairer.point(v)} lies on {self.repairer.called(row)}, which was split there"
                self.repairer.account("vertex on a segment", text, place(points[v]), [row], [v])
            self.gone[row] = True
            for pair in pairwise([p, *self._along(p, q, vertices), q]):
                self._add(list(pair), row)
