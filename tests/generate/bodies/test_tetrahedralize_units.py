"""The unit of length does not matter: in units of 2^k a body has the same mesh, bit for bit."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np
import pytest

import unstruct
from unstruct import Domain, InputError, check

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
PLACES = np.random.default_rng(1).uniform(0.1, 0.9, (30, 3))
Method = Callable[[Domain, float], unstruct.DomainMesh]


def fine(s: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda x: (0.2 + 0.4 * np.abs(x[:, 0] / s)) * s


METHODS: dict[str, Method] = {
    "given points": lambda d, s: unstruct.front_delaunay(d, PLACES @ TURN.T * s),
    "front": lambda d, s: unstruct.advancing_front(d, 0.4 * s),
    "front, varying": lambda d, s: unstruct.advancing_front(d, fine(s)),
    "classical": lambda d, s: unstruct.advancing_front(d, 0.4 * s, method="classical"),
    "filled": lambda d, s: unstruct.tetrahedralize(d),
    "by size": lambda d, s: unstruct.tetrahedralize(d, 0.4 * s),
    "varying": lambda d, s: unstruct.tetrahedralize(d, fine(s)),
    "coarse facets": lambda d, s: unstruct.tetrahedralize(d, 0.15 * s, split_boundary=False),
    "refined": lambda d, s: unstruct.refine(d, 0.4 * s),
    "centers": lambda d, s: unstruct.circumcenter_insertion(d, budget=20),
    "segments": lambda d, s: unstruct.voronoi_segment(d, fine(s)),
    "remeshed": lambda d, s: unstruct.remesh(d, 0.4 * s),
    "surface": lambda d, s: unstruct.surface_delaunay(d, 0.4 * s),
    "stuffed": lambda d, s: unstruct.isosurface_stuffing(d, fine(s)),
    "features": lambda d, s: unstruct.isosurface_stuffing(d, 0.4 * s, features=30),
    "features, varying": lambda d, s: unstruct.isosurface_stuffing(d, fine(s), features=30, graded=True),
}


@pytest.mark.filterwarnings("error::RuntimeWarning", "ignore::unstruct.IncompleteWarning")
@pytest.mark.parametrize("name", METHODS)
def test_the_same_mesh_in_any_unit(name: str) -> None:
    """Products of lengths are no doubles here: the front found nothing inside, others divided by 0."""
    wanted = METHODS[name](Domain(CORNERS @ TURN.T, SIDES), 1.0)
    assert wanted.size > 4
    for exponent in (-900, -370, 340, 900):
        s = 2.0**exponent
        mesh = METHODS[name](Domain(CORNERS @ TURN.T * s, SIDES), s)
        np.testing.assert_array_equal(mesh.points / s, wanted.points)
        np.testing.assert_array_equal(mesh.simplices, wanted.simplices)
        assert mesh.complete == wanted.complete and mesh.reasons.tolist() == wanted.reasons.tolist()
        assert check(mesh)


@pytest.mark.filterwarnings("error::RuntimeWarning", "ignore::unstruct.IncompleteWarning")
@pytest.mark.parametrize("stretch", ((1e-100, 1.0, 1e100), (1e-150, 1e-150, 1.0)))
def test_bodies_of_very_different_lengths_are_filled_or_refused(stretch: tuple[float, float, float]) -> None:
    body = Domain(CORNERS * stretch, SIDES)
    size = max(stretch)
    for method in (
        lambda: unstruct.front_delaunay(body, []),
        lambda: unstruct.advancing_front(body, size),
        lambda: unstruct.advancing_front(body, size, method="classical"),
        lambda: unstruct.tetrahedralize(body, size),
        lambda: unstruct.constrained_delaunay(body),
    ):
        mesh = method()
        assert mesh.size > 0 and mesh.complete and check(mesh, domain=body)
    with pytest.raises(InputError, match="too short beside the largest coordinate"):
        unstruct.refine(body, size)
    with pytest.raises(InputError, match="thinner than a cell"):
        unstruct.isosurface_stuffing(body, size)
    with pytest.raises(InputError, match="degenerate"):
        unstruct.remesh(body, size)
