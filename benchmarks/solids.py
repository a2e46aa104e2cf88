"""CAD-like bodies by seed: unions and differences of turned boxes, cylinders and balls, by ``manifold3d``.

``python -m benchmarks.solids --count 100`` tetrahedralizes them without a size, beside TetGen ``pY``, each
mesher and body in a process of its own, and prints what became of them.
"""

from __future__ import annotations

import argparse
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .run import Workers

Surface = tuple[NDArray[np.float64], NDArray[np.int32]]


def can() -> bool:
    """Whether ``manifold3d`` is installed."""
    return find_spec("manifold3d") is not None


def boolean(seed: int) -> Surface:
    """Points and triangles of a turned cube with some other bodies added or taken away."""
    from manifold3d import Manifold

    rng = np.random.default_rng(seed)
    made = Manifold.cube((1.0, 1.0, 1.0), True).rotate(rng.uniform(0.0, 360.0, 3).tolist())
    for _ in range(2 + seed % 4):
        kind = int(rng.integers(3))
        if kind == 0:
            other = Manifold.cube(rng.uniform(0.4, 1.2, 3).tolist(), True)
        elif kind == 1:
            other = Manifold.cylinder(2.0, float(rng.uniform(0.15, 0.4)), -1.0, int(rng.integers(12, 33)), True)
        else:
            other = Manifold.sphere(float(rng.uniform(0.35, 0.65)), int(rng.integers(12, 29)))
        turned = other.rotate(rng.uniform(0.0, 360.0, 3).tolist())
        moved = turned.translate(rng.uniform(-0.4, 0.4, 3).tolist())
        made = made + moved if rng.random() < 0.5 else made - moved
    mesh = made.to_mesh64()
    points, triangles = np.asarray(mesh.vert_properties)[:, :3].astype(float), np.asarray(mesh.tri_verts)
    same = np.arange(len(points))
    same[np.asarray(mesh.merge_from_vert, dtype=int)] = np.asarray(mesh.merge_to_vert, dtype=int)
    used, number = np.unique(same[triangles], return_inverse=True)
    return points[used], number.reshape(-1, 3).astype(np.int32)


def judged(case: dict[str, Any]) -> dict[str, Any]:
    """What a mesher makes of the boolean of a seed: a word, points on the surface, and seconds."""
    import time

    from .meshers import find
    from .volume_meshers import MESHERS, Given
    from .volume_quality import measures

    points, triangles = boolean(case["seed"])
    given = Given(points, triangles, None, "")
    (mesher,) = [m for m, _ in find("CAD", MESHERS) if m.name == case["contestant"]]
    run = mesher.prepare()
    if mesher.package == "unstruct":  # kernels are loaded
        run(Given(*boolean(0), None, ""))
    start = time.process_time()
    try:
        mesh = run(given)
    except Exception as error:
        return {"word": "refused", "why": f"{type(error).__name__}: {error}"[:200]}
    seconds = time.process_time() - start
    found = measures(*mesh, "CAD", given)
    word = "exact" if found["exact"] else "divided" if found["valid"] else "incomplete"
    return {"word": word, "valid": found["valid"], "steiner": found["steiner"], "cells": found["cells"],
            "seconds": seconds, "triangles": len(triangles)}  # fmt: skip


def main(arguments: list[str] | None = None) -> None:
    """Judge many booleans."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.solids", description=__doc__)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--timeout", type=float, default=120.0)
    options = parser.parse_args(arguments)
    workers = Workers(options.timeout)
    names = ("unstruct", "TetGen pY")
    found: dict[str, list[dict[str, Any]]] = {name: [] for name in names}
    for seed in range(options.first, options.first + options.count):
        for name in names:
            row = workers.ask("solid", {"seed": seed, "contestant": name})
            found[name].append(row or {"word": "crashed or too slow"})
            print(seed, name, found[name][-1], flush=True)
    for name, rows in found.items():
        words = [row["word"] for row in rows]
        print(name, {word: words.count(word) for word in sorted(set(words))})
        print("  points on the surface:", sum(row.get("steiner", 0) for row in rows),
              "slowest:", max(row.get("seconds", 0.0) for row in rows))  # fmt: skip


if __name__ == "__main__":
    main()
