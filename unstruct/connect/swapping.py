"""Lawson's diagonal swapping, which makes any planar triangulation Delaunay, or constrained Delaunay.

An edge with a triangle on both sides is *illegal* if the far corner of one triangle lies strictly inside the
circle of the other. The quadrilateral is then strictly convex, and swapping its diagonal lowers the surface
of the triangulation lifted to the paraboloid. So no edge that was swapped away ever returns, and n points
admit at most n (n - 1) / 2 swaps. A stack contains the edges that may be illegal.

Sources: C. L. Lawson, Software for C1 surface interpolation (1977); D. T. Lee and A. K. Lin, Generalized
Delaunay triangulation for planar graphs (1986), for constrained edges. Book: 2.0.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations
from typing import Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import as_flags
from ..base.errors import InputError, MeshError
from ..base.jit import inline, kernel
from ..base.progress import progress_bar
from ..mesh.marked import marked_sides
from ..mesh.mesh import Mesh, is_planar
from ..predicates.batch import scaled
from ..predicates.exact import exact_incircle, exact_orient2
from ..predicates.kernels import incircle, orient2

__all__ = ["replay", "swap_diagonals"]

EDGES_A_CALL = 1_000_000  # how many edges are examined before Ctrl-C is checked again, about 0.2 seconds


# --- kernels ---------------------------------------------------------------------------------------


@inline
def corner_facing(N, s, t):
    """The corner of triangle s that lies opposite the edge shared with t."""
    if N[s, 0] == t:
        return 0
    return 1 if N[s, 1] == t else 2


@inline
def flip(T, N, t, i):
    """Swap the edge opposite corner i of triangle t, in place; return the other triangle and its corner.

    ::

             v                    v             Before: t = (p, u, v) from corner i, s = (q, v, u) from j.
           / | \\                / s \\           Afterwards: t = (p, u, q), s = (q, v, p). One vertex of each
          p t|s q      ->      p-----q          is replaced; the others keep their places.
           \\ | /                \\ t /
             u                    u
    """
    s = N[t, i]
    j = corner_facing(N, s, t)
    i1, i2, j1, j2 = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
    below, above = N[s, j1], N[t, i1]  # the triangles beyond uq and beyond vp get another neighbor
    T[t, i2] = T[s, j]
    T[s, j2] = T[t, i]
    N[t, i] = below
    N[t, i1] = s
    N[s, j] = above
    N[s, j1] = t
    if below >= 0:
        N[below, corner_facing(N, below, s)] = t
    if above >= 0:
        N[above, corner_facing(N, above, t)] = s
    return s, j


@inline
def _push(t, i, queued, stack, top):
    if queued[t, i]:
        return top
    queued[t, i] = True
    stack[top] = 3 * t + i
    return top + 1


@kernel
def _suspect_all(N, queued, stack):
    """Put every inner edge on the stack once, so that the edges of the first triangles are on top."""
    top = 0
    for t in range(len(N) - 1, -1, -1):
        for i in range(3):
            if N[t, i] > t:
                top = _push(t, i, queued, stack, top)
    return top


@kernel
def _legalize(P, T, N, queued, stack, top, events, wide):
    """Examine as many edges of the stack as ``events`` has room for; its height, and the number of swaps.

    A slot (t, i) stands for the edge that is there at the time. After a swap, the four edges around it are
    put on the stack by their new slots; an old entry of the stack only tests a legal edge again.
    """
    count = 0
    for _ in range(len(events)):
        if top == 0:
            break
        top -= 1
        code = stack[top]
        t = code // 3
        i = code - 3 * t
        queued[t, i] = False
        s = N[t, i]
        if s < 0:
            continue
        a, b, c, q = P[T[t, 0]], P[T[t, 1]], P[T[t, 2]], P[T[s, corner_facing(N, s, t)]]
        if wide:
            sign = exact_incircle(a[0], a[1], b[0], b[1], c[0], c[1], q[0], q[1])
        else:
            sign = incircle(a[0], a[1], b[0], b[1], c[0], c[1], q[0], q[1])
        if sign > 0:
            s, j = flip(T, N, t, i)
            events[count] = code
            count += 1
            top = _push(t, i, queued, stack, top)
            top = _push(t, (i + 2) % 3, queued, stack, top)
            top = _push(s, j, queued, stack, top)
            top = _push(s, (j + 2) % 3, queued, stack, top)
    return top, count


@kernel
def first_fault(P, T, N, wide):
    """The first triangle that is not counterclockwise or that overlaps a neighbor; -1 if there is none."""
    for t in range(len(T)):
        a, b, c = P[T[t, 0]], P[T[t, 1]], P[T[t, 2]]
        if wide:
            sign = exact_orient2(a[0], a[1], b[0], b[1], c[0], c[1])
        else:
            sign = orient2(a[0], a[1], b[0], b[1], c[0], c[1])
        if sign <= 0:
            return t
    for t in range(len(T)):
        for i in range(3):
            s = N[t, i]
            if s >= 0 and T[s, (corner_facing(N, s, t) + 1) % 3] != T[t, (i + 2) % 3]:
                return t
    return -1


@kernel
def _replay(T, N, events):
    """Perform the recorded swaps; return the number of the first one that meets the boundary, or -1."""
    for k in range(len(events)):
        t = events[k] // 3
        i = events[k] - 3 * t
        if N[t, i] < 0:
            return k
        flip(T, N, t, i)
    return -1


# --- public ----------------------------------------------------------------------------------------


@overload
def swap_diagonals(
    mesh: Mesh,
    *,
    constrained: str | Iterable[str] | None = None,
    history: Literal[False] = False,
    progress: bool = False,
) -> Mesh: ...
@overload
def swap_diagonals(
    mesh: Mesh,
    *,
    constrained: str | Iterable[str] | None = None,
    history: Literal[True],
    progress: bool = False,
) -> tuple[Mesh, NDArray[np.int64]]: ...
def swap_diagonals(
    mesh: Mesh,
    *,
    constrained: str | Iterable[str] | None = None,
    history: bool = False,
    progress: bool = False,
) -> Mesh | tuple[Mesh, NDArray[np.int64]]:
    """Make a planar triangulation Delaunay by swapping diagonals.

    Parameters
    ----------
    mesh : Mesh
        Counterclockwise triangles in the plane. The region need not be convex or connected, and may have
        holes; the result is then the constrained Delaunay triangulation of that region.
    constrained : str or iterable of str, optional
        Names of the markers that constrain the result; by default all of them. Their edges are never
        swapped, their triangles remain, and no edge is swapped between triangles with different values of a
        cell marker. Other markers of edges, triangles or cells are not in the result.
    history : bool
        Whether to return the swaps as well.
    progress : bool
        Whether to show the number of swaps as it grows.

    Returns
    -------
    mesh : Mesh
        The same points, origin, duplicates and region; triangles are replaced in place.
    swaps : ndarray of int64, only with ``history=True``
        One number 3 t + i per swap: the edge opposite corner i of triangle t was replaced. `replay` performs
        them again. There are ``len(swaps)`` of them, at most n (n - 1) / 2.

    Raises
    ------
    InputError
        For an unknown marker name.
    MeshError
        If the mesh does not consist of counterclockwise triangles in the plane, if two neighbors overlap, or
        if a marked edge is not an edge of the mesh.

    Notes
    -----
    All decisions are exact. Ties (four points on a circle) are never swapped, so the algorithm always ends.
    It takes O(n^2) swaps in the worst case, and about O(n) if the mesh is nowhere far from Delaunay. Ctrl-C
    leaves the input unchanged. Source: Lawson (1977); with constraints, Lee and Lin (1986). Book: 2.0.
    """
    as_flags(history=history, progress=progress)
    P, wide = planar_coordinates(mesh)
    T, N = mesh.simplices.copy(), mesh.neighbors.copy()
    fault = first_fault(P, T, N, wide)
    if fault >= 0:
        raise MeshError(
            f"simplices[{fault}] = {T[fault].tolist()} is not counterclockwise or overlaps a neighbor; "
            "orient it with mesh.oriented(), remove it, or see unstruct.check"
        )
    markers, locked = constraints(mesh, constrained)
    N[locked] = -1  # a constrained edge is a boundary on both sides
    events = _run(P, T, N, wide, history, progress)
    known = None if locked.any() else N
    regions = mesh.regions if "region" in markers else None
    result = Mesh(
        mesh.points, T, neighbors=known, origin=mesh.origin, duplicates=mesh.duplicates, markers=markers,
        regions=regions, periodic=mesh.periodic,
    )  # fmt: skip
    return (result, events) if history else result


def replay(mesh: Mesh, swaps: ArrayLike) -> Mesh:
    """Perform recorded swaps again: ``replay(mesh, swaps[:k])`` is the state after the first k swaps.

    Parameters
    ----------
    mesh : Mesh
        The mesh that was given to `swap_diagonals`.
    swaps : array_like of int, shape (k,)
        As recorded with ``history=True``.

    Returns
    -------
    Mesh
        The same points, origin and duplicates; only the markers of vertices.

    Raises
    ------
    InputError
        If a number is out of range or a swap meets the boundary; the swaps then belong to another mesh.
    """
    planar_coordinates(mesh)
    T, N = mesh.simplices.copy(), mesh.neighbors.copy()
    events = np.asarray(swaps)
    if events.ndim != 1 or (events.size and events.dtype.kind not in "iu"):
        raise InputError(f"swaps must be integers of shape (k,), not {events.dtype} of shape {events.shape}")
    bad = (events < 0) | (events >= T.size)
    k = int(np.argmax(bad)) if bad.any() else _replay(T, N, events.astype(np.int64))
    if k >= 0:
        raise InputError(
            f"swaps[{k}] = {events[k]} does not fit this mesh; give the mesh before the recorded swaps"
        )
    kept = {name: rows for name, rows in mesh.markers.items() if rows.ndim == 2 and rows.shape[1] == 1}
    return Mesh(mesh.points, T, neighbors=N, origin=mesh.origin, duplicates=mesh.duplicates, markers=kept)


# --- parts -----------------------------------------------------------------------------------------


def planar_coordinates(mesh: Mesh) -> tuple[NDArray[np.float64], bool]:
    """Coordinates for the kernels, and whether their exponents are too different for exact scaling."""
    if not is_planar(mesh):
        raise MeshError(f"this needs triangles in the plane, not {mesh!r}")
    points, exact = scaled(mesh.points)
    return (points, False) if exact else (np.array(mesh.points), True)


def _run(P: NDArray, T: NDArray, N: NDArray, wide: bool, history: bool, progress: bool) -> NDArray[np.int64]:
    """Swap in place until the stack is empty; return the swaps, or an empty array without ``history``."""
    queued = np.zeros(T.shape, dtype=np.bool_)
    stack = np.empty(T.size, dtype=np.int64)  # each slot is queued at most once
    buffer = np.empty(min(EDGES_A_CALL, max(3 * T.size, 1024)), dtype=np.int64)
    events = [np.empty(0, dtype=np.int64)]
    top = _suspect_all(N, queued, stack)
    with progress_bar(progress, "", desc="swaps") as bar:
        while top:
            top, count = _legalize(P, T, N, queued, stack, top, buffer, wide)
            if history:
                events.append(buffer[:count].copy())
            bar.update(count)
    return np.concatenate(events)


def constraints(
    mesh: Mesh, names: str | Iterable[str] | None
) -> tuple[dict[str, NDArray], NDArray[np.bool_]]:
    """The markers that will be in the result, and the slots (t, i) whose edges must remain."""
    if not (names is None or isinstance(names, str)):
        try:
            names = [str(name) for name in names]
        except TypeError:
            raise InputError(f"constrained must be names of markers, not {names!r:.60}") from None
    chosen = set(mesh.markers) if names is None else {names} if isinstance(names, str) else set(names)
    unknown = sorted(chosen - set(mesh.markers))
    if unknown:
        raise InputError(f"no marker is called {unknown[0]!r}; the mesh has {sorted(mesh.markers)}")
    markers = {
        name: rows
        for name, rows in mesh.markers.items()
        if name in chosen or (rows.ndim == 2 and rows.shape[1] == 1)
    }
    locked = np.zeros(mesh.simplices.shape, dtype=bool)
    edges: list[NDArray] = []
    owner: list[str] = []
    for name, rows in markers.items():
        if rows.ndim == 1:
            locked |= (rows[:, None] != rows[mesh.neighbors]) & (mesh.neighbors >= 0)
        elif rows.shape[1] in (2, 3):
            for i, j in combinations(range(rows.shape[1]), 2):
                edges.append(rows[:, [i, j]])
                owner.append(name)
    return markers, locked | _slots(mesh, edges, owner) if edges else locked


def _slots(mesh: Mesh, edges: list[NDArray], names: list[str]) -> NDArray[np.bool_]:
    """Which edges opposite corners (m, 3) are among those of all names, which must be in the mesh."""
    every = np.concatenate(edges)
    slots, found = marked_sides(mesh.simplices, every, len(mesh.points))
    if not found.all():
        row = int(np.argmin(found))
        name = names[int(np.searchsorted(np.cumsum([len(part) for part in edges]), row, "right"))]
        raise MeshError(
            f"markers[{name!r}]: {every[row].tolist()} is not an edge of the mesh; remove it from the marker"
        )
    return slots
