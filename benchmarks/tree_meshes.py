"""Meshes of planar regions from quadtrees: the work "boundary" of the suite ``tree``.

A disc, with leaves of one size, and six fractal coasts with small leaves along them. Beside the kinds of
`Tree.mesh` are `voronoi_segment` and `refine` (25 degrees), with the sides of the leaves as the wanted size.
The tree has been made before; nothing that is computed from it when it is asked for has.

Angles "away" are those of triangles that are not listed in ``unrefined`` as spoilt by an input angle. The
methods without such a list have only the least angle of all.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi, sqrt
from typing import Any, NamedTuple

import numpy as np

from .meshers import Mesher, several

COASTS = 6
INLAND = 0.1  # the size of leaves away from coasts, in units of a coast's radius
FINEST = 0.02  # the size of leaves along coasts of COARSE cells, about
COARSE = 4_000
# sides of leaves are halves of halves: these numbers of cells are those that can be
PLAN: dict[str, dict[str, tuple[int, ...]]] = {
    "boundary": {
        "disc": (6_000, 24_000, 390_000),
        **{f"coast {k + 1}": (COARSE, 4 * COARSE) for k in range(COASTS)},
    }
}
__all__ = ["MESHERS", "PLAN", "Bounded", "coast", "measures", "task", "warm_up"]


class Bounded(NamedTuple):
    """A task: a domain, and the tree over it."""

    domain: Any
    tree: Any

    def fresh(self) -> Any:
        """The tree again, without what has been computed from it."""
        from unstruct import Tree

        tree = Tree(self.tree.linear, self.tree.box, self.tree.balance)
        tree.domain, tree.boundary = self.domain, self.tree.boundary
        return tree

    def size(self, x: Any) -> Any:
        """The side of the leaf at each point."""
        return self.tree.sides[self.tree.locate(np.clip(x, *self.tree.box))]


def coast(seed: int, levels: int = 7, corners: int = 6) -> Any:
    """A closed line by displaced midpoints, drawn again until it does not cross itself."""
    from unstruct import Domain, UnstructError

    rng = np.random.default_rng(seed)
    while True:
        turn = np.arange(corners) / corners * 2 * np.pi
        ring = rng.uniform(0.6, 1, corners)[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
        for _ in range(levels):
            step = np.roll(ring, -1, axis=0) - ring
            away = np.column_stack([-step[:, 1], step[:, 0]]) * rng.normal(0, 0.22, len(ring))[:, None]
            ring = np.stack([ring, ring + step / 2 + away], axis=1).reshape(-1, 2)
        try:
            return Domain.polygon(ring)
        except UnstructError:
            continue


def task(work: str, kind: str, n: int) -> Bounded:
    """What the contestants are given: about n cells."""
    from unstruct import Domain, quadtree

    if kind == "disc":
        domain = Domain.disc((0, 0), 1)
        return Bounded(domain, quadtree(domain, 1.1 * sqrt(2 * pi / n)))
    domain = coast(int(kind.split()[1]) - 1)
    return Bounded(domain, quadtree(domain, INLAND, boundary_size=FINEST * COARSE / n))


def warm_up(work: str) -> list[Bounded]:
    """Small tasks of both kinds."""
    return [task(work, "disc", 1000), task(work, "coast 1", 1000)]


def _kind(name: str) -> Callable[[], Callable[[Any], Any]]:
    return several(lambda given: (None, given.fresh().mesh(name)))


def _voronoi_segment(given: Bounded) -> Any:
    from unstruct import voronoi_segment

    return None, voronoi_segment(given.domain, given.size)


def _refine(given: Bounded) -> Any:
    from unstruct import refine

    return None, refine(given.domain, given.size, min_angle=25)


MESHERS = [
    Mesher("unstruct", "unstruct", "boundary", _kind("fitted")),
    Mesher("quads", "unstruct", "boundary", _kind("quads")),
    Mesher("warped", "unstruct", "boundary", _kind("warped")),
    Mesher("voronoi_segment", "unstruct", "boundary", several(_voronoi_segment)),
    Mesher("refine", "unstruct", "boundary", several(_refine)),
]


def measures(result: Any, mesh: Any, work: str, given: Any) -> dict[str, Any]:
    """The number of cells, angles, and how many cells are listed."""
    angles = mesh.quality("min_angle")
    away = np.ones(len(angles), dtype=bool)
    away[[t for t, why in zip(mesh.unrefined, mesh.reasons, strict=True) if why.startswith("input")]] = False
    return {
        "cells": len(angles),
        "least": float(angles.min()),
        "away": float(angles[away].min()),
        "listed": len(mesh.unrefined),
        "complete": bool(mesh.complete),
    }
