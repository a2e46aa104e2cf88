"""Layers and tetrahedra beyond them as one mesh: closed walls, walls that end on planes, names, figures."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError, check
from unstruct.generate.prisms.beyond import LARGEST_JUMP, LEAST_BEYOND, MEDIAN_JUMP, filled_beyond
from unstruct.generate.prisms.growing import grown_layers, in_tetrahedra
from unstruct.generate.prisms.records import Walls
from unstruct.generate.prisms.remainder import Grown
from unstruct.generate.prisms.stopping import stepped
from unstruct.sizing.field import as_size

RISE = np.concatenate([[0.0], np.cumsum(0.01 * 1.4 ** np.arange(6))])
OPTIONS = {"optimize": True, "seed": 0, "budget": None, "progress": False, "split_boundary": None}


def walls_of(domain: Domain, pieces: np.ndarray, *, turn: bool) -> Walls:
    shell = domain.triangulated
    on = np.isin(shell.piece, pieces)
    rows = shell.triangles[on]
    vertex, place = np.unique(rows, return_inverse=True)
    rows = place.reshape(-1, 3)[:, ::-1] if turn else place.reshape(-1, 3)
    planes = np.full((len(vertex), 2), -1, dtype=np.int32)
    return Walls(
        domain.points[vertex],
        rows.astype(np.int32),
        vertex.astype(np.int32),
        shell.piece[on],
        planes,
        np.empty((0, 3)),
    )


def grown_on(walls: Walls, direction: np.ndarray, level: np.ndarray | None = None) -> Grown:
    n = len(walls.points)
    level = np.full(n, len(RISE) - 1) if level is None else level
    steps = np.minimum(np.arange(len(RISE))[:, None], level)
    places = walls.points + RISE[steps][..., None] * direction
    return grown_layers(walls, np.arange(n), level, places, walls.triangles)


def slope(walls: Walls, x: np.ndarray) -> np.ndarray:
    """Levels that rise with a coordinate from 0 on, at most 1 apart along edges."""
    level = np.clip(np.round(x / 0.2).astype(np.int32), 0, len(RISE) - 1)
    ends = np.concatenate([walls.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    return stepped(ends, level, np.zeros(len(level), dtype=np.int8))[0]


def ball_in_box() -> tuple[Domain, Walls, np.ndarray]:
    ball = Domain.ball(size=0.4)
    body = Domain(ball.points, ball.facets, markers={"ball": range(len(ball.facets))})
    domain = Domain.box((-3, -3, -3), (3, 3, 3), regions={"air": [(2.9, 2.9, 2.9)]}).with_holes(body)
    walls = walls_of(domain, domain.markers["ball"], turn=False)
    return domain, walls, walls.points / np.linalg.norm(walls.points, axis=1)[:, None]


def duct(motion: np.ndarray | None = None) -> tuple[Domain, Walls, np.ndarray]:
    """A round tube whose ends are polygons, possibly turned."""
    tube = Domain.extruded(Domain.disc(), 2.0, size=0.4)
    motion = np.eye(3) if motion is None else motion
    domain = Domain(tube.points @ motion.T, tube.facets, markers=tube.markers)
    ends = np.concatenate([tube.markers[name] for name in ("bottom", "top")])
    walls = walls_of(domain, np.setdiff1d(np.arange(len(domain.facets)), ends), turn=True)
    inward = tube.points[walls.vertex] * [-1.0, -1.0, 0.0]
    return domain, walls, (inward / np.linalg.norm(inward, axis=1)[:, None]) @ motion.T


@pytest.mark.parametrize("cells", ["wedge", "tetrahedron"])
@pytest.mark.parametrize("stops", [False, True], ids=["all layers", "stops"])
def test_a_ball_in_a_box(cells: str, stops: bool) -> None:
    domain, walls, direction = ball_in_box()
    grown = grown_on(walls, direction, slope(walls, walls.points[:, 0] + 0.5) if stops else None)
    grown = in_tetrahedra(grown) if cells == "tetrahedron" else grown
    mesh, lacking = filled_beyond(domain, grown, as_size(1.0), OPTIONS)
    assert lacking == "" and mesh.complete and check(mesh, domain=domain)
    wanted = {"tetra"} if cells == "tetrahedron" else {"wedge", "tetra"} | ({"pyramid"} if stops else set())
    assert set(mesh.cells) == wanted
    assert mesh.regions == {"air": 0} and (mesh.markers["region"] == 0).all()
    assert len(mesh.markers["ball"]) == len(walls.triangles)
    assert np.array_equal(mesh.points[: len(grown.points)], grown.points)
    assert 1.0 < mesh.figures[MEDIAN_JUMP] <= mesh.figures[LARGEST_JUMP] and mesh.figures[LEAST_BEYOND] > 15


TURNED = np.array([(2.0, -2.0, 1.0), (1.0, 2.0, 2.0), (-2.0, -1.0, 2.0)]) / 3.0


@pytest.mark.parametrize("motion", [None, TURNED], ids=["straight", "turned"])
@pytest.mark.parametrize("stops", [False, True], ids=["all layers", "stops"])
def test_a_duct_from_inside(motion: np.ndarray | None, stops: bool) -> None:
    """Layers end in the planes of the ends, whose polygons are cut anew."""
    domain, walls, direction = duct(motion)
    along = walls.points @ (np.eye(3) if motion is None else motion)[:, 2]
    grown = grown_on(walls, direction, slope(walls, along) if stops else None)
    mesh, lacking = filled_beyond(domain, grown, as_size(0.5), OPTIONS)
    assert lacking == "" and mesh.complete and check(mesh, domain=domain)
    quads = [int((mesh.markers[name][:, 3:] >= 0).sum()) for name in ("bottom", "top")]
    around = int(domain.pieces.corners[domain.markers["top"][0]])
    assert quads == ([0, 5 * around] if stops else [6 * around, 6 * around])


def test_layers_on_one_part_of_a_wall_end_at_a_corner_of_planes() -> None:
    """The floor of a box: layers slide in all four sides, and along their common edges."""
    lattice = Domain.box((0, 0, 0), (1, 1, 1))
    n = 4
    x, y = (a.ravel() / (n - 1) for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = at[:-1, :-1].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel(), at[:-1, 1:].ravel()
    floor = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    top = n * n + np.arange(4)
    points = np.concatenate([np.column_stack([x, y, 0 * x]), [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]])
    rims = [at[:, 0], at[-1, :], at[::-1, -1], at[0, ::-1]]
    sides = [[*rim.tolist(), top[(k + 1) % 4], top[k]] for k, rim in enumerate(rims)]
    domain = Domain(points, [*floor.tolist(), *sides, top.tolist()], markers={"sides": range(18, 22)})
    assert domain.volume == lattice.volume
    walls = walls_of(domain, np.arange(18), turn=False)
    for level in (None, slope(walls, walls.points[:, 0])):
        grown = grown_on(walls, np.tile([0.0, 0.0, 1.0], (16, 1)), level)
        mesh, lacking = filled_beyond(domain, grown, as_size(0.4), OPTIONS)
        assert lacking == "" and check(mesh, domain=domain)


def test_layers_that_leave_the_body_or_meet_inner_pieces_are_refused() -> None:
    domain, walls, direction = ball_in_box()
    for far, text in ((15.0, "meet pieces that are no walls"), (100.0, "surround")):
        with pytest.raises(InputError, match=text):
            filled_beyond(domain, grown_on(walls, far * direction), as_size(1.0), OPTIONS)
    first, second = np.asarray(domain.facets[6])[:2].tolist()
    crack = Domain(domain.points, domain.facets, inner=[[first, 0]], markers=domain.markers)
    with pytest.raises(InputError, match=f"inner piece ends at vertex {min(first, second)}"):
        filled_beyond(crack, grown_on(walls, direction), as_size(1.0), OPTIONS)
