"""What messages say where there are no layers, or where points that are to be vertices lie in them."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, IncompleteWarning, InputError, Layers, Mesh, prismatic_layers

BOX = Domain(Domain.box().points, Domain.box().triangulated.triangles)
THIN = Layers(0.01, 1.3, 4)


def with_points(*places: tuple[float, ...], **options) -> Domain:
    return Domain(np.concatenate([BOX.points, places]), BOX.facets, **options)


def test_points_in_the_layers() -> None:
    n = len(BOX.points)
    loose = with_points((0.01, 0.5, 0.4))
    within = with_points((0.01, 0.5, 0.4), (0.02, 0.5, 0.4), inner=[[n, n + 1]])
    for body in (loose, within):
        with pytest.raises(InputError, match="lies in the layers"):
            prismatic_layers(body, 2.0, layers=THIN)
    crossing = with_points((0.01, 0.5, 0.4), (0.5, 0.5, 0.4), inner=[[n, n + 1]])
    with pytest.raises(InputError, match="no walls, near"):
        prismatic_layers(crossing, 2.0, layers=THIN)
    assert prismatic_layers(with_points((0.5, 0.5, 0.4)), 2.0, layers=THIN).complete


@pytest.mark.parametrize(
    "layers, stop, words",
    [
        (Layers(1e-17, 1.3, 4), "squeeze", "apart"),
        (Layers(0.1, 0.01, 20), "squeeze", "apart"),
        (Layers(0.1, 1000.0, 200), "squeeze", "total height"),
        (Layers(1e300, 1.3, 4), "squeeze", "total height"),
        (Layers(10.0, 1.3, 4), "stop", "stop=.squeeze."),
    ],
)
def test_why_there_are_no_layers(layers: Layers, stop: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        prismatic_layers(Domain(BOX.points + 1.0, BOX.facets), 1.0, layers=layers, stop=stop)


def test_a_mesh_without_triangles() -> None:
    for points in (np.empty((0, 3)), BOX.points):
        empty = Mesh(points, np.empty((0, 3), dtype=int))
        for size in (None, 1.0):
            with pytest.raises(InputError, match="no facets"):
                prismatic_layers(empty, size, layers=THIN)


def test_large_triangles_are_not_to_be_divided_by_an_option_that_is_refused() -> None:
    with pytest.warns(IncompleteWarning, match="divide it before") as told:
        prismatic_layers(BOX, 0.3, layers=THIN)
    assert not any("split_boundary" in str(w.message) for w in told)


def test_open_surfaces_that_cannot_be_closed_are_told_of_with_a_size_as_without() -> None:
    ball = Domain.ball(size=0.4)
    rows = np.asarray(ball.facets)
    ragged = rows[ball.points[rows].mean(axis=1)[:, 2] > 0]
    flat = [[0, 1, 2], [1, 3, 2]], [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
    soup = Mesh(ball.points[rows].reshape(-1, 3), np.arange(rows.size).reshape(-1, 3))
    for surface, words in (
        (Mesh(ball.points, ragged), "does not lie in a plane"),
        (Mesh(flat[1], flat[0]), "facets may be missing"),
        (soup, "Domain.surface.mesh, resolve=True. merge them"),
    ):
        for size in (None, 0.4):
            with pytest.raises(InputError, match=words):
                prismatic_layers(surface, size, layers=THIN)
    assert prismatic_layers(Domain.surface(soup, resolve=True), 0.4, layers=THIN).complete
