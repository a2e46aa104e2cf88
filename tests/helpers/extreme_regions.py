"""Regions at the ends of what doubles can say: ``EXTREME`` has one generator of domains for each kind.

They are kept apart from `regions.KINDS`, whose regions keep sizes about 1: these test scales, not shapes.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from regions import KINDS, Rng

from unstruct import Domain, UnstructError

__all__ = ["EXTREME"]

SQUARE = [(0, 1), (1, 2), (2, 3), (3, 0)]


def spokes(rng: Rng) -> Domain:
    """A square with segments from one point whose lengths are between 1e-1 and 1e-250."""
    while True:
        n = int(rng.integers(2, 9))
        hub = np.array([0.5, 0.5] if rng.random() < 0.5 else [2.0**-10, 2.0**-20])
        points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        if rng.random() < 0.5:  # only about the origin do short ones have directions of their own
            points, hub = points - hub, np.zeros(2)
        angle = rng.uniform(0, 2 * np.pi, n)
        length = 10.0 ** -rng.choice([1.0, 5.0, 20.0, 100.0, 160.0, 250.0], n)
        ends = hub + length[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
        scale = 2.0 ** float(rng.choice([0, -300, 400]))
        try:
            return Domain(
                np.concatenate([points, [hub], ends]) * scale, SQUARE, inner=[(4, 5 + i) for i in range(n)]
            )
        except UnstructError:
            continue


def sides(rng: Rng) -> Domain:
    """A square with vertices on its sides, as close to a corner as 1e-300."""
    while True:
        ring = []
        for x, y, u, v in ((0, 0, 1, 0), (1, 0, 0, 1), (1, 1, -1, 0), (0, 1, 0, -1)):
            ring.append((float(x), float(y)))
            for _ in range(int(rng.integers(0, 3))):
                away = 10.0 ** -rng.uniform(0, 300)
                ring.append((x + u * away, y + v * away))
        try:
            return Domain.polygon(ring)
        except UnstructError:
            continue


def subnormal(rng: Rng) -> Domain:
    """A polygon of a few corners on a grid of the least positive double, or of some times that."""
    while True:
        step = 5e-324 * 2.0 ** float(rng.integers(0, 20))
        try:
            return Domain.polygon(rng.integers(-6, 7, (int(rng.integers(3, 8)), 2)) * step)
        except UnstructError:
            continue


def huge(rng: Rng) -> Domain:
    """A straight region of another kind, enlarged or shrunk until squares of lengths are no doubles."""
    straight = [name for name in KINDS if name != "curves"]
    while True:
        domain = KINDS[straight[rng.integers(len(straight))]](rng)
        scale = 2.0 ** float(rng.choice([500, 900, 1000, -500, -900, -1000]))
        try:
            return Domain(domain.points * scale, domain.facets, inner=domain.inner)
        except UnstructError:  # two corners of "wide exponents" may fall together
            continue


EXTREME: dict[str, Callable[[Rng], Domain]] = {
    "spokes": spokes,
    "sides": sides,
    "subnormal": subnormal,
    "huge": huge,
}
