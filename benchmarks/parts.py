"""Machine parts for the suite ``volume``: plates with steps, made from planar meshes by `voronoi_segment`.

Each part of a planar domain is as high as its region says. Bottom and tops are triangles of the planar mesh,
walls are rows of quadrilaterals over its edges, cut into triangles. So all triangles have about one size.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def _ring(center: tuple[float, float], radius: float, h: float) -> Array:
    count = max(8, round(2 * np.pi * radius / h))
    t = 2 * np.pi * (np.arange(count) + 0.5) / count
    return np.array(center) + radius * np.stack([np.cos(t), np.sin(t)], axis=1)


def _planar(outer: Array, holes: list[Array], steps: list[Array]) -> Any:
    """A planar domain with closed polygons inside it at which the height changes."""
    from unstruct import Domain

    points = np.concatenate([outer, *holes, *steps])
    first, chains = 0, []
    for ring in (outer, *holes, *steps):
        number = first + np.arange(len(ring))
        chains.append(np.stack([number, np.roll(number, -1)], axis=1))
        first += len(ring)
    many = 1 + len(holes)
    inner = np.concatenate(chains[many:]) if steps else None
    return Domain(points, np.concatenate(chains[:many]), inner=inner)


def _split(ring: Array, h: float) -> Array:
    """Points along a closed polygon, about h apart."""
    rows = []
    for a, b in zip(ring, np.roll(ring, -1, axis=0)):
        count = max(1, round(float(np.hypot(*(b - a))) / h))
        rows.append(a + (b - a) * (np.arange(count) / count)[:, None])
    return np.concatenate(rows)


def stepped(planar: Any, height: Callable[[Array], Array], h: float) -> Any:
    """The body over a planar domain whose top is at ``height``, a function that is constant in each part."""
    from unstruct import Domain, voronoi_segment

    mesh = voronoi_segment(planar, h)
    x, cells = mesh.points, mesh.simplices
    level = np.round(height(x[cells].mean(axis=1)) / h).astype(int)  # whole layers
    top = np.append(level, 0)
    number: dict[tuple[int, int], int] = {}

    def at(v: int, k: int) -> int:
        return number.setdefault((v, k), len(number))

    faces = [[at(a, 0), at(c, 0), at(b, 0)] for a, b, c in cells.tolist()]
    faces += [[at(v, k) for v in row] for row, k in zip(cells.tolist(), level.tolist())]
    t, i = np.nonzero(top[:-1, None] > top[mesh.neighbors])
    ends = np.stack([cells[t, (i + 1) % 3], cells[t, (i + 2) % 3]], axis=1)
    for (a, b), low, high in zip(ends.tolist(), top[mesh.neighbors[t, i]].tolist(), top[t].tolist()):
        for k in range(low, high):
            one, two, three, four = at(a, k), at(b, k), at(b, k + 1), at(a, k + 1)
            if (a + b + k) % 2:
                faces += [[one, two, three], [one, three, four]]
            else:
                faces += [[one, two, four], [two, three, four]]
    place = np.array(list(number))
    return Domain(np.column_stack([x[place[:, 0]], place[:, 1] * h]), np.array(faces))


def bracket(h: float) -> Any:
    """A plate with two bolt holes, and a higher block with a bore."""
    outer = _split(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 1.6], [0.0, 1.6]]), h)
    holes = [_ring((0.45, 0.4), 0.18, h), _ring((0.45, 1.2), 0.18, h), _ring((2.2, 0.8), 0.3, h)]
    block = _split(np.array([[1.6, 0.2], [2.8, 0.2], [2.8, 1.4], [1.6, 1.4]]), h)

    def height(p: Array) -> Array:
        inside = (np.abs(p[:, 0] - 2.2) < 0.6) & (np.abs(p[:, 1] - 0.8) < 0.6)
        return np.where(inside, 1.2, 0.4)

    return stepped(_planar(outer, holes, [block]), height, h)


def flange(h: float) -> Any:
    """A round plate with eight bolt holes and a bore, and a hub around the bore."""
    bolts = [(1.15 * np.cos(t), 1.15 * np.sin(t)) for t in np.pi / 4 * np.arange(8)]
    holes = [_ring((0.0, 0.0), 0.45, h), *(_ring(bolt, 0.16, h) for bolt in bolts)]

    def height(p: Array) -> Array:
        return np.where(np.hypot(p[:, 0], p[:, 1]) < 0.75, 1.0, 0.35)

    return stepped(_planar(_ring((0.0, 0.0), 1.5, h), holes, [_ring((0.0, 0.0), 0.75, h)]), height, h)


def gear(h: float) -> Any:
    """A spur gear of sixteen teeth with a bore with a keyway, thinner between hub and rim."""
    teeth, corners = 16, []
    for k in range(teeth):
        for share, radius in ((-0.3, 1.25), (-0.14, 1.5), (0.14, 1.5), (0.3, 1.25)):
            t = 2 * np.pi * (k + share) / teeth
            corners.append((radius * np.cos(t), radius * np.sin(t)))
    t = np.linspace(0.25, 2 * np.pi - 0.25, 24)
    bore = np.concatenate([0.3 * np.stack([np.cos(t), np.sin(t)], axis=1),
                           [[0.4, 0.3 * np.sin(-0.25)], [0.4, 0.3 * np.sin(0.25)]]])  # fmt: skip
    steps = [_ring((0.0, 0.0), 0.55, h), _ring((0.0, 0.0), 1.02, h)]

    def height(p: Array) -> Array:
        r = np.hypot(p[:, 0], p[:, 1])
        return np.where(r < 0.55, 0.8, np.where(r < 1.02, 0.4, 0.6))

    return stepped(_planar(_split(np.array(corners), h), [_split(bore, h)], steps), height, h)


# name -> the part for an edge length, and its volume, roughly
PARTS: dict[str, tuple[Callable[[float], Any], float]] = {
    "bracket": (bracket, 2.65),
    "flange": (flange, 2.73),
    "gear": (gear, 2.98),
}
