"""Points with segments that do not cross, and what the plain version makes of them."""

from __future__ import annotations

import numpy as np

from unstruct import InputError
from unstruct.connect.planar.complex import PlanarComplex
from unstruct.connect.planar.flood import mark_regions
from unstruct.connect.planar.inserting import insert_all


def bare(points, segments, *, facets=0):
    """Insert segments into the complex of the points, without a Domain: vertices may lie on them."""
    complex_ = PlanarComplex(np.asarray(points, dtype=float))
    ends = np.array(segments, dtype=np.int32).reshape(-1, 2)
    piece = np.arange(len(ends), dtype=np.int32)
    insert_all(complex_, ends, piece, np.tile([0.0, 1.0], (len(ends), 1)), facets=facets)
    mark_regions(complex_, facets, {}, facets == 0)
    return complex_


def noncrossing(points, pairs):
    """Those pairs, in turn, that cross and overlap none of the earlier ones."""
    chosen = []
    for pair in pairs:
        try:
            bare(points, [*chosen, pair])
        except InputError:
            continue
        chosen.append(pair)
    return chosen


def cells_of(simplices):
    return {tuple(np.roll(row, -int(np.argmin(row))).tolist()) for row in np.asarray(simplices)}


def square(low, high):
    return [(low, low), (high, low), (high, high), (low, high)]


def coastline(n, seed=0):
    """A ring with structure at every scale, round the origin."""
    rng = np.random.default_rng(seed)
    frequency = np.maximum(np.fft.rfftfreq(n, 1 / n), 1)
    wave = (rng.normal(size=len(frequency)) + 1j * rng.normal(size=len(frequency))) * frequency**-1.3
    wave[0] = 0
    radius = np.fft.irfft(wave, n)
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return (1 + 0.35 * radius / np.abs(radius).max())[:, None] * np.column_stack(
        [np.cos(angle), np.sin(angle)]
    )
