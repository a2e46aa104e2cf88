"""Qualities of cells of all kinds: corner by corner, face by face, and known values."""

from __future__ import annotations

import math

import numpy as np
import pytest
from mixed_cells import GOOD, cloud, planar, spatial

from unstruct import InputError, Mesh, delaunay
from unstruct.geometry import simplex

IDEAL = {
    "quad": [[0, 0], [1, 0], [1, 1], [0, 1]],
    "wedge": [*([0, 0, 0], [1, 0, 0], [0.5, 3**0.5 / 2, 0]), *([0, 0, 1], [1, 0, 1], [0.5, 3**0.5 / 2, 1])],
    "pyramid": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0.5**0.5]],
    "hexahedron": GOOD["hexahedron"],
}
FACES = {
    "pyramid": [(0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    "wedge": [(0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    "hexahedron": [
        *((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    ],
}


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v)


def by_corners(kind: str, x: np.ndarray) -> float:
    """The edges at each corner, oriented as in the ideal cell."""
    best = np.array(IDEAL[kind], dtype=float)
    edges = {frozenset((f[i], f[i - 1])) for f in FACES[kind] for i in range(len(f))}
    values = []
    for v in range(len(x)):
        around = [w for w in range(len(x)) if frozenset((v, w)) in edges]
        threes = [around] if len(around) == 3 else [(0, 1, 2), (1, 2, 3), (2, 3, 0), (3, 0, 1)]
        for three in threes:
            here = np.linalg.det([unit(x[w] - x[v]) for w in three])
            ideal = np.linalg.det([unit(best[w] - best[v]) for w in three])
            values.append(here / ideal)
    return min(values)


@pytest.mark.parametrize("kind", FACES)
def test_scaled_jacobians_of_solids(kind: str) -> None:
    rng = np.random.default_rng(0)
    x = np.array(IDEAL[kind]) + 0.25 * rng.normal(size=(100, len(IDEAL[kind]), 3))
    assert cloud(kind, x).quality("scaled_jacobian") == pytest.approx([by_corners(kind, p) for p in x])
    near = np.array(IDEAL[kind]) + 0.3 * rng.normal(size=(3000, len(IDEAL[kind]), 3))
    assert cloud(kind, near).quality("scaled_jacobian").max() <= 1 + 1e-12


@pytest.mark.parametrize("kind", IDEAL)
def test_ideal_cells_have_one(kind: str) -> None:
    x = np.array([IDEAL[kind]], dtype=float)
    mesh = cloud(kind, x)
    assert mesh.quality("scaled_jacobian") == pytest.approx([1])
    assert cloud(kind, x * 1e200).quality("scaled_jacobian") == pytest.approx([1])
    assert cloud(kind, x * ([-1] + [1] * (x.shape[2] - 1))).quality("scaled_jacobian") == pytest.approx([-1])


def test_known_values() -> None:
    """By this measure rectangles are as good as squares, and a rhombus has the sine of its angle."""
    rectangle = cloud("quad", np.array([[[0, 0], [9, 0], [9, 1], [0, 1]]]))
    assert rectangle.quality("scaled_jacobian") == pytest.approx([1])
    rhombus = cloud("quad", np.array([[[0, 0], [1, 0], [1.5, 3**0.5 / 2], [0.5, 3**0.5 / 2]]]))
    assert rhombus.quality("scaled_jacobian") == pytest.approx([math.sin(math.pi / 3)])
    assert rhombus.quality("min_angle") == pytest.approx([60])
    assert rhombus.quality("max_angle") == pytest.approx([120])
    collapsed = cloud("hexahedron", np.zeros((1, 8, 3)))
    assert collapsed.quality("scaled_jacobian").tolist() == [0] and np.isnan(collapsed.quality("min_angle"))


@pytest.mark.parametrize("kind", FACES)
def test_angles_of_all_faces(kind: str) -> None:
    x = np.array(IDEAL[kind]) + 0.1 * np.random.default_rng(1).normal(size=(30, len(IDEAL[kind]), 3))
    least, greatest = [], []
    for p in x:
        found = [
            math.degrees(math.acos(unit(p[f[i - 1]] - p[f[i]]) @ unit(p[f[(i + 1) % len(f)]] - p[f[i]])))
            for f in FACES[kind]
            for i in range(len(f))
        ]
        least.append(min(found))
        greatest.append(max(found))
    assert cloud(kind, x).quality("min_angle") == pytest.approx(least)
    assert cloud(kind, x).quality("max_angle") == pytest.approx(greatest)


@pytest.mark.parametrize("mesh", [planar(4, jitter=0.3), spatial(2, jitter=0.1)], ids=repr)
def test_one_number_a_cell_in_their_order(mesh: Mesh) -> None:
    for name in ("scaled_jacobian", "min_angle", "max_angle"):
        found = mesh.quality(name)
        assert found.shape == (mesh.size,)
        for t in range(mesh.size):
            assert mesh.select([t]).quality(name) == pytest.approx(found[t : t + 1])
    assert (
        (mesh.quality("scaled_jacobian") > 0) | (mesh.jacobian_signs() <= 0) | (mesh.dimension == 2)
    ).all()


def test_triangles_as_polygons() -> None:
    mesh = delaunay(np.random.default_rng(0).random((40, 2)))
    again = Mesh(mesh.points, cells={"polygon": mesh.simplices})
    for name in ("scaled_jacobian", "min_angle", "max_angle"):
        assert again.quality(name) == pytest.approx(simplex.quality(name, mesh.corners))
        assert mesh.quality(name) == pytest.approx(simplex.quality(name, mesh.corners), rel=1e-14)


def test_names_that_are_not_for_all_kinds() -> None:
    with pytest.raises(
        InputError, match=r"'2r/R' is a quality of simplices.*quad.*'scaled_jacobian', 'min_angle'"
    ):
        planar(3, seed=1).quality("2r/R")
    with pytest.raises(InputError, match="no quality measure is called 'best'"):
        planar(3).quality("best")


def test_summaries_of_mixtures() -> None:
    for mesh in (planar(4, seed=1), spatial(2)):
        summary = mesh.summary()
        assert summary["scaled_jacobian"]["min"] == mesh.quality("scaled_jacobian").min()
        assert [summary[kind] for kind in mesh.cells] == [len(block) for block in mesh.cells.values()]
        assert summary["volume"] == pytest.approx(16 if mesh.dimension == 2 else 512) and "euler" in str(
            summary
        )
    surface = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 1]], cells={"quad": [[0, 1, 2, 3]]})
    assert surface.summary()["max_angle"]["max"] <= 180 and 0 < surface.quality("scaled_jacobian")[0] < 1
