"""Bodies minus other bodies inside of them."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, DomainError, InputError, check, constrained_delaunay

BOX = Domain.box((-3, -3, -3), (3, 3, 3), regions={"air": [(2.5, 2.5, 2.5)]})


def small(x: float, size: float = 1.0, **options: object) -> Domain:
    return Domain.box((x, 0, 0), (x + size, size, size), **options)


def test_names_inner_pieces_and_regions_of_all_are_kept() -> None:
    crossed = Domain.box((-2.0, -1, -1), (0, 1, 1), regions={"hole": [(-1.5, 0, 0)]})
    wall = Domain(
        [*BOX.points, (2.9, 0, 0), (2.9, 1, 0), (2.9, 0, 1)],
        BOX.facets,
        inner=[[8, 9, 10], [8, 9]],
        markers={**BOX.markers, "wall": [6]},
        regions=BOX.regions,
    )
    with pytest.raises(InputError, match=r"regions\['hole'\]\[0\] = .* lies outside the body"):
        wall.with_holes(crossed)
    ball = Domain.ball((1.2, 0, 0), 0.7, size=0.5)
    named = Domain(ball.points, ball.facets, markers={"ball": np.arange(len(ball.facets))})
    both = wall.with_holes(Domain.box((-2, -1, -1), (0, 1, 1)), named)
    assert both.volume == pytest.approx(216 - 8 - named.volume)
    assert set(both.markers) == {*BOX.markers, "wall", "ball"}, "equal names are joined"
    assert [len(both.markers[n]) for n in ("left", "wall", "ball")] == [2, 1, len(ball.facets)]
    assert both.facets[12:][0].tolist() == (ball.facets[0] + 11 + 8).tolist()
    assert [len(row) for row in both.inner] == [3, 2] and min(both.inner[0]) == 8
    mesh = constrained_delaunay(both)
    assert check(mesh, domain=both) and mesh.regions == {"air": 0}
    assert len(mesh.markers["ball"]) == len(ball.facets)


@pytest.mark.parametrize(
    ("holes", "error", "word"),
    [
        ((small(5.0),), InputError, r"others\[0\] lies outside the domain near \("),
        ((small(0.0), small(0.25, 0.5)), DomainError, r"others|facet|overlap|equal|point"),
        (
            (small(0.0), Domain.box((0.25, 0.25, 0.25), (0.5, 0.5, 0.5))),
            InputError,
            r"others\[0\] lies|others\[1\] lies inside others\[0\]",
        ),
        ((small(2.5),), DomainError, "cross"),
        ((Domain.rectangle(),), InputError, "bodies in space"),
        ((Domain.ball().points,), InputError, "must be a Domain"),
    ],
)
def test_bodies_that_are_no_holes_are_named(holes: tuple, error: type[Exception], word: str) -> None:
    with pytest.raises(error, match=word):
        BOX.with_holes(*holes)


def test_a_hole_in_a_cavity_lies_outside() -> None:
    hollow = BOX.with_holes(Domain.box((-2, -2, -2), (2, 2, 2)))
    with pytest.raises(InputError, match="outside the domain"):
        hollow.with_holes(small(0.0))
    assert hollow.with_holes().volume == pytest.approx(216 - 64)
    with pytest.raises(InputError, match="planar domains"):
        Domain.rectangle().with_holes(BOX)
