"""Regions with spokes, and random polygons, for methods that put points on segments."""

from itertools import combinations

import numpy as np

from unstruct.base.errors import InputError
from unstruct.domain.domain import Domain
from unstruct.plain.predicates import orient

TEN = [(1000, 0), (566, 411), (309, 951), (-216, 666), (-809, 588), (-700, 0), (-809, -588), (-216, -666),
       (309, -951), (566, -411)]  # fmt: skip


def fan_domain(spokes, far=4):
    """Spokes from (0, 0) as inner segments of a large square."""
    m, reach = len(spokes), far * max(abs(x) for p in spokes for x in p)
    box = [(-reach, -reach), (reach, -reach), (reach, reach), (-reach, reach)]
    sides = [(m + 1 + k, m + 1 + (k + 1) % 4) for k in range(4)]
    return Domain(np.array([(0, 0), *spokes, *box], float), sides, inner=[(0, i + 1) for i in range(m)])


def uncrossed(ring, passes=200):
    """Reverse chains of a ring between sides that cross or touch, until none do; None if that goes on."""
    for _ in range(passes):
        for i, j in combinations(range(len(ring)), 2):
            a, b, c, d = ring[i], ring[(i + 1) % len(ring)], ring[j], ring[(j + 1) % len(ring)]
            one, two = orient([a, b, c]) * orient([a, b, d]), orient([c, d, a]) * orient([c, d, b])
            if len({a, b, c, d}) == 4 and one <= 0 >= two:
                ring[i + 1 : j + 1] = reversed(ring[i + 1 : j + 1])
                break
        else:
            return ring
    return None


def random_polygon(rng, n=12, size=1000):
    """A simple polygon on integer points: those of a random ring, uncrossed."""
    while True:
        points = rng.permutation(np.unique(rng.integers(0, size, (n, 2)), axis=0))
        ring = uncrossed(list(map(tuple, points.tolist())))
        if ring is not None and len(ring) > 2:
            try:
                Domain.polygon(ring)
            except InputError:  # folded onto itself
                continue
            return ring
