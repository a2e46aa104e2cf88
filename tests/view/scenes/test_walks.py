"""Walks to a point: captions and powers are right wherever the point is."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from unstruct import InputError, check, simplex
from unstruct.view import WALK_MESHES, check_frame, walk_mesh, walk_powers, walk_state


@pytest.mark.parametrize("name", WALK_MESHES)
def test_the_whole_range(name: str) -> None:
    mesh = walk_mesh(name)[0]
    assert check(mesh) and bool(check(mesh, delaunay=True)) == (name == "Delaunay")
    ends = set()
    for x, y in product(np.linspace(0, 16, 9), np.linspace(0, 12, 7)):
        one = walk_state(x, y, name)
        check_frame(one)
        arrives, inside = one["caption"].startswith("it arrives"), int(mesh.find_simplex([x, y])) >= 0
        ends.add(one["caption"].split()[0] + one["caption"][-3:])
        if name == "Delaunay":
            assert arrives == inside and one["number"].endswith("falling at each step")
        assert inside or not arrives
        assert ("though the point is in it" in one["caption"]) <= inside
    if name == "nasty: a pinwheel":
        assert any(end.startswith("triangle") for end in ends)
    if name == "nasty: with a hole":
        assert any(end.endswith("it") for end in ends)


def test_powers() -> None:
    mesh = walk_mesh("Delaunay")[0]
    q = np.array([3.0, 4.0])
    away = ((simplex.circumcenter(mesh.corners) - q) ** 2).sum(axis=1)
    assert np.allclose(walk_powers(mesh.corners, q), away - simplex.circumradius(mesh.corners) ** 2)


def test_an_unknown_mesh() -> None:
    with pytest.raises(InputError, match="no mesh 'torus'"):
        walk_state(0, 0, "torus")
