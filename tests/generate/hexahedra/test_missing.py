"""Places of a surface: on it, and enough of them that a smaller mesh is noticed."""

from __future__ import annotations

import numpy as np
import pytest

from tests.generate.hexahedra.test_dominant import SIDES, UNIT
from unstruct import Domain, octree
from unstruct.generate.hexahedra.missing import samples_of_surface
from unstruct.generate.stuffing.account import lost_or_filled


def test_places_are_on_the_surface_and_everywhere() -> None:
    body = Domain.ball(size=0.3)
    tree = octree(body, 0.2)
    shell = body.triangulated
    x, side = samples_of_surface(tree, shell.points, shell.bounding)
    assert (side == tree.sides.min()).all()
    assert len(x) == len(shell.points) + 8 * np.count_nonzero(tree.states == 0)
    away = np.sqrt((x * x).sum(axis=1))
    assert away.min() > 0.97 and away.max() <= 1 + 1e-12
    met = np.flatnonzero(tree.states == 0)
    assert np.isin(met, tree.locate(x)).mean() > 0.9


@pytest.mark.parametrize(("leaves", "told"), [(0.0, False), (0.4, False), (0.6, True)])
def test_distances_are_in_sides_of_leaves(leaves: float, told: bool) -> None:
    """A mesh whose boundary is a smaller cube: corners are sqrt(3) times as far as sides."""
    body = Domain(UNIT, SIDES)
    tree = octree(body, 0.25, box=[[0, 0, 0], [1, 1, 1]])
    points, faces = body.points, np.asarray(body.triangulated.bounding)
    smaller = 0.5 + (points - 0.5) * (1 - 2 * leaves * tree.sides.max())
    samples = samples_of_surface(tree, points, faces)
    mesh = (smaller, faces, np.arange(len(faces)))
    reasons, most = lost_or_filled(samples, (points, faces), mesh, "leaf")
    assert most == pytest.approx(np.sqrt(3) * leaves)
    assert bool(reasons) == told
