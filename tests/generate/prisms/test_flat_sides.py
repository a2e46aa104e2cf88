"""Plane ends of a duct cut into triangles: layers end there as on one polygon, and check knows it."""

from __future__ import annotations

import re

import numpy as np
import pytest

from unstruct import Domain, InputError, Layers, check, examples
from unstruct.generate.prisms.flat_sides import with_flat_sides
from unstruct.generate.prisms.prismatic_layers import prismatic_layers

LAYERS = Layers(first=0.01, growth=1.4, count=5)


@pytest.mark.parametrize("stop", ["squeeze", "stop"])
@pytest.mark.parametrize("cells", ["wedge", "tetrahedron"])
def test_a_cylinder_from_inside(stop: str, cells: str) -> None:
    tube = Domain.cylinder(size=0.25)
    mesh = prismatic_layers(tube, 0.25, layers=LAYERS, walls="side", stop=stop, cells=cells)
    assert mesh.complete and check(mesh, domain=tube)
    first = [int(tube.markers[name].min()) for name in ("bottom", "top")]
    assert set(mesh.face_piece.tolist()) == {*tube.markers["side"].tolist(), *first}
    alone = prismatic_layers(tube, layers=LAYERS, walls="side", side="inside", stop=stop, cells=cells)
    assert check(alone)
    # The same faces of the layers are in the planes; only there are tetrahedra beyond them.
    ends = [int(np.isin(m.face_piece, first).sum()) for m in (alone, mesh)]
    assert 0 < ends[0] < ends[1]


def test_check_still_sees_what_is_wrong() -> None:
    """A mesh of the cylinder is none of one with other names, or with a corner of the end moved."""
    tube = Domain.cylinder(size=0.25)
    mesh = prismatic_layers(tube, 0.25, layers=LAYERS, walls="side")
    some = tube.markers["top"][:3]
    other = Domain(tube.points, tube.facets, markers=dict(tube.markers) | {"some": some})
    assert not check(mesh, domain=other)
    points = tube.points.copy()
    inner = np.setdiff1d(
        np.unique([tube.facets[i] for i in tube.markers["top"]]),
        [tube.facets[i] for i in tube.markers["side"]],
    )
    points[inner[0], 2] += 1e-3
    assert not check(mesh, domain=Domain(points, tube.facets, markers=tube.markers))


def test_what_is_not_touched() -> None:
    tube = Domain.cylinder(size=0.25)
    for walls in (None, ["side", "top", "bottom"]):
        assert with_flat_sides(tube, walls)[0] is tube
    new, walls, parts = with_flat_sides(tube, "side")
    assert len(new.facets) == len(tube.markers["side"]) + 2 and len(walls) == len(tube.markers["side"])
    assert parts is not None and np.array_equal(new.points, tube.points[parts.vertex])
    with pytest.raises(InputError, match="side"):
        with_flat_sides(tube, "sides")


@pytest.mark.parametrize("moved", [False, True])
@pytest.mark.parametrize("stop", ["squeeze", "stop"])
def test_layers_past_the_vertices_on_edges_between_sides(moved: bool, stop: str) -> None:
    """A box of triangles: rays at its corners run along edges, farther than the first vertices on these."""
    box = examples.meshed_sides(Domain.box(), 0.2)
    if moved:
        c, s = np.cos(0.3), np.sin(0.3)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        box = Domain(box.points @ turn.T @ turn[:, [1, 2, 0]].T + 3, box.facets, markers=box.markers)
    for walls, first in (
        ("bottom", 0.16),
        ("bottom", 0.3),
        (["bottom", "top"], 0.1),
        (["bottom", "left"], 0.1),
    ):
        mesh = prismatic_layers(box, 0.2, layers=Layers(first, 1.0, 4), walls=walls, stop=stop)
        assert mesh.complete and check(mesh, domain=box)
        assert mesh.steps["height"].max() > 0.2


def turned(body: Domain) -> Domain:
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return Domain(body.points @ turn.T @ turn[:, [1, 2, 0]].T + 3, body.facets, markers=body.markers)


@pytest.mark.parametrize("stop", ["squeeze", "stop"])
def test_a_floor_whose_sides_are_concave(stop: str) -> None:
    """The floor of a step, and a star: triangles of the cap cross the planes of sides, but not these."""
    ell = Domain.extruded(Domain.polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]))
    angle = np.arange(10) * np.pi / 5
    spikes = np.where(np.arange(10) % 2, 1.0, 0.4)
    star = Domain.extruded(Domain.polygon(np.column_stack([spikes * np.cos(angle), spikes * np.sin(angle)])))
    for body in (ell, examples.meshed_sides(ell, 0.4), examples.meshed_sides(star, 0.3)):
        for some in (body, turned(body)):
            mesh = prismatic_layers(
                some, 0.4, layers=Layers(0.03, 1.2, 4), walls=["bottom", "top"], stop=stop
            )
            assert check(mesh, domain=some) and mesh.counts["limited: crossing"] == 0
            assert mesh.figures["share of full heights"] == 1.0


