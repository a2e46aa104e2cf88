"""Sizes at coarse facets: as by the definition, for any triangles; which facets are coarse."""

from __future__ import annotations

import numpy as np
import pytest
from solids import cube

from unstruct import Domain
from unstruct.generate.volume.coarse import COARSE_FALL, CoarseFacets, coarse_facets
from unstruct.generate.volume.lattice import lattice_points
from unstruct.sizing.field import as_size


def distance(p: np.ndarray, corners: np.ndarray) -> float:
    """From a triangle, by the nearest of many of its points."""
    grid = [(i / 40, j / 40) for i in range(41) for j in range(41 - i)]
    weight = np.array([(1 - u - v, u, v) for u, v in grid])
    return float(np.sqrt(((weight[:, :, None] * corners).sum(axis=1) - p) ** 2 @ np.ones(3)).min())


@pytest.mark.parametrize("seed", range(4))
def test_by_the_definition(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(9, 3, 3)) * rng.uniform(0.2, 2, (9, 1, 1))
    if seed == 1:
        corners[0, 2] = corners[0, 1]  # a segment
    coarse = CoarseFacets(corners)
    x, size = rng.normal(size=(40, 3)) * 1.5, rng.uniform(0.01, 0.2, 40)
    found, near = coarse.least(x, size), coarse.beside(x)
    for i in range(len(x)):
        away = np.array([distance(x[i], one) for one in corners])
        wanted = max(size[i], float((coarse.weight - COARSE_FALL * away).max()))
        assert abs(found[i] - wanted) < 0.05 and found[i] >= size[i]
        slack = coarse.longest - away
        assert near[i] == (slack.max() > 0) or abs(slack.max()) < 0.05


def test_only_large_facets_are_coarse() -> None:
    domain = Domain(*cube(1))
    assert coarse_facets(domain.triangulated, as_size(0.4)) is None
    found = coarse_facets(domain.triangulated, as_size(0.1))
    assert found is not None and len(found.weight) == 12
    lattice = lattice_points(domain, as_size(0.1), None, found)
    assert len(lattice.inside) == len(lattice.outside) == 0 and len(lattice.beside) > 300
    assert lattice.coarse is found and len(lattice_points(domain, as_size(0.1)).beside) == 0
