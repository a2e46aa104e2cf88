"""Meshes that touch without common faces: `join` says where, and says nothing where there is nothing."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from mixed_cells import planar, spatial

from unstruct import Domain, Mesh, constrained_delaunay, delaunay, join

CUBE = np.array([[x, y, z] for z in (0.0, 1) for y in (0.0, 1) for x in (0.0, 1)])


def block(moved: tuple[float, ...], names: dict[str, list[int]] | None = None) -> Mesh:
    """A cube of one hexahedron; its faces by name, as places among those of the boundary."""
    mesh = Mesh(CUBE + moved, cells={"hexahedron": [[0, 1, 3, 2, 4, 5, 7, 6]]})
    return Mesh(
        mesh.points, cells=mesh.cells, markers={k: mesh.boundary[v] for k, v in (names or {}).items()}
    )


def told(*meshes: Mesh) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        join(*meshes)
    assert all(one.filename == __file__ for one in caught)
    return [str(one.message) for one in caught]


def test_two_triangles_on_a_quadrilateral() -> None:
    top = [i for i, row in enumerate(block((0, 0, 0)).boundary) if (CUBE[row][:, 2] == 1).all()]
    below = block((0, 0, 0), {"top": top, "all": list(range(6))})
    above = delaunay(np.concatenate([CUBE[4:], [[0.5, 0.5, 2]]]))
    (text,) = told(below, above)
    assert "1 faces of meshes[0] ('top', 'all') lie on 2 faces of meshes[1] (no name)" in text
    assert "first at [0.5, 0.5, 1.0] (vertices [4, 5, 7, 6])" in text and "mesh one with the faces" in text


def test_corners_that_are_not_quite_equal() -> None:
    (text,) = told(block((0, 0, 0)), block((0, 0, 1 + 2**-40)))
    assert "1 faces of meshes[0] (no name) lie on 1 faces" in text
    assert "their corners are up to 9.1e-13 apart: give them the same coordinates" in text
    assert told(block((0, 0, 0)), block((0, 0, 1))) == []
    assert told(block((0, 0, 0)), block((0, 0, 1.001))) == [], "a gap"


@pytest.mark.parametrize("moved", [(0.3, 0.0, 1.0), (0.5, 0.5, 1.0), (-0.9, 0.2, 1.0)])
def test_faces_that_cover_each_other_in_part(moved: tuple[float, float, float]) -> None:
    (text,) = told(block((0, 0, 0)), block(moved))
    assert "divided differently" in text
    small = Mesh(CUBE * 0.1 + [0.45, 0.45, 1.0], cells={"hexahedron": [[0, 1, 3, 2, 4, 5, 7, 6]]})
    assert len(told(block((0, 0, 0)), small)) == 1


def test_common_edges_and_corners_are_no_contact() -> None:
    assert told(block((0, 0, 0)), block((1, 1, 0)), block((-1, -1, -1)), block((0, 0, 3))) == []


def test_the_plane_and_surfaces() -> None:
    one = constrained_delaunay(Domain.rectangle())
    finer = [(1, 0), (2, 0), (2, 1), (1, 1), (1, 0.25)]
    names = {"seam": [3, 4]}
    two = constrained_delaunay(Domain(finer, [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0)], markers=names))
    (text,) = told(one, two)
    assert "1 edges of meshes[0] ('right') lie on 2 edges of meshes[1] ('seam'), first at [1.0, 0.5]" in text

    def lifted(mesh: Mesh) -> Mesh:
        x, y = mesh.points.T
        return Mesh(np.column_stack([x, y, x * 0.25]), mesh.simplices)

    assert len(told(lifted(one), lifted(two))) == 1
    assert told(one, constrained_delaunay(Domain.rectangle((1, 0), (2, 1)))) == []


@pytest.mark.parametrize("scale", [1e-250, 1.0, 1e250])
def test_any_unit(scale: float) -> None:
    a, b = block((0, 0, 0)), block((0.3, 0.0, 1.0))
    both = [Mesh(mesh.points * scale, cells=mesh.cells) for mesh in (a, b)]
    assert len(told(*both)) == 1


def test_parts_of_meshes_have_no_contacts() -> None:
    for mesh in (planar(6, jitter=0.2, seed=2), spatial(3, jitter=0.1)):
        part = np.arange(mesh.size) % 3
        assert told(*(mesh.select(part == k) for k in range(3))) == []


def test_the_first_pairs_are_told() -> None:
    row = [block((k, 0.25 * (k % 2), 0)) for k in range(9)]
    assert len(told(*row)) == 5
