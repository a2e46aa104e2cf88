"""Shaded terrains: one polygon a triangle, brighter towards the light, row 0 on top."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from unstruct import InputError, view
from unstruct.studies import greedy_terrain


@pytest.fixture(autouse=True)
def close():
    yield
    plt.close("all")


def colors(grid, **options):
    terrain = greedy_terrain(grid, count=9)
    ax = view.plot_terrain(terrain, **options)
    (cells,) = ax.collections
    assert len(cells.get_paths()) == len(terrain.mesh.simplices)
    assert ax.yaxis_inverted()
    return cells.get_facecolors()


def test_slopes_towards_the_light_are_brighter():
    i, j = np.mgrid[0:9, 0:9].astype(float)
    facing, away = (colors(sign * (i + j)) for sign in (1, -1))  # the light comes from row 0, column 0
    assert facing[:, :3].sum(axis=1).mean() > away[:, :3].sum(axis=1).mean()


@pytest.mark.parametrize("edges", [False, True])
def test_flat_ground_and_edges(edges):
    shade = colors(np.zeros((4, 6)), edges=edges)
    assert (shade == shade[0]).all() and ((shade >= 0) & (shade <= 1)).all()


@pytest.mark.parametrize("exaggeration", [0.0, -1.0, np.nan, np.inf])
def test_bad_exaggeration(exaggeration):
    with pytest.raises(InputError, match="exaggeration"):
        view.plot_terrain(greedy_terrain(np.zeros((2, 2))), exaggeration=exaggeration)
