"""The real regions of the book as domains, and a size field for the coastline.

See the book, chapter 2.6d; `running_domain` appears in all chapters.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.elementary import cosine, sines
from ..base.optional import optional
from ..domain.domain import Domain
from ..geometry.curves import Arc, Curve, CurveLike
from ..sizing import sources
from ..sizing.field import SizeField
from .running import island_shore, lake_shore

__all__ = ["coastline", "coastline_size", "plate", "running_domain", "wing_with_flap", "word"]

Array = NDArray[np.float64]


def running_domain() -> Domain:
    """The running region of the book with true curves: the lake of `examples.running_region` and its island.

    Returns
    -------
    Domain
        The outer shore in sixteen pieces, named "shore", and the island in four, named "island". The water is
        inside.
    """
    points: list[Array] = []
    facets: list[list[int]] = []
    curves: dict[int, CurveLike] = {}
    markers: dict[str, list[int]] = {}
    # The outer shore is divided away from the tip and the foot of the peninsula.
    for name, shore, count in (("shore", lake_shore, 16), ("island", island_shore, 4)):
        t = np.linspace(0.0, 2.0 * np.pi, count + 1)
        first = len(facets)
        points.append(np.round(shore(t[:-1]) * 2.0**45) / 2.0**45)  # the same on any machine
        for i in range(count):
            curves[first + i] = Curve(shore, t[i], t[i + 1])
            facets.append([first + i, first + (i + 1) % count])
        markers[name] = list(range(first, first + count))
    return Domain(np.concatenate(points), facets, curves=curves, markers=markers)


def wing_with_flap(radius: float = 6.0) -> Domain:
    """An airfoil (NACA 2412) with a flap behind and below it, in a circular far field.

    Parameters
    ----------
    radius : float
        The radius of the far field, in chords.

    Returns
    -------
    Domain
        It has the markers "far field", and "upper" and "lower" for both sections.
    """
    far = Domain.disc((0.5, 0.0), radius)
    far.markers["far field"] = np.arange(4, dtype=np.int32)
    wing = Domain.naca("2412", attack=4.0)
    flap = Domain.naca("4412", chord=0.3, nose=(0.985, -0.125), attack=26.0)
    return far.with_holes(wing, flap)


def coastline(level: float = 0.5, thin: float = 0.004) -> Domain:
    """The sea around Vancouver Island, with its islands as holes: a contour of matplotlib's data "topobathy".

    Parameters
    ----------
    level : float
        The height of the water, in meters. The data are whole numbers, so that a half avoids flat regions.
    thin : float
        A vertex of the contour is left out if it is nearer than this to the previous one, because the contour
        of a raster has very short sides. Islands with fewer than four remaining vertices are left out, too.

    Returns
    -------
    Domain
        The largest body of water in the frame of the data. x is the longitude times the cosine of the middle
        latitude and y the latitude, in degrees from the south-western corner. The marker "frame" contains the
        pieces on the frame. Needs matplotlib.
    """
    contourpy = optional("contourpy", "examples.coastline")
    data: Any = optional("matplotlib.cbook", "examples.coastline").get_sample_data("topobathy.npz")
    relief, x, y = (np.asarray(data[name], dtype=float) for name in ("topo", "longitude", "latitude"))
    x, y = (x - x[0]) * cosine(math.radians(y.mean())), y - y[0]
    lower, upper = np.array([x[0], y[0]]), np.array([x[-1], y[-1]])
    outer_offset = contourpy.FillType.OuterOffset
    contours = contourpy.contour_generator(x, y, relief, fill_type=outer_offset)
    filled = contours.filled(relief.min() - 1, level)
    waters = [[points[a:b] for a, b in pairwise(offsets)] for points, offsets in zip(*filled, strict=True)]
    outer, *holes = max(waters, key=lambda rings: np.prod(np.ptp(rings[0], axis=0)))
    rings = [_thinned(ring[:-1], thin, lower, upper) for ring in (outer, *holes)]
    sea = Domain.polygon(rings[0], [ring for ring in rings[1:] if len(ring) > 3])
    a, b = sea.points[sea.facets].transpose(1, 0, 2)
    on_frame = (((a == lower) & (b == lower)) | ((a == upper) & (b == upper))).any(axis=1)
    return Domain(sea.points, sea.facets, markers={"frame": np.nonzero(on_frame)[0]})


def _thinned(ring: Array, least: float, lower: Array, upper: Array) -> Array:
    """The ring without vertices nearer than ``least`` to another one.

    Corners of the frame, and the ends of the parts of the ring on the frame, are kept.
    """
    on = ((ring == lower) | (ring == upper)).sum(axis=1)
    ends = (on == 1) & ((np.roll(on, 1) == 0) | (np.roll(on, -1) == 0))
    fixed = (on == 2) | ends
    away = np.hypot(*(ring[:, None] - ring[fixed]).transpose(2, 0, 1)).min(axis=1, initial=np.inf)
    kept: list[int] = []
    for i in np.nonzero((away >= least) | fixed)[0].tolist():
        if fixed[i] or not kept or np.hypot(*(ring[i] - ring[kept[-1]])) >= least:
            kept.append(i)
    if len(kept) > 1 and not fixed[kept[-1]] and np.hypot(*(ring[kept[-1]] - ring[kept[0]])) < least:
        kept.pop()
    return ring[kept]


def coastline_size(sea: Domain, least: float = 0.015, growth: float = 0.25) -> SizeField:
    """A size that is ``least`` on the coast and grows by ``growth`` per unit of distance from it.

    Parameters
    ----------
    sea : Domain
    least, growth : float

    Returns
    -------
    SizeField
    """
    coast = np.setdiff1d(np.arange(len(sea.facets)), sea.markers["frame"])
    return sources(sea.points[sea.facets[coast]], least, growth=growth)


def word(text: str = "mesh") -> Domain:
    """Letters of height about 1, some with holes, with the Bezier curves of their font. Needs matplotlib."""
    return Domain.letters(text, size=1.4)


def _wave(y: Array) -> Array:
    return np.column_stack([1.5 + 0.2 * sines(np.pi * y), y])


def plate() -> Domain:
    """A plate of two materials joined along a wave, with an inlay of a third one and twenty-one round holes.

    Returns
    -------
    Domain
        The plate [0, 3] x [0, 2] with the regions "left", "right" and "inlay", and the markers "left side",
        "right side", "holes" and "joint".
    """
    points = [[0.0, 0.0], [1.5, 0.0], [3.0, 0.0], [3.0, 2.0], [1.5, 2.0], [0.0, 2.0]]
    facets = [[i, (i + 1) % 6] for i in range(6)]
    inner = [[1, 4]]
    curves: dict[int, CurveLike] = {}
    holes = [(x, y, 0.05 + 0.03 * ((3 * i + 2 * j) % 4)) for i, x in enumerate((0.3, 0.75, 1.15, 1.95, 2.75))
             for j, y in enumerate((0.3, 0.78, 1.25, 1.7))]  # fmt: skip
    holes.append((2.38, 1.0, 0.1))  # a hole inside the inlay
    for x, y, r in holes:
        first = len(points)
        for i in range(4):
            turn = i * np.pi / 2
            points.append([x + r * round(np.cos(turn)), y + r * round(np.sin(turn))])
            curves[len(facets)] = Arc((x, y), r, turn, np.pi / 2)
            facets.append([first + i, first + (i + 1) % 4])
    first = len(points)
    for i in range(4):
        turn = i * np.pi / 2
        points.append([2.38 + 0.25 * round(np.cos(turn)), 1.0 + 0.25 * round(np.sin(turn))])
        curves[len(facets) + len(inner)] = Arc((2.38, 1.0), 0.25, turn, np.pi / 2)
        inner.append([first + i, first + (i + 1) % 4])
    curves[len(facets)] = Curve(_wave, 0.0, 2.0)
    return Domain(
        points,
        facets,
        inner=inner,
        curves=curves,
        markers={"holes": range(6, len(facets)), "joint": [len(facets)], "left side": [5], "right side": [2]},
        regions={"left": [0.05, 0.05], "right": [2.95, 0.05], "inlay": [2.38, 1.2]},
    )
