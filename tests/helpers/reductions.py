"""How often Baker's insertion needs a reduction in non-Delaunay meshes.

``python tests/helpers/reductions.py 10000``. Meshes: the Delaunay triangulation of 40 to 160 random points,
thoroughly flipped at random (2-3, 3-2). Each takes a batch of random points, one after another. Every mesh is
checked at the end.
"""

from __future__ import annotations

import sys
from collections import Counter

import numpy as np

import unstruct
from unstruct import Mesh
from unstruct.examples.running import flip_at_random
from unstruct.studies import Baker


def scrambled(n: int, rng: np.random.Generator, d: int = 3) -> Mesh:
    """A valid triangulation of n random points, far from Delaunay."""
    mesh = unstruct.delaunay(rng.random((n, d)))
    return flip_at_random(mesh, 40 * n, rng)


def count_reductions(total: int, seed: int = 0, batch: int = 25) -> Counter:
    """Insert ``total`` random points, ``batch`` into each mesh, and count."""
    rng = np.random.default_rng(seed)
    count: Counter = Counter()
    while count["insertions"] < total:
        mesh = scrambled(int(rng.integers(40, 161)), rng)
        growing = Baker(mesh)
        corners = mesh.points[mesh.simplices[rng.integers(mesh.size, size=batch)]]
        weights = rng.dirichlet(np.ones(4), size=batch)
        record = growing.insert((weights[:, :, None] * corners).sum(axis=1))
        result = growing.mesh()
        report = unstruct.check(result)
        assert report, str(report)
        count["meshes"] += 1
        count["insertions"] += batch
        count["reduced"] += int(record.reduced.sum())
        count["hidden facets"] += int(record.hidden.sum())
        count["cells spared"] += int(record.spared.sum())
        count["rounds"] += int(record.rounds.sum())
        count["vertices lost"] += len(result.points) - len(np.unique(result.simplices))
        count["largest component"] = max(count["largest component"], int(record.component.max()))
    return count


if __name__ == "__main__":
    for name, value in count_reductions(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000).items():
        print(f"{name:20} {value}")
