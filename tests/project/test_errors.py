"""Whatever a public function is given in place of what it takes: the answer is an `UnstructError`."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")

import numpy as np
import pytest

import unstruct
from unstruct import Domain, Mesh, UnstructError, view

POINTS = np.random.default_rng(0).random((20, 2))
MESH = unstruct.delaunay(POINTS)
SQUARE = Domain.rectangle()

WRONG = {
    "insert into a domain": lambda: unstruct.insert(SQUARE, 0.1),
    "insert a text": lambda: unstruct.insert(MESH, "x"),
    "insert nothing": lambda: unstruct.insert(MESH, None),
    "refine to a text": lambda: unstruct.refine(SQUARE, "0.1"),
    "an angle that is a text": lambda: unstruct.refine(SQUARE, min_angle="30"),
    "an area that is a text": lambda: unstruct.refine(SQUARE, max_area="0.1"),
    "an area of a region that is a text": lambda: unstruct.refine(SQUARE, max_area={0: "1"}),
    "refine nothing": lambda: unstruct.refine(None, 0.1),
    "refine a list": lambda: unstruct.refine([(0, 0), (1, 0), (0, 1)], 0.1),
    "a budget that is a text": lambda: unstruct.refine(SQUARE, 0.1, budget="x"),
    "a choice of splits": lambda: unstruct.refine(SQUARE, 0.1, split_boundary="x"),
    "no size": lambda: unstruct.voronoi_segment(SQUARE, None),
    "a list of sizes": lambda: unstruct.voronoi_segment(SQUARE, [0.1, 0.2]),
    "a mesh for a domain": lambda: unstruct.voronoi_segment(MESH, 0.1),
    "a priority": lambda: unstruct.circumcenter_insertion(SQUARE, 0.3, priority="x"),
    "points for a domain": lambda: unstruct.constrained_delaunay(POINTS),
    "hull that is a text": lambda: unstruct.constrained_delaunay(SQUARE, hull="no"),
    "conform to nothing": lambda: unstruct.conforming_delaunay(None),
    "triangulate a domain": lambda: unstruct.delaunay(SQUARE),
    "triangulate a text": lambda: unstruct.delaunay("abc"),
    "voronoi of nothing": lambda: unstruct.voronoi(None),
    "wrap a domain": lambda: unstruct.gift_wrap(SQUARE),
    "smooth a domain": lambda: unstruct.smooth(SQUARE),
    "smooth by a method": lambda: unstruct.smooth(MESH, "x"),
    "swap in a domain": lambda: unstruct.swap_diagonals(SQUARE),
    "check a domain": lambda: unstruct.check(SQUARE),
    "check against a mesh": lambda: unstruct.check(MESH, domain=MESH),
    "check by a text": lambda: unstruct.check(MESH, delaunay="foo"),
    "statistics of a domain": lambda: unstruct.statistics(SQUARE),
    "compare a mesh": lambda: unstruct.compare(MESH),
    "a quality": lambda: MESH.quality("foo"),
    "no quality": lambda: MESH.quality(None),
    "find a text": lambda: MESH.find_simplex("a"),
    "select a text": lambda: MESH.select("x"),
    "select beyond the end": lambda: MESH.select([1000]),
    "a view in space of a plane": lambda: MESH.plot(azimuth=30),
    "a view in space of a domain": lambda: view.plot(SQUARE, explode=0.2),
    "a value each in a plot": lambda: MESH.plot(values=[1.0]),
    "names in a plot": lambda: MESH.plot(names="a"),
    "plot nothing": lambda: view.plot(None),
    "plot values of a domain": lambda: view.plot(SQUARE, values=[1.0]),
    "qualities of a domain": lambda: view.plot_quality(SQUARE),
    "does a domain contain a text": lambda: SQUARE.contains("a"),
    "a domain of nothing": lambda: Domain(None, None),
    "a polygon of a text": lambda: Domain.polygon("abc"),
    "holes that are a number": lambda: Domain.polygon([(0, 0), (1, 0), (0, 1)], holes=5),
    "a radius that is a text": lambda: Domain.disc((0, 0), "1"),
    "a section of no name": lambda: Domain.naca(None),
    "letters of a number": lambda: Domain.letters(5),
    "sampled by a text": lambda: SQUARE.sampled("x"),
    "holes of a number": lambda: SQUARE.with_holes(5),
    "a mesh of nothing": lambda: Mesh(None, None),
    "cells that are texts": lambda: Mesh([(0, 0), (1, 0), (0, 1)], [[0, 1, "a"]]),
    "sources at a text": lambda: unstruct.sizing.sources("a", 0.1),
    "a growth that is a text": lambda: unstruct.sizing.sources([(0, 0)], 0.1, growth="x"),
    "an arc about a text": lambda: unstruct.Arc("a", 1, 2, 3),
    "a triangulation of a text": lambda: unstruct.Triangulation("a"),
}


@pytest.mark.parametrize("call", WRONG.values(), ids=WRONG)
def test_wrong_arguments(call) -> None:
    with pytest.raises(UnstructError) as caught:
        call()
    assert len(str(caught.value)) > 15, "an error says what is wrong and what to do"
