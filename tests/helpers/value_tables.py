"""Random values at the vertices of a body-centered cubic lattice, as rough as can be."""

from __future__ import annotations

import numpy as np

from unstruct import DomainMesh, Mesh
from unstruct.predicates import orient

KINDS = ("normal", "integers", "wide", "near zero", "equal")


class Table:
    """A function with given values at corners (n + 1,)^3 and centers (n,)^3 of unit cubes; negative
    around."""

    def __init__(self, seed: int, n: int = 5, kind: str = "normal"):
        rng = np.random.default_rng(seed)
        self.corners, self.centers = (values(rng, (m,) * 3, kind) for m in (n + 1, n))
        for axis in range(3):
            for end in (0, -1):
                side = np.moveaxis(self.corners, axis, 0)[end]
                side[...] = -np.abs(side) - 1e-3
        self.box = np.array([[0.0] * 3, [float(n)] * 3])

    def __call__(self, x: np.ndarray) -> np.ndarray:
        doubled = np.rint(2 * x).astype(int)
        assert np.allclose(doubled, 2 * x, atol=1e-9)
        result = np.full(len(x), -1.0)
        for odd, table in ((0, self.corners), (1, self.centers)):
            here = (doubled % 2 == odd).all(axis=1)
            result[here] = table[tuple((doubled[here] // 2).T)]
        return result


def values(rng: np.random.Generator, shape: tuple[int, ...], kind: str) -> np.ndarray:
    """Values of one kind."""
    if kind == "integers":
        return rng.integers(-2, 3, shape).astype(float)
    if kind == "wide":
        return rng.choice([-1.0, 1.0], shape) * 10.0 ** rng.uniform(-300, 300, shape)
    if kind == "near zero":
        return rng.choice([-1e-300, -1e-17, 0.0, 1e-17, 5e-324, -5e-324, 1.0, -1.0], shape)
    if kind == "equal":
        return rng.choice([-1.0, 1.0], shape)
    return rng.normal(size=shape)


def dihedral_range(mesh: Mesh) -> tuple[float, float]:
    """The least and the largest dihedral angle, in degrees."""
    from unstruct.simplex import dihedral_angles

    angles = dihedral_angles(mesh.points[mesh.simplices])
    return float(np.rad2deg(angles.min())), float(np.rad2deg(angles.max()))


def assert_sound(mesh: DomainMesh) -> None:
    """No inverted cell, and a boundary that is closed: each of its edges is passed as often both ways."""
    assert (orient(mesh.points[mesh.simplices]) > 0).all()
    faces = mesh.boundary
    ways = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    n = len(mesh.points)
    assert np.array_equal(np.sort(ways[:, 0] * n + ways[:, 1]), np.sort(ways[:, 1] * n + ways[:, 0]))
    x = mesh.points[faces]
    enclosed = (x[:, 0] * np.cross(x[:, 1], x[:, 2])).sum() / 6.0
    assert abs(abs(enclosed) - mesh.volume) <= 1e-9 * (1.0 + mesh.volume) * max(
        1.0, np.abs(mesh.points).max()
    )
