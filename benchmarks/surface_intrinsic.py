"""Intrinsic Delaunay flips on bad meshes, beside libigl: `python -m benchmarks.surface_intrinsic`.

Each row is the least processor time of several runs, which alternate between the two in one process. libigl's
`intrinsic_delaunay_triangulation` gets its lengths and triangles; ours gets points and triangles, checks them
for flat ones, and keeps directions as well, so that edges can be drawn.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import unstruct
from unstruct.studies import IntrinsicTriangulation

__all__ = ["MESHES", "rows"]

SIZES = (10_000, 100_000, 1_000_000)
RUNS = 3
Surface = tuple[NDArray[np.float64], NDArray[np.int32]]


def _turned(n: int, m: int, place: Callable[[Any, Any], Any]) -> Surface:
    """A grid that is closed in the first direction; place takes u and v in [0, 1]."""
    u, v = np.meshgrid(np.arange(n) / n, np.arange(m + 1) / m, indexing="ij")
    points = np.stack(np.broadcast_arrays(*place(u.ravel(), v.ravel())), axis=1).astype(float)
    i, j = (x.ravel() for x in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    a, b = i * (m + 1) + j, (i + 1) % n * (m + 1) + j
    rows = np.concatenate([np.stack([a, b, b + 1], axis=1), np.stack([a, b + 1, a + 1], axis=1)])
    return points, rows.astype(np.int32)


def squashed(count: int) -> Surface:
    """A band of an ellipsoid of the axes 1, .1 and .05."""
    n = round((count / 2) ** 0.5)

    def place(u: Any, v: Any) -> Any:
        turn, high = 2 * np.pi * u, np.pi * (0.02 + 0.96 * v)
        return np.cos(turn) * np.sin(high), 0.1 * np.sin(turn) * np.sin(high), -0.05 * np.cos(high)

    return _turned(n, n, place)


def needles(count: int) -> Surface:
    """A cylinder of needles that run up it askew, as of turned parts in CAD."""
    n = round((count * 2) ** 0.5)
    m = max(1, count // (2 * n))

    def place(u: Any, v: Any) -> Any:
        turn = 2 * np.pi * (u + 0.25 * v * m)
        return np.cos(turn), np.sin(turn), v * m * 200 * np.pi / n

    return _turned(n, m, place)


def sheared(count: int) -> Surface:
    """A torus whose grid is sheared so that nearly all edges are illegal, several times over."""
    n = round((count / 2) ** 0.5)

    def place(u: Any, v: Any) -> Any:
        turn, other = 2 * np.pi * (u + 8 * v), 2 * np.pi * 0.98 * v
        far = 1 + 0.4 * np.cos(other)
        return far * np.cos(turn), far * np.sin(turn), 0.4 * np.sin(other)

    return _turned(n, n, place)


MESHES: dict[str, Callable[[int], Surface]] = {
    "squashed ellipsoid": squashed,
    "needles of a cylinder": needles,
    "sheared torus": sheared,
}


def _ours(points: NDArray, triangles: NDArray) -> tuple[float, float, int]:
    """Processor time of all and of the flips alone, and how many flips."""
    mesh = unstruct.Mesh(points, triangles)
    start = time.process_time()
    found = IntrinsicTriangulation(mesh)
    middle = time.process_time()
    flips = found.delaunay()
    end = time.process_time()
    assert len(found.illegal()) == 0
    return end - start, end - middle, flips


def _theirs(points: NDArray, triangles: NDArray) -> float | None:
    """Processor time of libigl, None where it is not installed."""
    try:
        import igl
    except ImportError:
        return None
    faces = triangles.astype(np.int64)
    start = time.process_time()
    igl.intrinsic_delaunay_triangulation(igl.edge_lengths(points, faces), faces)
    return time.process_time() - start


def rows(sizes: tuple[int, ...] = SIZES, runs: int = RUNS) -> list[dict[str, Any]]:
    """One row for each mesh and size: triangles, flips, seconds, those of libigl, and their ratio."""
    found = []
    for name, make in MESHES.items():
        for count in sizes:
            points, triangles = make(count)
            mine, alone, theirs, flips = [], [], [], 0
            _ours(*make(200))
            for _ in range(runs):
                whole, part, flips = _ours(points, triangles)
                mine.append(whole)
                alone.append(part)
                peer = _theirs(points, triangles)
                theirs += [] if peer is None else [peer]
            row = {
                "mesh": name, "triangles": len(triangles), "flips": flips, "seconds": min(mine),
                "flips a second": flips / max(min(alone), 1e-9),
                "libigl": min(theirs) if theirs else None,
            }  # fmt: skip
            row["ratio"] = row["libigl"] / row["seconds"] if theirs else None
            found.append(row)
    return found


def main() -> None:
    """Print the rows."""
    for row in rows():
        peer = "" if row["libigl"] is None else f"  libigl {row['libigl']:8.3f} s  ratio {row['ratio']:.2f}"
        print(
            f"{row['mesh']:24}{row['triangles']:>9} triangles {row['flips']:>9} flips "
            f"{row['seconds']:8.3f} s {row['flips a second']:10.0f} flips/s{peer}",
            flush=True,
        )


if __name__ == "__main__":
    main()
