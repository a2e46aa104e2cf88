"""Isosurface stuffing as frames: its analog in the plane step by step, and one stencil in space."""

from __future__ import annotations

from string import ascii_uppercase
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.simplex import dihedral_angles
from ...plain import stuffing
from ..draw import frames as fr
from ..draw.items import item3
from .space_frames import bodies, space_frame

__all__ = ["STENCILS", "planar_stuffing", "planar_stuffing_frames", "stencil_angles", "stencil_state"]

Point = NDArray[np.float64]
LATTICE_COLUMNS, LATTICE_ROWS = 6, 4  # of the vertices of the planar lattice
PLANE_WINDOW = [-0.3, 5.9, -0.25, 2.85]
PLANE_ALPHA = 0.3  # the share of an edge within which a crossing moves a vertex
LATTICE_CELL = ((2, 0, 0), (0, 0, 0), (1, 1, 1), (1, 1, -1))  # a tetrahedron of the lattice
PROVED = (10.7, 164.8)  # degrees, by `unstruct.studies.stuffing_bounds`
STENCILS: dict[str, str] = {
    "one inside: +---": "+---",
    "two inside, short cuts: ++--": "++--",
    "two inside, long cuts too: +-+-": "+-+-",
    "three inside: +++-": "+++-",
    "one on the surface: ++0-": "++0-",
    "two on the surface: +00-": "+00-",
}


def _height(x: Any) -> Any:
    """The curve below which the region of the planar example lies."""
    return 0.72 + 0.62 * x - 0.085 * x * x


def _level(p: Point) -> float:
    return float(_height(p[0]) - p[1])


def planar_stuffing(alpha: float = PLANE_ALPHA) -> dict[str, Any]:
    """The planar analog: a lattice of equilateral triangles, a curve, crossings and moved vertices.

    Parameters
    ----------
    alpha : float
        The share of an edge within which a crossing moves a vertex; 0 for no moves.

    Returns
    -------
    dict
        ``names`` of the vertices at crossed edges; ``points``; ``triangles`` of the lattice; the ``level`` of
        each point; ``crossings`` {(inside, outside): place}, and which are ``left``; ``moves`` [(vertex,
        place, crossings that it takes along)] in their order; and the ``pieces``, as corners.
    """
    points = np.array(
        [(i + j % 2 / 2, j * 0.75**0.5) for j in range(LATTICE_ROWS) for i in range(LATTICE_COLUMNS)]
    )
    triangles = []
    for j in range(LATTICE_ROWS - 1):
        for i in range(LATTICE_COLUMNS - 1):
            a, b, c, d = (LATTICE_COLUMNS * (j + v) + i + u for v in (0, 1) for u in (0, 1))
            triangles += [(a, b, c), (b, d, c)] if j % 2 == 0 else [(a, b, d), (a, d, c)]
    level = np.array([_level(p) for p in points])
    edges = {tuple(sorted((t[k - 1], t[k]))) for t in triangles for k in range(3)}
    crossings = {}
    for i, k in sorted(edges):
        if level[i] * level[k] < 0:
            p, q = (i, k) if level[i] > 0 else (k, i)
            crossings[p, q] = points[p] + _zero(points[p], points[q]) * (points[q] - points[p])
    sign, left, moves = np.sign(level), dict(crossings), []
    for v in range(len(points)):
        own = {edge: x for edge, x in left.items() if v in edge}
        near = {edge: float(np.sqrt(((x - points[v]) ** 2).sum())) for edge, x in own.items()}
        if near and min(near.values()) < alpha:
            moves.append((v, left[min(near, key=lambda edge: near[edge])], list(own.values())))
            sign[v] = 0
            left = {edge: x for edge, x in left.items() if v not in edge}
    place = {v: x for v, x, _ in moves}
    x = [place.get(v, p) for v, p in enumerate(points)]
    pieces = [piece for t in triangles for piece in _planar_pieces(t, x, sign, left)]
    near_curve = sorted({v for edge in crossings for v in edge})
    return {
        "names": dict(zip(near_curve, ascii_uppercase, strict=False)),
        "points": points,
        "triangles": triangles,
        "level": level,
        "crossings": crossings,
        "moves": moves,
        "left": left,
        "pieces": pieces,
    }


def _zero(p: Point, q: Point) -> float:
    """Where the curve crosses the edge from p to q, by halving."""
    low, high = 0.0, 1.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _level(p + middle * (q - p)) > 0 else (low, middle)
    return low


def _planar_pieces(t: tuple[int, ...], x: list[Point], sign: Any, cut: dict[Any, Point]) -> list[Any]:
    """What of a triangle is inside."""
    if max(sign[list(t)]) <= 0:
        return []
    if min(sign[list(t)]) >= 0:
        return [[x[v] for v in t]]
    ring = []
    for a, b in zip(t, (*t[1:], t[0]), strict=True):
        ring += [x[a]] if sign[a] >= 0 else []
        found = cut.get((a, b), cut.get((b, a)))
        ring += [] if found is None else [found]
    if len(ring) == 3:
        return [ring]
    p, q, r, s = ring
    if ((p - r) ** 2).sum() <= ((q - s) ** 2).sum():
        return [[p, q, r], [p, r, s]]
    return [[p, q, s], [q, r, s]]


def _smallest(pieces: list[Any]) -> float:
    found = []
    for t in pieces:
        for k in range(3):
            u, v = t[k - 2] - t[k], t[k - 1] - t[k]
            found.append(np.degrees(np.arctan2(abs(u[0] * v[1] - u[1] * v[0]), u @ v)))
    return float(min(found))


