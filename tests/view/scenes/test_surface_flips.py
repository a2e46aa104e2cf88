"""The folded ribbon: what its eight pictures say is true."""

from __future__ import annotations

from itertools import pairwise
from math import dist, hypot

import numpy as np
import pytest

import unstruct
from unstruct.plain import intrinsic_delaunay as plain
from unstruct.studies import IntrinsicTriangulation
from unstruct.view import check_frame
from unstruct.view.scenes.surface_flips import (
    RIBBON_NAMES,
    ribbon,
    ribbon_flips,
    surface_flip_frames,
    unrolled,
)


def names(edge: tuple[int, int]) -> str:
    return "".join(sorted(RIBBON_NAMES[v] for v in edge))


def test_the_frames() -> None:
    frames = surface_flip_frames()
    for one in frames:
        check_frame(one)
    assert len(frames) == 8 and [one["view"] for one in frames] == [frames[0]["view"]] * 8
    assert frames[1]["caption"].startswith("DE: the angles at C and F make 287 degrees")
    for one in frames:  # a circle ends above the ribbon in space, where it means nothing
        arcs = [item["data"] for item in one["items"] if item["role"] == "circumcircle"]
        assert all(min(y for pair in arc for _, y in np.reshape(pair, (2, 2))) > -0.4 for arc in arcs)
        assert len(arcs) == ("make" in one["caption"] and "no angles" not in one["caption"])


def test_lengths_remain_when_the_ribbon_is_unrolled() -> None:
    points, triangles = ribbon()
    flat = unrolled(points, triangles)
    for row in triangles:
        for k in range(3):
            a, b = row[k], row[k - 1]
            assert hypot(flat[a][0] - flat[b][0], flat[a][1] - flat[b][1]) == pytest.approx(
                dist(points[a], points[b])
            )
    folded = [
        unstruct.simplex.volume(np.array([points[v] for v in set(s) | set(t)]))
        for s, t in pairwise(triangles)
    ]
    assert min(abs(v) for v in folded) > 1e-3  # no two neighbors are in one plane


def test_the_flips_are_those_of_a_plane() -> None:
    points, triangles = ribbon()
    steps = ribbon_flips()
    assert [(names(s["edge"]), names(s["new"])) for s in steps[:-1]] == [
        ("DE", "CF"),
        ("CE", "BF"),
        ("DF", "CG"),
    ]
    energies = [s["energy"] for s in steps]
    assert all(p > q for p, q in pairwise(energies)) and min(s["angles"] for s in steps[:-1]) > 180
    planar = unstruct.delaunay(np.array(unrolled(points, triangles)))
    edges = {(min(e), max(e)) for row in planar.simplices.tolist() for e in zip(row, [*row[1:], row[0]])}
    assert set(steps[-1]["edges"]) <= edges


def test_the_library_does_the_same() -> None:
    points, triangles = ribbon()
    found = IntrinsicTriangulation(unstruct.Mesh(points, triangles))
    assert found.energy == pytest.approx(ribbon_flips()[0]["energy"])
    found.delaunay()
    assert found.energy == pytest.approx(ribbon_flips()[-1]["energy"])
    rows = {tuple(sorted(row)) for row in found.simplices.tolist()}
    surface, _ = plain.intrinsic_delaunay(points, triangles)
    assert rows == {tuple(sorted(surface.vertex[t, k] for k in range(3))) for t in range(len(triangles))}
