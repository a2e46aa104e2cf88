"""How often and why the classical front in space sticks, over many random bodies.

``python stuck_fronts.py --kind noisy --first 0 --count 300`` meshes them and prints sums: bodies whose front
stuck, cells, rests by their numbers of faces and vertices, what filled them, and meshes that are "wrong".
Kinds: those of `random_bodies`, and ``cube`` (random diagonals), ``torus``, ``star`` (twisted prisms) of
`solids`, and ``hull`` (convex hulls of a few points of a lattice).
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
from random_bodies import MAKERS
from solids import cube, torus, twisted_star

from unstruct import Domain, UnstructError, check, delaunay
from unstruct.generate.space_front.classical_mesh import mesh_of_body
from unstruct.generate.space_front.classical_rest import completed, rests_of
from unstruct.generate.space_front.classical_run import body_faces, marched_in_space
from unstruct.sizing.field import as_size


def solid(kind: str, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A body of `solids` with sizes by the seed."""
    rng = np.random.default_rng(seed)
    if kind == "cube":
        return cube(int(rng.integers(2, 7)), seed)
    if kind == "hull":
        rows = np.unique(rng.integers(0, 5, (int(rng.integers(6, 17)), 3)).astype(float), axis=0)
        faces = delaunay(rows).convex_hull
        used = np.unique(faces)
        return rows[used], np.searchsorted(used, faces).astype(np.int32)
    if kind == "torus":
        return torus(int(rng.integers(5, 20)), int(rng.integers(4, 12)))
    return twisted_star(2 * int(rng.integers(2, 6)), int(rng.integers(1, 6)), float(rng.uniform(0.1, 0.9)))


def bodies(kind: str, first: int, count: int) -> Iterator[tuple[int, Domain, float]]:
    """Bodies by seeds with the mean length of their edges; those that are refused are left out."""
    for seed in range(first, first + count):
        try:
            points, triangles = MAKERS[kind](seed) if kind in MAKERS else solid(kind, seed)
            domain = Domain(points, triangles)
        except UnstructError:
            continue
        rows = points[triangles]
        yield seed, domain, float(np.linalg.norm(rows[:, 0] - rows[:, 1], axis=1).mean())


def judged(domain: Domain, size: float, **options: Any) -> tuple[Counter[str], Counter[tuple[int, int]]]:
    """The counts of a run and of what fills its rests, and the rests by faces and vertices."""
    body = body_faces(domain)
    run = marched_in_space(body, as_size(size), **options)
    kinds: Counter[tuple[int, int]] = Counter()
    if len(run.left):
        for rest in rests_of(run.points, run.left, run.part, body, run.cells.astype(np.int64)):
            kinds[len(rest.facets) + 2 * len(rest.inner), len(np.unique(rest.facets))] += 1
    found = completed(body, run)
    sums = Counter(run.counts) | Counter(found.counts)
    sums |= Counter({"cells": len(run.cells), "bodies": 1, "stuck bodies": int(len(run.left) > 0)})
    sums["by recovery"] += not found.whole
    if found.whole:
        mesh = mesh_of_body(domain, None, found.points, found.cells)
        sums["wrong"] += not check(mesh, domain=domain)
    return sums, kinds


def main() -> None:
    """Run and tell; see the top of this file."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--kind", default="noisy")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--order", default="smallest")
    parser.add_argument("--search", default="barycenter")
    args = parser.parse_args()
    start, sums, kinds, seeds = time.process_time(), Counter(), Counter(), []
    for seed, domain, size in bodies(args.kind, args.first, args.count):
        one, rests = judged(domain, size, order=args.order, search=args.search)
        sums += one
        kinds += rests
        seeds += [seed] * (one["stuck bodies"] > 0)
    print(args.kind, args.order, args.search, f"{time.process_time() - start:.1f} s", dict(sums))
    print("rests by faces and vertices:", kinds.most_common(12), "largest", max(kinds, default=None))
    print("stuck:", seeds[:40])


if __name__ == "__main__":
    main()
