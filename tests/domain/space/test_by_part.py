"""Sizes by region in bodies: each point has that of its part, on facets the smaller one."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import (
    Domain,
    InputError,
    check,
    circumcenter_insertion,
    constrained_delaunay,
    refine,
    tetrahedralize,
    voronoi_segment,
)
from unstruct.domain.space.by_part import size_by_part

BOX = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])


def halves() -> Domain:
    """A box with a wall in the middle, and a void in its left half."""
    low, void = Domain.box((0, 0, 0), (2, 1, 1)), Domain.box((0.3, 0.3, 0.3), (0.6, 0.6, 0.6))
    wall = [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)]
    front, back = (0, 16, 4), (2, 17, 6)  # points on the edges at which the wall ends
    sides = [
        (0, 1, 3, 2), (4, 6, 7, 5), (*front, 5, 19, 1), (back[0], 3, 18, 7, 6, 17),
        (0, 2, 17, 6, 4, 16), (1, 19, 5, 7, 18, 3),
    ]  # fmt: skip
    return Domain(
        np.concatenate([low.points, void.points, wall]), [*sides, *(BOX + 8)], inner=[(16, 17, 18, 19)],
        regions={"left": [(0.1, 0.1, 0.1)], "right": [(1.9, 0.9, 0.9)]},
    )  # fmt: skip


def test_each_point_has_the_size_of_its_part() -> None:
    body = halves()
    field = size_by_part(body, {"left": 0.1, "right": lambda x: 0.2 + 0.0 * x[:, 0]})
    x = np.random.default_rng(0).uniform((-0.2, -0.2, -0.2), (2.2, 1.2, 1.2), size=(500, 3))
    bare = constrained_delaunay(body)
    cell = bare.find_simplex(x)
    region = bare.markers["region"][cell]
    inside = cell >= 0
    assert np.array_equal(field(x)[inside], np.where(region[inside] == body_number(bare, "left"), 0.1, 0.2))
    out = x[~inside]
    assert np.array_equal(field(out)[out[:, 0] < 0.8], np.full((out[:, 0] < 0.8).sum(), 0.1))
    assert np.array_equal(field(out)[out[:, 0] > 1.2], np.full((out[:, 0] > 1.2).sum(), 0.2))
    on_wall = np.column_stack([np.ones(20), np.random.default_rng(1).random((20, 2))])
    assert (field(on_wall) == 0.1).all() and (field(body.points[16:]) == 0.1).all()
    assert field(body.points[4:5])[0] == 0.2
    assert size_by_part(body, {"left": 0.1, None: 0.1}).constant == 0.1
    assert size_by_part(body, 0.3) == 0.3


def body_number(mesh: object, name: str) -> int:
    return mesh.regions[name]  # type: ignore[attr-defined]


def test_tetrahedralize_by_regions() -> None:
    body = halves()
    mesh = tetrahedralize(body, {"left": 0.12, "right": 0.3})
    assert mesh.complete and check(mesh, domain=body)
    volume = mesh.volumes
    region = mesh.markers["region"]
    fine, coarse = (volume[region == mesh.regions[name]].mean() for name in ("left", "right"))
    assert 4 < coarse / fine < 20
    same = tetrahedralize(body, {None: 0.3, "left": 0.12})
    assert np.array_equal(mesh.points, same.points)
    curved = tetrahedralize(body, {"left": lambda x: 0.1 + 0.1 * x[:, 0], None: 0.3})
    assert check(curved, domain=body)


def test_inner_parts_within_inner_facets() -> None:
    """A box of inner facets within a box is a part of its own; none of it is outside."""
    outer, inner = Domain.box((0, 0, 0), (1, 1, 1)), Domain.box((0.4, 0.4, 0.4), (0.6, 0.6, 0.6))
    body = Domain(
        np.concatenate([outer.points, inner.points]), BOX, inner=[list(row) for row in BOX + 8],
        regions={"core": [(0.5, 0.5, 0.5)]},
    )  # fmt: skip
    field = size_by_part(body, {"core": 0.05, None: 0.2})
    assert field([[0.5, 0.5, 0.5], [0.1, 0.5, 0.5], [0.4, 0.5, 0.5]]).tolist() == [0.05, 0.2, 0.05]
    mesh = tetrahedralize(body, {"core": 0.05, None: 0.25})
    assert check(mesh, domain=body)
    volume, region = mesh.volumes, mesh.markers["region"]
    assert (
        volume[region == mesh.regions["core"]].mean() < 1e-4 < volume[region != mesh.regions["core"]].mean()
    )


def test_errors_are_those_of_the_plane() -> None:
    body = halves()
    for method in (tetrahedralize, voronoi_segment, circumcenter_insertion, refine):
        with pytest.raises(InputError, match=r"names region 'top'.*\['left', 'right'\].*key None"):
            method(body, {"top": 0.1, None: 0.2})
    for method in (tetrahedralize, voronoi_segment, circumcenter_insertion):
        with pytest.raises(
            InputError, match=r"no entry for region 'right' \(near \(.*, .*, .*\)\).*key None"
        ):
            method(body, {"left": 0.2})
    with pytest.raises(InputError, match="positive and finite"):
        tetrahedralize(body, {"left": -0.2, None: 0.3})
