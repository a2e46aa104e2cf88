"""The contestants: each takes points and gives the cells as an array, through its public interface.

A contestant is a function of the points that returns the number of cells. If a wrapper spends much of its
time on creating arrays, it also returns the seconds of the library itself. `find` skips contestants that are
not installed.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from importlib.metadata import PackageNotFoundError, version
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Result = tuple[int, float | None]


class Contestant(NamedTuple):
    """A library and how to call it."""

    name: str
    package: str
    dimensions: tuple[int, ...]
    prepare: Callable[[], Callable[[NDArray[np.float64]], Result]]


def _unstruct() -> Callable[[NDArray[np.float64]], Result]:
    from unstruct import delaunay

    return lambda points: (len(delaunay(points).simplices), None)


def _triangle() -> Callable[[NDArray[np.float64]], Result]:
    from triangle import triangulate

    return lambda points: (len(triangulate({"vertices": points})["triangles"]), None)


def _tetgen() -> Callable[[NDArray[np.float64]], Result]:
    from meshpy.tet import MeshInfo, Options, build

    def run(points: NDArray[np.float64]) -> Result:
        info = MeshInfo()
        info.set_points(points)
        start = time.process_time()
        mesh = build(info, options=Options("Q"))
        inner = time.process_time() - start
        return len(np.array(mesh.elements)), inner

    return run


def _scipy() -> Callable[[NDArray[np.float64]], Result]:
    from scipy.spatial import Delaunay

    return lambda points: (len(Delaunay(points).simplices), None)


DELAUNAY = [
    Contestant("unstruct", "unstruct", (1, 2, 3, 4, 5), _unstruct),
    Contestant("Triangle", "triangle", (2,), _triangle),
    Contestant("TetGen", "meshpy", (3,), _tetgen),
    Contestant("SciPy", "scipy", (2, 3, 4, 5), _scipy),
]


def installed(packages: Iterable[str]) -> dict[str, str]:
    """The versions of those packages that are installed."""
    found = {}
    for package in packages:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found


def find(contestants: list[Contestant], dimension: int) -> list[tuple[Contestant, str]]:
    """The contestants that are installed and work in this dimension, with their versions."""
    there = installed(each.package for each in contestants)
    return [(c, there[c.package]) for c in contestants if c.package in there and dimension in c.dimensions]
