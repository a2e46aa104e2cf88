"""Isosurface stuffing: the works "stuffing" and "fields" of the suite ``tree``.

*Stuffing.* Smooth bodies, given as functions, with one size and with sizes that vary. Rows have the extreme
dihedral angles, whether the surface is closed, how many cells are inverted, and in ``bare`` the CPU seconds
without those in the functions.

*Fields.* Random fields of one level, against the bounds of the theorem: smooth noise that fills its box, and
as rough as can be, with a random value for each vertex of the lattice. And rough bodies with steep sizes that
the surface follows, for which no theorem speaks: noise, and balls with deep bumps.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .meshers import Mesher, several

Array = NDArray[np.float64]
BOUNDS = (10.7, 164.8)
SMOOTH_BOUNDS = (15.0, 152.0)
GRADED_BOUNDS = (8.0, 165.0)  # wanted, not proved
BALLS = 3  # by seed
ROUGH = 8  # cubes in each direction of a field without pattern
BINS = 36  # of the histogram of dihedral angles, five degrees each
PART = 1 << 18  # cells at a time
# a size, of graded balls at the equator, and about how many cells it makes
SIZES = {"sphere": (0.03, 1_900_000), "torus": (0.02, 4_800_000)}
SIZES |= {f"noisy ball {k}": (0.03, 1_900_000) for k in range(BALLS)}
GRADED = {f"graded ball {k}": (0.02, 3_400_000) for k in range(BALLS)}
# work -> kind -> the rough number of cells, or the number of fields
PLAN: dict[str, dict[str, tuple[int, ...]]] = {
    "stuffing": {kind: (cells,) for kind, (_, cells) in (SIZES | GRADED).items()},
    "fields": {"smooth": (500,), "rough": (500,), "graded": (100,)},
}
__all__ = [
    "BOUNDS",
    "GRADED",
    "GRADED_BOUNDS",
    "MESHERS",
    "PLAN",
    "SMOOTH_BOUNDS",
    "measures",
    "task",
    "warm_up",
]


class Clock:
    """A function that counts the CPU seconds that are spent in it."""

    def __init__(self, function: Callable[[Array], Array]):
        self.function, self.seconds = function, 0.0

    def __call__(self, x: Array) -> Array:
        """The values of the function."""
        start = time.process_time()
        values = self.function(x)
        self.seconds += time.process_time() - start
        return values


class Body(NamedTuple):
    """A task: a function that is positive inside, its box, and a number or a function for the size."""

    function: Any
    box: Any
    size: Any
    graded: bool = False
    tolerance: float | None = 1e-10
    cap: bool = False


def body(kind: str, n: int) -> Body:
    """A smooth body for about n cells."""
    from unstruct import examples

    size, cells = (SIZES | GRADED)[kind]
    finest = size * (cells / n) ** (1 / 3)
    if kind in ("sphere", "torus"):
        found = examples.sphere() if kind == "sphere" else examples.torus()
        return Body(found, found.box, finest)
    seed = int(kind.split()[-1])
    found = examples.noisy_ball(seed, height=0.05, shortest=1.0)
    if kind in SIZES:
        return Body(found, found.box, finest)
    return Body(found, found.box, lambda x: finest * (1.0 + 3.0 * np.abs(x[:, 0])), graded=True)


def field(kind: str, seed: int) -> Body:
    """A field of one level: smooth noise, or a value for each vertex of the lattice; or a graded body."""
    from unstruct import examples

    rng = np.random.default_rng(seed)
    if kind == "graded":
        return graded_body(seed // 2)
    if kind == "smooth":
        found = examples.noise(seed)
        return Body(found, found.box, float(rng.uniform(0.5, 1.0)), cap=True)
    corners, centers = rng.normal(size=(ROUGH + 1,) * 3), rng.normal(size=(ROUGH,) * 3)

    def table(x: Array) -> Array:
        doubled = np.rint(2 * x).astype(int)
        result = np.full(len(x), -1.0)
        for odd, values in ((0, corners), (1, centers)):
            here = (doubled % 2 == odd).all(axis=1)
            result[here] = values[tuple((doubled[here] // 2).T)]
        return result

    return Body(table, np.array([[0.0] * 3, [float(ROUGH)] * 3]), 1.0, tolerance=None, cap=True)


def graded_body(number: int) -> Body:
    """Noise and balls with deep bumps by turns, with sizes that grow from a point, wave, or jump."""
    from unstruct import examples

    rng = np.random.default_rng(number)
    way, ball = rng.normal(size=3), number % 2 == 1
    found: Any = examples.noisy_ball(number, height=0.2, shortest=0.5) if ball else examples.noise(number)
    unit, least = (0.25, 0.04) if ball else (1.0, 0.25)
    low, high = np.asarray(found.box)
    start = way / np.sqrt((way * way).sum()) if ball else rng.uniform(low, high)

    def size(x: Array) -> Array:
        if number // 2 % 3 == 0:
            return least + 0.35 * np.sqrt(((x - start) ** 2).sum(axis=1))
        wave = np.sin(0.7 * (x * way).sum(axis=1) / unit)
        return unit * (0.5 + (0.8 * np.abs(wave) if number // 2 % 3 == 1 else 0.7 * (wave > 0.0)))

    return Body(found, found.box, size, graded=True, cap=not ball)


def task(work: str, kind: str, n: int) -> Any:
    """A body of about n cells, or a tuple of n fields."""
    if work == "stuffing":
        return body(kind, n)
    parity = int(kind == "smooth")
    return tuple(field(kind, seed) for seed in range(parity, 2 * n + parity, 2))


def warm_up(work: str) -> list[Any]:
    """Small tasks of the same kinds."""
    if work == "stuffing":
        return [body("sphere", 2000), body("graded ball 0", 2000)]
    return [task(work, kind, 1) for kind in PLAN[work]]


# ---------------------------------------------------------------------- ours


def _stuffed(given: Body) -> Any:
    from unstruct import IncompleteWarning, isosurface_stuffing

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)
        return isosurface_stuffing(
            given.function,
            given.size,
            box=given.box,
            cap=given.cap,
            graded=given.graded,
            tolerance=given.tolerance,
        )


def _bodies() -> Callable[[Any], Any]:
    """A contestant that also gives cells and seconds without the functions, of each run."""
    bare: list[tuple[int, float]] = []

    def run(given: Body) -> Any:
        function = Clock(given.function)
        size = Clock(given.size) if callable(given.size) else None
        start = time.process_time()
        mesh = _stuffed(given._replace(function=function, size=size or given.size))
        took = time.process_time() - start - function.seconds - (size.seconds if size else 0.0)
        bare.append((mesh.size, took))
        return mesh, bare

    return several(run)()


MESHERS = [
    Mesher("unstruct", "unstruct", "stuffing", _bodies),
    Mesher("unstruct", "unstruct", "fields", several(lambda given: (None, list(map(_stuffed, given))))),
]


# ---------------------------------------------------------------------- what was made


def angle_counts(mesh: Any) -> tuple[float, float, NDArray[np.int64]]:
    """The least and the largest dihedral angle, in degrees, and how many there are in each bin."""
    from unstruct.simplex import dihedral_angles

    least, most, counts = 180.0, 0.0, np.zeros(BINS, dtype=np.int64)
    for i in range(0, mesh.size, PART):
        angle = np.degrees(dihedral_angles(mesh.points[mesh.simplices[i : i + PART]]))
        least, most = min(least, float(angle.min())), max(most, float(angle.max()))
        counts += np.histogram(angle, bins=BINS, range=(0.0, 180.0))[0]
    return least, most, counts


def is_closed(mesh: Any) -> bool:
    """Whether each edge of the boundary is passed as often one way as the other."""
    faces = mesh.boundary.astype(np.int64)
    ways = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    n = len(mesh.points)
    return np.array_equal(np.sort(ways[:, 0] * n + ways[:, 1]), np.sort(ways[:, 1] * n + ways[:, 0]))


def measures(result: Any, found: Any, work: str, given: Any) -> dict[str, Any]:
    """Angles, and what must be 0; exact signs decide about inverted cells."""
    from unstruct.predicates import orient

    meshes = [result] if work == "stuffing" else found
    seen = [angle_counts(mesh) for mesh in meshes]
    bare = {}
    if work == "stuffing":  # without the small tasks before
        bare = {"bare": float(np.median([took for cells, took in found if cells == result.size]))}
    return {
        "cells": sum(mesh.size for mesh in meshes),
        "least": min(least for least, _, _ in seen),
        "most": max(most for _, most, _ in seen),
        "inverted": sum(int((orient(mesh.points[mesh.simplices]) <= 0).sum()) for mesh in meshes),
        "open": sum(not is_closed(mesh) for mesh in meshes),
        "pinched": sum(mesh.counts["pinched"] > 0 for mesh in meshes),
        "angles": sum(counts for _, _, counts in seen).tolist(),
        **bare,
    }
