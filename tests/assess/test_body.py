"""`check` of tetrahedra with their body: good meshes pass, each kind of damage is named."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from random_bodies import boolean

from unstruct import (
    Domain,
    DomainMesh,
    Mesh,
    advancing_front,
    check,
    constrained_delaunay,
    delaunay,
    tetrahedralize,
)

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
EXTRA = [(0.5, 0.5, 0.0), (0.25, 0.5, 0.0), (0.5, 0.5, 0.5), (1.0, 0.5, 0.0)]


def box(**options: object) -> Domain:
    return Domain(
        CORNERS, SIDES, markers={"low": [0], "x": [1, 2]}, regions={"a": (0.5, 0.25, 0.5)}, **options
    )


def meshed(domain: Domain, extra: list | None = None, **changes: object) -> DomainMesh:
    """The Delaunay mesh of a convex body, with further points, as a mesh of the domain."""
    points = np.vstack([domain.points, *([extra] if extra else [])])
    mesh = delaunay(points)
    border = np.asarray(mesh.boundary)
    piece = np.array([_piece(domain, points[row].mean(axis=0)) for row in border])
    markers = {name: border[np.isin(piece, rows)] for name, rows in domain.markers.items()}
    known = np.arange(len(domain.points))
    arguments: dict = {
        "origin": np.concatenate([known, np.full(len(points) - len(known), -1)]),
        "faces": border,
        "face_piece": piece,
        "markers": {"facets": border, "region": np.zeros(mesh.size, dtype=int), **markers},
        "regions": {"a": 0},
    }
    return DomainMesh(points, mesh.simplices, **{**arguments, **changes})


def _piece(domain: Domain, x: np.ndarray) -> int:
    shell = domain.triangulated
    a, b, c = (domain.points[shell.triangles[:, k]] for k in range(3))
    return int(shell.piece[np.abs(np.einsum("ij,ij->i", np.cross(b - a, c - a), x - a)).argmin()])


def test_good_meshes() -> None:
    report = check(meshed(box()), domain=box(), delaunay=True)
    assert report, report
    mesh = meshed(box(), EXTRA)
    assert check(mesh, domain=box()), check(mesh, domain=box())
    assert mesh.steiner.tolist() == [8, 9, 11]


def kinds(mesh: DomainMesh, domain: Domain) -> set[str]:
    return {problem.kind for problem in check(mesh, domain=domain).problems}


def test_each_damage_is_named() -> None:
    good = meshed(box(), EXTRA)
    rolled = meshed(box(), EXTRA, face_piece=np.roll(good.face_piece, 1))
    assert {"facet", "side", "marker"} <= kinds(rolled, box())
    assert "piece" in kinds(meshed(box(), face_piece=good.face_piece[:12] + 9), box())
    few = meshed(box(), faces=np.asarray(meshed(box()).faces)[1:], face_piece=meshed(box()).face_piece[1:])
    assert "boundary" in kinds(few, box())
    assert "origin" in kinds(meshed(box(), EXTRA, origin=[*range(8), 0, -1, -1, -1]), box())
    plain = meshed(box())
    assert "marker" in kinds(meshed(box(), markers={"region": np.zeros(plain.size, dtype=int)}), box())
    other = {**plain.markers, "region": np.ones(plain.size, dtype=int)}
    assert "region" in kinds(meshed(box(), markers=other), box())


def test_new_vertices_lie_on_their_facets() -> None:
    lifted = [(0.5, 0.5, -1e-9), *EXTRA[1:]]
    assert "off the facet" in kinds(meshed(box(), lifted), box())
    nearly = [(0.5, 0.5, -(2.0**-52)), *EXTRA[1:]]
    assert "off the facet" not in kinds(meshed(box(), nearly), box())


NEEDLE = 2.5e-4  # the height of the thinnest triangles of boolean(21), by the extent; 5e-4 for boolean(25)


def in_needles(height: float) -> Domain:
    """A turned box, one side of which is cut into triangles, one with a small height on a long edge."""
    turn = np.linalg.qr(np.random.default_rng(21).normal(size=(3, 3)))[0]
    points = np.vstack([CORNERS, [[0.4, height, 0.0]]])
    return Domain(points @ turn.T / 2, [(8, 0, 2), (8, 2, 6), (8, 6, 4), (8, 4, 0), *SIDES[:4], SIDES[5]])


@pytest.mark.parametrize("height", [NEEDLE, 1e-6])
def test_vertices_on_needles_are_measured_without_loss(height: float) -> None:
    """As in boolean(21) and boolean(25): the rounded normal of a needle misses points on its long edges."""
    body = in_needles(height)
    for mesh in (
        tetrahedralize(body, 0.25, split_boundary=True),
        advancing_front(body, 0.25, split_boundary=True),
    ):
        assert ((np.asarray(mesh.origin)[mesh.faces] < 0).any(axis=1) & (mesh.face_piece == 3)).any()
        assert check(mesh, domain=body)
        moved = mesh.points.copy()
        edge = body.points[[0, 4]]
        along = (moved - edge[0]) @ (edge[1] - edge[0]) / ((edge[1] - edge[0]) ** 2).sum()
        beside = np.abs(moved - edge[0] - along[:, None] * (edge[1] - edge[0])).max(axis=1) < 1e-12
        new = np.flatnonzero(beside & (np.asarray(mesh.origin) < 0))
        moved[new[0]] += 1e-13 * (body.points[0] - body.points[1])
        mesh.points = moved
        off = [p.vertices for p in check(mesh, domain=body).problems if p.kind == "off the facet"]
        assert off == [(new[0],)]


@pytest.mark.parametrize("seed", [21, 25])
def test_booleans_with_needles(seed: int) -> None:
    pytest.importorskip("manifold3d")
    body = Domain(*boolean(seed))
    size = float(np.ptp(body.points, axis=0).max()) / 3
    assert check(tetrahedralize(body, size, split_boundary=True), domain=body)


def test_a_smaller_body_is_not_this_one() -> None:
    domain = Domain(CORNERS * [1, 1, 2], SIDES)
    mesh = meshed(box())
    assert "moved" in kinds(mesh, domain)


def test_loose_vertices_and_segments() -> None:
    points = np.vstack([CORNERS, [[0.5, 0.5, 0.5]]])
    domain = Domain(points, SIDES)
    assert check(meshed(domain), domain=domain)
    less = meshed(box(), [(0.5, 0.5, 0.5)])
    assert "missing vertex" in kinds(less, domain)
    linked = Domain(points, SIDES, inner=[(0, 8), (8, 7)])
    whole = meshed(linked, segments=[(0, 8), (8, 7)], piece=[6, 7], span=[(0, 1), (0, 1)])
    assert check(whole, domain=linked), check(whole, domain=linked)
    half = meshed(linked, segments=[(0, 8)], piece=[6], span=[(0, 1)])
    assert "segment" in kinds(half, linked)


def test_bodies_that_touch_along_an_edge_or_in_a_vertex() -> None:
    for offset in ([1, 1, 0], [1, 1, 1]):
        second = CORNERS + offset
        points, number = np.unique(np.vstack([CORNERS, second]), axis=0, return_inverse=True)
        number, first = number.ravel()[8:], number.ravel()[:8]
        domain = Domain(points, [row[list(side)].tolist() for row in (first, number) for side in SIDES])
        one = meshed(Domain(CORNERS, SIDES))
        cells = np.vstack([first[one.simplices], number[one.simplices]])
        faces = np.vstack([first[one.faces], number[one.faces]])
        both = DomainMesh(
            points, cells, origin=np.arange(len(points)), faces=faces,
            face_piece=np.concatenate([one.face_piece, one.face_piece + 6]),
            markers={"facets": faces, "region": np.repeat([0, 1], one.size)},
        )  # fmt: skip
        assert domain.volume == 2.0
        report = check(both, domain=domain)
        assert report, report


@pytest.mark.parametrize("numbers", [[0, 1], [1, 0]])
def test_regions_between_inner_facets(numbers: list[int]) -> None:
    points = np.vstack([CORNERS * [1, 1, 2], [(x, y, 1.0) for x in (0, 1) for y in (0, 1)]])
    domain = Domain(
        points,
        [
            (0, 8, 1, 3, 9, 2),
            (4, 6, 11, 7, 5, 10),
            (0, 4, 10, 5, 1, 8),
            (2, 9, 3, 7, 11, 6),
            (0, 2, 6, 4),
            (1, 5, 7, 3),
        ],
        inner=[(8, 9, 11, 10)],
        regions={"low": (0.5, 0.25, 0.5), "high": (0.5, 0.25, 1.5)},
    )
    assert domain.volume == 2.0
    mesh = delaunay(points)
    rows = np.sort(mesh.simplices[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]].reshape(-1, 3), axis=1)
    wall = np.unique(rows[(points[rows][:, :, 2] == 1.0).all(axis=1)], axis=0)
    border = np.asarray(mesh.boundary)
    high = (points[mesh.simplices][:, :, 2].mean(axis=1) > 1.0).astype(int)
    piece = [_piece(Domain(points, domain.facets), points[row].mean(axis=0)) for row in border]
    made = DomainMesh(
        points, mesh.simplices, origin=np.arange(12), faces=np.vstack([border, wall]),
        face_piece=[*piece, *[6] * len(wall)], markers={"facets": border, "region": np.array(numbers)[high]},
        regions={"low": 0, "high": 1},
    )  # fmt: skip
    report = check(made, domain=domain)
    assert bool(report) is (numbers == [0, 1]), report


def test_inner_pieces_outside_of_the_body_need_no_faces() -> None:
    """As in the plane, where the check never asked for them; one inside that is missing is still named."""
    extra = [(2.0, 2.0, 2.0), (3.0, 2.0, 2.0), (2.0, 3.0, 2.0), (0.25, 0.25, 0.5), (0.25, 0.75, 0.5)]
    points = np.vstack([CORNERS, extra])
    for inner in ([[8, 9, 10]], [[8, 9]]):
        domain = Domain(points, SIDES, inner=inner)
        mesh = constrained_delaunay(domain)
        assert check(mesh, domain=domain)
        lying = Domain(points, SIDES, inner=[[0, 11, 12][: len(inner[0])]])
        assert "6" in str(check(mesh, domain=lying)) and not check(mesh, domain=lying)


# ---------------------------------------------------------------------- what rounding may change, and no more


def two_cubes() -> Domain:
    """Two cubes that touch along an edge, as triangles."""
    rows = np.array([t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))])
    points = np.vstack([CORNERS, CORNERS + np.array([1, 1, 0])])
    points, number = np.unique(points, axis=0, return_inverse=True)
    return Domain(points, number.ravel()[np.vstack([rows, rows + 8])])


def changed(mesh: DomainMesh, **changes: object) -> DomainMesh:
    same = ("origin", "faces", "face_piece", "markers", "segments", "piece", "span")
    arguments = {name: getattr(mesh, name) for name in same} | {
        "points": mesh.points,
        "simplices": mesh.simplices,
    }
    arguments |= changes
    return DomainMesh(arguments.pop("points"), arguments.pop("simplices"), **arguments)


def test_the_common_edge_of_two_cubes_may_be_divided() -> None:
    domain = two_cubes()
    mesh = tetrahedralize(domain, 0.5, split_boundary=True)
    on_edge = (mesh.points[:, :2] == 1).all(axis=1) & (np.asarray(mesh.origin) < 0)
    assert on_edge.any()
    report = check(mesh, domain=domain)
    assert report, report
    assert check(Mesh(mesh.points, mesh.simplices), domain=domain)  # as from a file
    # the same cells are pinched where a body does not say so
    assert {"pinched edge", "pinched vertex"} <= {p.kind for p in check(mesh).problems}
    moved = np.array(mesh.points)
    moved[np.flatnonzero(on_edge)[0], 0] += 1e-12
    assert not check(changed(mesh, points=moved), domain=domain)
    one = np.ones(mesh.size, dtype=bool)
    one[np.flatnonzero((mesh.simplices == np.flatnonzero(on_edge)[0]).any(axis=1))[0]] = False
    assert not check(Mesh(mesh.points, mesh.simplices[one]), domain=domain)


def test_a_small_cube_far_away() -> None:
    """Its side has 7e6 units of rounding of its coordinates, so areas are right to some 1e-6 only."""
    domain = Domain.box((1e6,) * 3, (1e6 + 1e-3,) * 3)
    mesh = tetrahedralize(domain, 3e-4)
    report = check(mesh, domain=domain)
    assert report, report
    corner = int(np.flatnonzero(np.asarray(mesh.origin) == 0)[0])
    cut = changed(mesh, origin=np.where(np.asarray(mesh.origin) == 0, -1, mesh.origin))
    assert check(cut, domain=domain)  # a corner that is where it should be, whatever its origin says
    for step in (1e-7, -1e-7):
        points = np.array(mesh.points)
        points[corner] += step
        assert not check(changed(cut, points=points), domain=domain)
    bounding = np.asarray(mesh.face_piece) < len(domain.facets)
    for drop in (0, len(mesh.faces) // 2):
        some = np.flatnonzero(np.arange(len(mesh.faces)) != drop)
        assert bounding[drop]
        less = changed(mesh, faces=mesh.faces[some], face_piece=mesh.face_piece[some])
        assert not check(less, domain=domain)
    assert not check(Mesh(mesh.points, mesh.simplices[1:]), domain=domain)


def test_a_thin_shell() -> None:
    """Its volume is a small difference; what the cells fill is known to the rounding of their edges."""
    inner = Domain.ball(radius=1 - 1e-9, size=0.4)
    domain = Domain.ball(size=0.4).with_holes(inner)
    mesh = tetrahedralize(domain, optimize=False)
    report = check(mesh, domain=domain)
    assert report, report
    assert not check(Mesh(mesh.points, mesh.simplices[1:]), domain=domain)
    other = Domain.ball(size=0.4).with_holes(Domain.ball(radius=1 - 1.0001e-9, size=0.4))
    assert not check(mesh, domain=other)
    full = tetrahedralize(Domain.ball(size=0.4), optimize=False)
    assert not check(Mesh(full.points, full.simplices), domain=domain)


def test_a_piece_without_faces_is_missing_however_small() -> None:
    """A chip of the corner of a cube, 1e-7 wide, is no rounding."""
    points = np.vstack([CORNERS[:7], [(1 - 1e-7, 1, 1), (1, 1 - 1e-7, 1), (1, 1, 1 - 1e-7)]])
    chipped = Domain(
        points,
        [
            (0, 1, 3, 2), (4, 6, 9, 8, 5), (0, 4, 5, 1), (2, 3, 7, 9, 6), (0, 2, 6, 4), (1, 5, 8, 7, 3),
            (7, 8, 9),
        ],
    )  # fmt: skip
    mesh = tetrahedralize(chipped, 0.5)
    assert check(mesh, domain=chipped), check(mesh, domain=chipped)
    whole = Domain(CORNERS, SIDES)
    assert not check(mesh, domain=whole)
    assert not check(Mesh(mesh.points, mesh.simplices), domain=whole)
    assert not check(tetrahedralize(whole, 0.5), domain=chipped)
