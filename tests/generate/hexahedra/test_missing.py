"""How closed surfaces are connected, and places of a surface that are far from a mesh."""

from __future__ import annotations

import numpy as np
import pytest

from tests.generate.hexahedra.test_dominant import SIDES, UNIT
from unstruct import Domain, octree
from unstruct.generate.hexahedra.missing import connected_otherwise, lost_or_filled

Surface = tuple[np.ndarray, np.ndarray]


def triangles(body: Domain) -> Surface:
    shell = body.triangulated
    return shell.points, np.asarray(shell.bounding)


def two(step: list[float]) -> Surface:
    """Two unit cubes."""
    points, number = np.unique(np.concatenate([UNIT, UNIT + step]), axis=0, return_inverse=True)
    return triangles(Domain(points, number.ravel()[np.concatenate([SIDES, SIDES + 8])]))


def test_connection() -> None:
    cube, torus = triangles(Domain(UNIT, SIDES)), triangles(Domain.torus(size=0.3))
    assert connected_otherwise(cube, triangles(Domain.ball(size=0.5))) == ""
    assert "1 components and Euler characteristic 0, the body's surface has 1 and 2" in connected_otherwise(
        cube, torus
    )
    assert "2 components and Euler characteristic 4" in connected_otherwise(cube, two([2, 0, 0]))
    assert connected_otherwise(two([2, 0, 0]), two([0, 3, 0])) == ""


@pytest.mark.parametrize("step", [[1, 1, 0], [1, 1, 1]])
def test_nothing_is_said_of_surfaces_that_touch_themselves(step: list[float]) -> None:
    assert connected_otherwise(two(step), two([2, 0, 0])) == ""


@pytest.mark.parametrize(("leaves", "told"), [(0.0, False), (0.4, False), (0.6, True)])
def test_distances_are_in_sides_of_leaves(leaves: float, told: bool) -> None:
    """A mesh whose boundary is a smaller cube: corners are sqrt(3) times as far as sides."""
    tree = octree(Domain(UNIT, SIDES), 0.25, box=[[0, 0, 0], [1, 1, 1]])
    points, faces = triangles(Domain(UNIT, SIDES))
    smaller = 0.5 + (points - 0.5) * (1 - 2 * leaves * tree.sides.max())
    reasons, most = lost_or_filled(tree, (points, faces), (smaller, faces, np.arange(len(faces))))
    assert most == pytest.approx(np.sqrt(3) * leaves)
    assert bool(reasons) == told
