"""Isosurface stuffing: smooth bodies, and random fields of one level, against the bounds of the theorem.

``python -m benchmarks.stuffing --fields 1000`` prints the extreme dihedral angles and the speed without the
function, and for the fields whether all cells are positive and all boundaries closed. A thousand fields take
a few minutes.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import unstruct
from unstruct import examples
from unstruct.predicates import orient
from unstruct.simplex import dihedral_angles

BOUNDS = (10.7, 164.8)
SMOOTH_BOUNDS = (15.0, 152.0)


def angles(mesh: Any) -> tuple[float, float]:
    """The least and the largest dihedral angle, in degrees."""
    found = [
        dihedral_angles(mesh.points[mesh.simplices[i : i + (1 << 18)]]) for i in range(0, mesh.size, 1 << 18)
    ]
    return float(np.rad2deg(min(a.min() for a in found))), float(np.rad2deg(max(a.max() for a in found)))


def is_closed(mesh: Any) -> bool:
    """Whether each edge of the boundary is passed as often one way as the other."""
    faces = mesh.boundary.astype(np.int64)
    ways = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    n = len(mesh.points)
    return np.array_equal(np.sort(ways[:, 0] * n + ways[:, 1]), np.sort(ways[:, 1] * n + ways[:, 0]))


def smooth_bodies() -> Iterator[tuple[str, Any, float]]:
    """Names, bodies and sizes."""
    yield "sphere", examples.sphere(), 0.03
    yield "torus", examples.torus(), 0.02
    for seed in range(3):
        yield f"noisy ball {seed}", examples.noisy_ball(seed, height=0.05, shortest=1.0), 0.03


def fields(count: int) -> Iterator[tuple[Callable, np.ndarray, float, float | None]]:
    """Fields with their boxes and sizes: smooth noise, and as rough as can be: a value for each vertex."""
    for seed in range(count):
        rng = np.random.default_rng(seed)
        if seed % 2:
            body = examples.noise(seed)
            yield body, body.box, float(rng.uniform(0.5, 1.0)), 1e-10
            continue
        n = 8
        corners, centers = rng.normal(size=(n + 1,) * 3), rng.normal(size=(n,) * 3)

        def table(x: np.ndarray, corners: Any = corners, centers: Any = centers) -> np.ndarray:
            doubled = np.rint(2 * x).astype(int)
            result = np.full(len(x), -1.0)
            for odd, values in ((0, corners), (1, centers)):
                here = (doubled % 2 == odd).all(axis=1)
                result[here] = values[tuple((doubled[here] // 2).T)]
            return result

        yield table, np.array([[0.0] * 3, [float(n)] * 3]), 1.0, None


def main(arguments: list[str] | None = None) -> int:
    """Print the table; return 1 if a bound is missed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.stuffing", description=__doc__)
    parser.add_argument("--fields", type=int, default=1000)
    count = parser.parse_args(arguments).fields
    warnings.simplefilter("ignore", unstruct.IncompleteWarning)
    good = True
    unstruct.isosurface_stuffing(examples.sphere(), 0.2)
    for name, body, size in smooth_bodies():
        least, most, speed = 180.0, 0.0, 0.0
        asked = [0.0]

        def timed(x: np.ndarray, body: Any = body, asked: list[float] = asked) -> np.ndarray:
            start = time.process_time()
            values = body(x)
            asked[0] += time.process_time() - start
            return values

        for _ in range(3):
            asked[0], start = 0.0, time.process_time()
            mesh = unstruct.isosurface_stuffing(timed, size, box=body.box)
            speed = max(speed, mesh.size / (time.process_time() - start - asked[0]))
        least, most = angles(mesh)
        good &= least >= SMOOTH_BOUNDS[0] and most <= SMOOTH_BOUNDS[1] and is_closed(mesh)
        print(
            f"{name:14} {mesh.size:9,} cells  {least:6.2f} to {most:6.2f} degrees  "
            f"{speed / 1e6:5.2f} M cells/s"
        )
    worst, inverted, opened, pinched, cells = [180.0, 0.0], 0, 0, 0, 0
    for body, box, size, tolerance in fields(count):
        mesh = unstruct.isosurface_stuffing(body, size, box=box, cap=True, tolerance=tolerance)
        least, most = angles(mesh)
        worst = [min(worst[0], least), max(worst[1], most)]
        inverted += int((orient(mesh.points[mesh.simplices]) <= 0).sum())
        opened += not is_closed(mesh)
        pinched += mesh.counts["pinched"] > 0
        cells += mesh.size
    good &= worst[0] >= BOUNDS[0] and worst[1] <= BOUNDS[1] and not inverted and not opened
    print(
        f"{count} fields    {cells:9,} cells  {worst[0]:6.2f} to {worst[1]:6.2f} degrees  "
        f"{inverted} inverted, {opened} not closed, {pinched} touch themselves"
    )
    return 0 if good else 1


if __name__ == "__main__":
    raise SystemExit(main())
