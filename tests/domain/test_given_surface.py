"""What a surface hands to methods and to the check: names of facets, triangles, edges, numbers."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, Mesh
from unstruct.domain.given_surface import given_surface
from unstruct.errors import InputError

SQUARE = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0], [2, 2, 0]]
FANS = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]


def test_a_body() -> None:
    """Facets face outward, however they are given; two coplanar facets with different names have an edge."""
    box = Domain.box((0, 0, 0), (1, 1, 1))
    facets = [list(row)[::-1] if i % 2 else list(row) for i, row in enumerate(box.facets)]
    body = Domain(box.points, facets, markers={"one": [0, 1], "two": [1, 5]})
    given = given_surface(body)
    center = given.support.points[given.support.triangles].mean(axis=1)
    assert (((center - 0.5) * given.support.normals).sum(axis=1) > 0).all()
    assert len(given.support.features) == 12 and given.edges == {}
    assert given.names["one"].tolist() == np.isin(given.piece, [0, 1]).tolist()
    found = given.markers(given.support.triangles, np.arange(12))
    assert len(found["two"]) == 4
    assert len(given_surface(body, None).support.features) == 10, "the other two have the same names"


def test_inner_parts_of_a_body() -> None:
    """An inner facet branches off; an inner segment on a facet is kept, one inside of the body is not."""
    box = Domain.box((0, 0, 0), (2, 2, 2))
    low = box.points.tolist()
    points = [*low, [0.5, 1, 1], [0.5, 1, 1.5]]
    wall = [i for i, p in enumerate(low) if p[0] == p[1]]
    wall = [wall[0], wall[1], wall[3], wall[2]] if low[wall[0]][0] == low[wall[1]][0] else wall
    body = Domain(
        points, [list(row) for row in box.facets], inner=[wall, [8, 9]], markers={"wall": [6], "wire": [7]}
    )
    given = given_surface(body)
    assert given.names["wall"].sum() == 2 and "wire" not in given.names and "wire" not in given.edges
    assert {8, 9} & set(given.support.features.ravel().tolist()) == set()


def test_a_mesh() -> None:
    markers = {"left": [[4, 0, 3]], "rim": [[0, 1], [2, 1]], "spot": [[4]], "region": [7, 7, 9, 7]}
    given = given_surface(Mesh(SQUARE, FANS, markers=markers))
    assert given.names["left"].tolist() == [False, False, False, True]
    assert given.edges["rim"].tolist() == [[0, 1], [2, 1]] and given.values["region"].tolist() == [7, 7, 9, 7]
    kept = set(map(tuple, np.sort(given.support.features, axis=1).tolist()))
    assert kept == {(0, 1), (1, 2), (2, 3), (0, 3), (0, 4), (3, 4), (2, 4)}
    assert given.support.corners.tolist() == [0, 1, 2, 3, 4]
    found = given.markers(np.array(FANS), np.array([3, 3, 2, 0]))
    assert found["left"].tolist() == FANS[:2] and found["region"].tolist() == [7, 7, 9, 7]


@pytest.mark.parametrize(
    ("surface", "text"),
    [
        ("cube.stl", "not str"),
        (Mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]), "triangles in space"),
        (Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]]), "triangles in space"),
        (Domain([[0, 0], [1, 0], [0, 1]], [[0, 1], [1, 2], [2, 0]]), "in the plane"),
    ],
)
def test_what_is_no_surface(surface: object, text: str) -> None:
    with pytest.raises(InputError, match=text):
        given_surface(surface)