def planar_stuffing_frames() -> list[fr.Frame]:
    """The planar analog of stuffing: signs, crossings, vertices that move one by one, and the triangles."""
    made = planar_stuffing()
    points, level = made["points"], made["level"]
    window, x = PLANE_WINDOW, np.linspace(-0.3, 5.9, 60)
    curve = np.column_stack([x, _height(x)])
    line = fr.segments("constrained", np.stack([curve[:-1], curve[1:]], axis=1))
    lattice = fr.polygons("muted", [points[list(t)] for t in made["triangles"]])
    inside, outside = fr.dots("vertex", points[level > 0]), fr.dots("waiting", points[level < 0])
    frames = [
        fr.frame("a lattice, and a curve", lattice, line, number=f"{len(points)} vertices", view=window),
        fr.frame(
            "which vertices are inside?",
            lattice,
            line,
            inside,
            outside,
            number=f"{int((level > 0).sum())} inside",
        ),
    ]
    crossings = list(made["crossings"].values())
    base = [lattice, line, inside, outside]
    frames.append(
        fr.frame(
            "crossings of edges",
            *base,
            fr.dots("voronoi", crossings),
            number=f"{len(crossings)} crossings",
        )
    )
    gone: list[Any] = []
    places: list[Any] = []
    moved: set[int] = set()
    for v, place, own in made["moves"]:
        gone += own
        left = [x for x in crossings if not any(x is y for y in gone)]
        moved.add(v)
        keep = np.array([k not in moved for k in range(len(points))])
        items = [lattice, line]
        items += [
            fr.dots(role, points[own & keep]) for role, own in (("vertex", level > 0), ("waiting", level < 0))
        ]
        items += [fr.dots("voronoi", left), fr.segments("highlight", [[points[v], place]])]
        places.append(place)
        items.append(fr.dots("inserted", places))
        frames.append(fr.frame(f"{made['names'][v]} moves", *items, number=f"{len(left)} crossings left"))
    final = [fr.polygons("accepted", made["pieces"]), line, fr.dots("inserted", places)]
    final.append(fr.dots("voronoi", list(made["left"].values())))
    text = f"smallest angle {_smallest(made['pieces']):.1f} degrees"
    cut = planar_stuffing(0.0)["pieces"]
    bare = [fr.polygons("cell", cut), fr.polygons("bad", [t for t in cut if _smallest([t]) < 15]), line]
    frames.append(fr.frame("triangles inside", *final, number=text))
    frames.append(fr.frame("without the moves", *bare, number=f"smallest angle {_smallest(cut):.1f} degrees"))
    return frames


def stencil_angles(signs: str, shares: list[float]) -> tuple[Any, Any]:
    """The pieces of a tetrahedron of the lattice with signs, (k, 4, 3), and their dihedral angles, (k, 6).

    Parameters
    ----------
    signs : str
        Of the vertices (2, 0, 0), (0, 0, 0), (1, 1, 1), (1, 1, -1); those with 0 stay where they are.
    shares : list of float
        Where the edges are cut, from their ends inside; in the order of the edges, the last for all others.
    """
    sign: dict[tuple[int, ...], int] = {
        v: "-0+".index(s) - 1 for v, s in zip(LATTICE_CELL, signs, strict=True)
    }
    place: dict[Any, Any] = {v: np.array(v, dtype=float) for v in LATTICE_CELL}
    cut = [(p, q) for p in LATTICE_CELL for q in LATTICE_CELL if sign[p] > 0 > sign[q]]
    for k, (p, q) in enumerate(cut):
        s = shares[min(k, len(shares) - 1)]
        place[frozenset((p, q))] = (1 - s) * place[p] + s * place[q]
    corners = np.array([[place[v] for v in piece] for piece in stuffing.pieces(LATTICE_CELL, sign)])
    return corners, np.degrees(dihedral_angles(corners))


def stencil_state(stencil: str = "one inside: +---", first: float = 0.5, others: float = 0.5) -> fr.Frame:
    """One stencil of isosurface stuffing, with its dihedral angles.

    Parameters
    ----------
    stencil : str
        One of `STENCILS`.
    first, others : float
        Where the first edge and the other ones are cut, from their ends inside.

    Returns
    -------
    dict
        The tetrahedron of the lattice, its pieces, and the extreme angles; pieces with angles outside of the
        proved bounds are marked.
    """
    signs = STENCILS[stencil]
    corners, angles = stencil_angles(signs, [first, others])
    low, high = angles.min(axis=1) < PROVED[0], angles.max(axis=1) > PROVED[1]
    whole = np.array(LATTICE_CELL, dtype=float)
    edges = [(i, j) for i in range(4) for j in range(i)]
    kinds = {"+": "vertex", "0": "inserted", "-": "waiting"}
    scene = [item3("segments", "edge", edges, whole, opacity=0.7)]
    roles = ("accepted", "waiting", "voronoi")
    for k, piece in enumerate(corners):
        scene.append(bodies("bad" if low[k] or high[k] else roles[k], [[0, 1, 2, 3]], piece, shrink=0.92))
    for s, role in kinds.items():
        rows = [v for v, own in zip(LATTICE_CELL, signs, strict=True) if own == s]
        if rows:
            scene.append(item3("points", role, np.array(rows, dtype=float)))
    number = f"dihedral angles from {angles.min():.1f} to {angles.max():.1f} degrees"
    return space_frame(scene, stencil.split(":")[0], number=number, azimuth=-75.0, elevation=25.0)