def test_walls_that_end_where_the_body_is_concave() -> None:
    """Layers on one side of a step alone would end within the body, where nothing is to end on."""
    ell = Domain.extruded(Domain.polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]))
    thin = Layers(0.03, 1.2, 4)
    for walls in (2, 3):
        with pytest.raises(InputError, match="concave"):
            prismatic_layers(ell, 0.4, layers=thin, walls=walls)
        assert check(prismatic_layers(ell, layers=thin, walls=walls, side="inside"))
    for walls in ([2, 3], 0, 5):
        assert check(prismatic_layers(ell, 0.4, layers=thin, walls=walls), domain=ell)


def test_facets_in_the_plane_of_a_side_that_are_another_piece() -> None:
    """Layers slide on the facets beside walls, not on a strip above them, nor on a window."""
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    points = [(x, y, z) for z in (0.0, 0.3, 1.0) for x, y in corners]
    rows = [[3, 2, 1, 0], [8, 9, 10, 11]]
    rows += [
        [4 * k + i, 4 * k + (i + 1) % 4, 4 * k + 4 + (i + 1) % 4, 4 * k + 4 + i]
        for k in (0, 1)
        for i in range(4)
    ]
    strips = Domain(points, rows, markers={"bottom": [0], "low": range(2, 6)})
    window = [(x, 0.0, z) for x, z in ((0.3, 0.3), (0.7, 0.3), (0.7, 0.7), (0.3, 0.7))]
    sides = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    pane = [8, 9, 10, 11]
    glazed = Domain(
        [(x, y, z) for z in (0, 1) for x, y in corners] + window,
        [[3, 2, 1, 0], [4, 5, 6, 7], [sides[0], pane], pane, *sides[1:]],
        markers={"bottom": [0], "inlet": [3]},
    )
    for body in (strips, turned(strips), glazed):
        for first in (0.05, 0.08, 0.2):
            mesh = prismatic_layers(body, 0.3, layers=Layers(first, 1.0, 4), walls="bottom")
            assert check(mesh, domain=body)
            assert mesh.steps["height"].min() < 0.3


CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])


def test_messages_tell_the_numbers_of_the_body_that_was_given() -> None:
    """Point 0 lies inside a flat side, which is joined, and the facets beside walls come last."""
    points = np.vstack([[[1.0, 0.5, 0.5]], CUBE, [[0.5, -0.2, 0.5]]])
    fan = [[0, a, b] for a, b in ((2, 3), (3, 7), (7, 6), (6, 2))]
    bent = [[9, a, b] for a, b in ((1, 2), (2, 6), (6, 5), (5, 1))]
    body = Domain(points, [*fan, *bent, [3, 4, 8, 7], [4, 1, 5, 8], [1, 4, 3, 2], [5, 6, 7, 8]])
    with pytest.raises(InputError, match="in 3 planes") as told:
        prismatic_layers(body, 0.3, layers=LAYERS, walls=[10], side="inside")
    found = re.search(r"point (\d+), at \(([^)]*)\)", str(told.value))
    assert found is not None
    assert np.array_equal(points[int(found[1])], [float(x) for x in found[2].split(",")])
    joined, walls, parts = with_flat_sides(body, [10])
    assert parts is not None and len(joined.facets) < len(body.facets)
    assert joined.name(int(walls[0])) == "facet 10"


def test_a_wall_within_a_flat_side() -> None:
    rows = [[0, 2, 1], [0, 3, 2], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    with pytest.raises(InputError, match="within a flat side: facet 1 lies beside them in its plane"):
        prismatic_layers(Domain(CUBE.astype(float), rows), layers=LAYERS, walls=[0], side="inside")


def test_an_inner_facet_that_ends_at_a_wall() -> None:
    points = np.vstack([CUBE, [[0.5, 0, 0], [0.5, 1, 0], [0.5, 0.5, 0.6]]])
    rows = [
        [0, 3, 9, 8],
        [8, 9, 2, 1],
        [4, 5, 6, 7],
        [0, 8, 1, 5, 4],
        [1, 2, 6, 5],
        [2, 9, 3, 7, 6],
        [3, 0, 4, 7],
    ]
    body = Domain(points, rows, inner=[[8, 9, 10]])
    with pytest.raises(
        InputError, match=r"inner facet 0 ends at the edge 8-9 of facet 0.*layers would cut it"
    ):
        prismatic_layers(body, layers=LAYERS, walls=[0, 1], side="inside")
