"""Areas of Voronoi and power cells within polygons, in rational numbers, by half-planes alone."""

from fractions import Fraction

__all__ = ["exact_areas", "signed"]


def signed(ring):
    """Twice the signed area."""
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(ring, [*ring[1:], *ring[:1]]))


def half_plane(ring, site, other, shift=0):
    """Sutherland and Hodgman: the ring where it is nearer to the site, degenerate sides included.

    ``shift`` is the weight of the site less that of the other.
    """

    def excess(x):
        return sum((a - b) ** 2 - (a - c) ** 2 for a, b, c in zip(x, site, other)) - shift

    kept = []
    for a, b in zip(ring, [*ring[1:], *ring[:1]]):
        f, g = excess(a), excess(b)
        if f <= 0:
            kept.append(a)
        if f * g < 0:
            kept.append(tuple(x + f / (f - g) * (y - x) for x, y in zip(a, b)))
    return kept


def exact_areas(sites, window, weights=None):
    """Areas of (power) cells within rings (the first is the outline), as fractions, for different sites."""
    heavy = weights or [0] * len(sites)
    exact = [[tuple(map(Fraction, x)) for x in ring] for ring in window]
    sites = [tuple(map(Fraction, site)) for site in sites]
    found = []
    for i, site in enumerate(sites):
        total = Fraction(0)
        for k, ring in enumerate(exact):
            part = ring
            for j, other in enumerate(sites):
                part = half_plane(part, site, other, heavy[i] - heavy[j]) if j != i else part
            area = signed(part) * (1 if signed(ring) > 0 else -1) if part else 0
            total += area / 2 if k == 0 else -area / 2
        found.append(total)
    return found
