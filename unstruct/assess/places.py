"""What the checks of regions in the plane and in space share: vertices in their places, numbered parts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..base.report import Problem, Report, problem
from ..domain.domain import Domain
from ..mesh.mesh import Mesh

__all__ = ["numbered", "places_of"]


def places_of(mesh: Mesh, domain: Domain, report: Report) -> np.ndarray | None:
    """The mesh vertex of each domain vertex, -1 for none."""
    origin, n = np.asarray(mesh.origin), len(domain.points)
    outside = (origin < -1) | (origin >= n)
    bad = problem("origin", f"outside -1..{n - 1}", vertices=np.nonzero(outside)[0])
    if not report.note("origins are vertices of the domain", bad):
        return None
    rows = np.nonzero(origin >= 0)[0]
    twice = np.bincount(origin[rows], minlength=n) > 1
    moved = (mesh.points[rows] != domain.points[origin[rows]]).any(axis=1)
    if not report.note(
        "every domain vertex at most once, in its place",
        problem("origin", "several vertices with the same origin", vertices=rows[twice[origin[rows]]]),
        problem("moved", "not where the domain has its vertex", vertices=rows[moved]),
    ):
        return None
    place = np.full(n, -1, dtype=np.int64)
    place[origin[rows]] = rows
    return place


def numbered(mesh: Mesh, domain: Domain, part_of: Callable[[], np.ndarray], report: Report) -> None:
    """Test that each part between marked facets has one number: that of the name of its seed, if any.

    ``part_of`` gives the part of each cell.
    """
    number = mesh.markers.get("region")
    if number is None or number.ndim != 1:
        if domain.regions:
            report.note(
                "regions", Problem("region", "the mesh has no marker 'region' with one number per cell")
            )
        return
    part = part_of()
    values, code = np.unique(number, return_inverse=True)
    pairs, times = np.unique(part * len(values) + code, return_counts=True)
    rows = np.lexsort((times, pairs // len(values)))
    last = rows[np.diff(pairs[rows] // len(values), append=-1) != 0]
    usual = values[pairs[last] % len(values)]  # the most frequent number of each part
    mixed = number != usual[part]
    wrong = [problem("region", "cells whose number is not that of their part", cells=np.nonzero(mixed)[0])]
    named: set[int] = set()
    start = np.cumsum([0] + [len(seeds) for seeds in domain.regions.values()])
    every = np.concatenate([np.empty((0, domain.dimension)), *domain.regions.values()])
    found = mesh.find_simplex(every)
    for i, (name, seeds) in enumerate(domain.regions.items()):
        cells = found[start[i] : start[i + 1]]
        lost, inside = cells < 0, cells[cells >= 0]
        text = f"seeds of {name!r} in no cell: {seeds[lost].tolist()}"
        wrong.append(Problem("region", text) if lost.any() else None)
        text = f"cells with a seed of {name!r} whose number is not {i}"
        wrong.append(problem("region", text, cells=inside[number[inside] != i]))
        named |= set(part[inside].tolist())
    others = [p for p in range(len(usual)) if p not in named]
    own = usual[others].tolist()
    once = len(set(own)) == len(own) and all(v >= len(domain.regions) for v in own)
    text = f"parts without a seed need numbers of their own from {len(domain.regions)} on, not {own[:16]}"
    report.note(
        "regions: one number per part, that of its seed if there is one",
        *wrong,
        None if once else Problem("region", text),
    )
