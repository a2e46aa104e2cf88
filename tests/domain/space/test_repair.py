"""`resolve=True` in space: what is mended, what is refused, and what the account says."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from surface_mutations import examine, inside, overlapping

from unstruct import Domain, DomainError, InputError, UnstructError

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
NUDGE = 2.0**-52


def cubes(*offsets: tuple[float, ...]) -> tuple[np.ndarray, list[list[int]]]:
    points = np.concatenate([CORNERS + offset for offset in offsets])
    return points, [[8 * i + v for v in side] for i in range(len(offsets)) for side in SIDES]


def mended(points: object, facets: object, **options: object) -> Domain:
    """The repaired domain, which must stand by itself."""
    with pytest.raises(UnstructError):
        Domain(points, facets, **options)
    domain = Domain(points, facets, resolve=True, **options)
    again = Domain(domain.points, domain.facets, inner=domain.inner)
    assert again.volume == domain.volume and len(again.turned) == 0
    return domain


def kinds(domain: Domain) -> set[str]:
    return {repair.kind for repair in domain.repairs}


def test_nothing_is_done_where_all_is_well() -> None:
    domain = Domain(CORNERS, SIDES, resolve=True)
    assert domain.repairs == [] and domain.piece_origin.tolist() == list(range(6))
    assert [*map(tuple, domain.facets)] == SIDES


@pytest.mark.parametrize("seed", [*range(200), 1668, 2037])  # two with a polygon that has two sides inside
def test_mutations(seed: int) -> None:
    examine(seed)


@pytest.mark.parametrize("seed", range(60))
def test_bodies_wherever_they_lie(seed: int) -> None:
    """They are refused for a crossing, or what an odd number of them covers is inside."""
    points, rows = overlapping(seed)
    if len(rows) == 0:
        return
    try:
        domain = Domain(points, rows, resolve=True)
    except DomainError as error:
        assert "unite the bodies first" in str(error)
        return
    except InputError as error:  # bodies that are equal
        assert "no facet is left" in str(error)
        return
    again = Domain(domain.points, domain.facets, inner=domain.inner)
    assert again.volume == domain.volume and len(again.turned) == len(domain.inner) == 0
    x = np.random.default_rng(seed).uniform(points.min(axis=0), points.max(axis=0), (100, 3))
    wanted, sure = inside((points, rows), x)
    assert (domain.contains(x) == wanted)[sure].all()


def test_copies_of_points() -> None:
    points = CORNERS[np.concatenate(SIDES)]
    points[3] = -points[3] * 0.0 + points[3]  # -0.0 equals 0.0
    domain = mended(points, np.arange(24).reshape(6, 4))
    assert domain.volume == 1.0 and len(domain.points) == 8 and len(domain.repairs) == 1
    assert (np.diff(domain.origin) > 0).all()
    assert "16 points equal others (point 8, for example, point 0)" in domain.repairs[0].text
    assert domain.repairs[0].vertices == tuple(range(24))
    few = mended(np.vstack([CORNERS, CORNERS[:2]]), [*SIDES[:-1], [9, 5, 7, 3]])
    assert [repair.vertices for repair in few.repairs if repair.kind == "duplicate points"] == [
        (0, 8),
        (1, 9),
    ]


def test_rings() -> None:
    """Vertices that follow themselves, spikes, rings that touch themselves, indices that do not exist."""
    for row in (
        (0, 1, 1, 3, 2),
        (0, 1, 3, 1, 3, 2),
        (0, 1, 3, 2, 0),
        (2, 0, 1, 3, 2, 6, 2),
        (3, 2, 0, 1, 0, 1),
    ):
        domain = mended(CORNERS, [row, *SIDES[1:]])
        assert domain.volume == 1.0 and kinds(domain) == {"repeated vertex"}, row
    points = np.vstack([CORNERS, [0, 0.25, 0.5], [0, 0.75, 0.5]])
    touching = [0, 1, 3, 2, 9, 8, 2]  # the side with a hole that touches its corner, and what fills the hole
    domain = mended(points, [touching, (2, 9, 8), *SIDES[1:]])
    assert domain.volume == 1.0 and "repeated vertex" in kinds(domain)
    domain = mended(CORNERS, [*SIDES, (0, 1, 8), (0, 0, 0)])
    assert domain.volume == 1.0 and kinds(domain) == {"index out of range", "zero area"}


def test_equal_facets() -> None:
    """An even number cancels, unless the surface is closed only with one of them."""
    doubled = mended(CORNERS, [*SIDES, SIDES[2][::-1]], markers={"a": [2], "b": [6]})
    assert doubled.volume == 1.0 and len(doubled.facets) == 6
    assert doubled.markers["a"].tolist() == doubled.markers["b"].tolist() == [2]
    neighbors = mended(CORNERS, [*SIDES, SIDES[2], SIDES[4], SIDES[4]])
    assert neighbors.volume == 1.0
    united = mended(*cubes((0, 0, 0), (0, 1, 0)))
    assert united.volume == 2.0 and len(united.facets) == 10 and len(united.points) == 12
    with pytest.raises(InputError, match="no facet is left"):
        Domain(CORNERS, [*SIDES, *SIDES], resolve=True)
    inner = mended(CORNERS, SIDES, inner=[SIDES[0], (0, 1, 7, 6), (6, 7, 1, 0)])
    assert len(inner.inner) == 1 and inner.volume == 1.0


def test_vertices_on_facets() -> None:
    points = np.vstack([CORNERS, [0, 0, 0.5], [0.5, 0.5, 0], [0, 0.25, 0.25]])
    domain = mended(points, SIDES, markers={"low": [4], "side": [0]})
    assert domain.volume == 1.0 and kinds(domain) == {"vertex on a facet"}
    assert set(domain.piece_origin[domain.markers["low"]].tolist()) == {4}
    assert set(domain.piece_origin[domain.markers["side"]].tolist()) == {0}
    assert len(domain.loose) == 0 and domain.origin.tolist() == list(range(11))
    straight = mended(np.vstack([CORNERS, [0, 0, 0.5]]), [(0, 8, 1, 3, 2), *SIDES[1:]])
    assert [len(row) for row in straight.facets] == [5, 4, 5, 4, 4, 4]  # polygons stay polygons


def test_vertices_near_open_edges() -> None:
    """The middle of a slanting edge is on it only up to rounding."""
    points = np.array([[0.1, 0.2, 0.3], [1.3, 0.7, 0.1], [0.2, 1.9, 0.4], [0.6, 0.5, 1.7]])
    rows = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    middle = points[0] / 3 + points[1] / 1.5
    split = [[0, 2, 4], [4, 2, 1], *rows[1:]]
    domain = mended(np.vstack([points, middle]), split)
    assert "vertex near an edge" in kinds(domain) and len(domain.facets) == 6
    assert abs(domain.volume - Domain(points, rows).volume) < 1e-15


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("shift", [(0.5, 0.5), (0.25, 0.0), (0.0, 0.5), (1.0, 1.0), (0.125, -0.75)])
def test_bodies_that_touch_in_a_plane(axis: int, shift: tuple[float, float]) -> None:
    """One upon the other: sides cross where there are doubles, and what both cover goes."""
    points, facets = cubes((0, 0, 0), (0, 0, 0))
    offset = np.roll((1.0, *shift), axis)
    points[8:] += offset
    names = {"lower": range(6), "upper": range(6, 12)}
    domain = mended(points, facets, markers=names)
    assert domain.volume == 2.0
    for name, body in (("lower", 0), ("upper", 1)):
        own = domain.piece_origin[domain.markers[name]]
        assert ((own >= 6) == body).all() and len({*own.tolist()}) >= 5
    x = np.random.default_rng(0).uniform(-1, 2, (200, 3))
    inside = [((x > low) & (x < low + 1)).all(axis=1) for low in (np.zeros(3), offset)]
    assert (domain.contains(x) == inside[0] | inside[1]).all()


def test_small_face_on_a_large_one_turned() -> None:
    """A tower whose foot is turned: no new vertex is needed, though diagonals cross."""
    points, facets = cubes((0, 0, 0), (0, 0, 0))
    turn = np.array([[0.6, 0.8], [-0.8, 0.6]])
    points[8:, :2] = (points[8:, :2] - 0.5) @ turn * 0.5 + 0.5
    points[8:, 2] += 1
    domain = mended(points, facets)
    assert abs(domain.volume - 1.25) < 1e-15 and len(domain.points) == 16
    points[8:, :2] = (points[8:, :2] - 0.5) * 2.3 + 0.5
    with pytest.raises(DomainError, match="unite the bodies first"):
        Domain(points, facets, resolve=True)


def test_overlapping_boxes() -> None:
    """Where all crossings are doubles, even volumes in common are found: they are outside, by the rule."""
    domain = mended(*cubes((0, 0, 0), (0.5, 0.5, 0.5)))
    assert domain.volume == 2 * (1 - 0.125) and "crossing" in kinds(domain)
    domain = mended(*cubes((0, 0, 0), (0.5, 0, 0)))
    assert domain.volume == 1.0 and "overlap" in kinds(domain)


def test_crossing_facets_are_refused() -> None:
    points, facets = cubes((0, 0, 0), (0.3, 0.4, 0.6))
    points[8:] *= 0.7
    with pytest.raises(DomainError, match=r"crosses facet .*unite the bodies first") as caught:
        Domain(points, facets, resolve=True)
    assert all(0 <= i < 12 for fault in caught.value.faults for i in fault.pieces)
    assert all(len(fault.place) == 3 for fault in caught.value.faults)


def test_open_surfaces() -> None:
    """Flat sheets become inner; what could have been a body is refused, with the loop that is open."""
    with pytest.raises(DomainError, match=r"a loop of 4 such edges; close it \(2 triangles would do\)"):
        Domain(CORNERS, SIDES[:-1], resolve=True)
    fin = mended(np.vstack([CORNERS, [2, 2, 2]]), [*SIDES, (1, 3, 8)], markers={"fin": [6]})
    assert fin.volume == 1.0 and fin.name(6) == "inner facet 0" and fin.markers["fin"].tolist() == [6]
    wall = mended(CORNERS, [(0, 1, 7, 6), *SIDES], regions={"a": (0.9, 0.1, 0.5), "b": (0.1, 0.9, 0.5)})
    assert wall.volume == 1.0 and wall.piece_origin.tolist() == [1, 2, 3, 4, 5, 6, 0]
    with pytest.raises(DomainError, match="open"):
        Domain(CORNERS, [SIDES[0]], resolve=True)
    two = [[8 + v for v in side] for side in SIDES[1:]]  # a closed box, and an open one beside
    with pytest.raises(DomainError, match="open"):
        Domain(np.concatenate([CORNERS, CORNERS + 3]), [*SIDES, *two], resolve=True)


def test_directions() -> None:
    """They do not matter for what is inside; `turned` names them, and resolve=True turns them."""
    one_way = [SIDES[0], *[row[::-1] for row in SIDES[1:]]]
    given, domain = Domain(CORNERS, one_way), Domain(CORNERS, one_way, resolve=True)
    assert given.turned.tolist() == [1, 2, 3, 4, 5] and given.volume == domain.volume == 1.0
    assert domain.turned.tolist() == [] and kinds(domain) == {"turned facets"}
    assert "5 facets of a shell" in domain.repairs[0].text and domain.repairs[0].pieces == (1, 2, 3, 4, 5)
    nested = np.concatenate([CORNERS * 4 - 2, CORNERS * 2 - 1])
    rows = [*SIDES, *[[8 + v for v in row] for row in SIDES]]
    assert Domain(nested, rows).turned.tolist() == [6, 7, 8, 9, 10, 11]
    with pytest.raises(InputError, match="planar"):
        _ = Domain.rectangle().turned


def test_polygons_that_are_not_flat() -> None:
    points = CORNERS.copy()
    points[0] = [-0.2, -0.1, -0.3]
    domain = mended(points, SIDES)
    assert kinds(domain) == {"not flat"} and len(domain.facets) == 9
    with pytest.raises(DomainError, match="crosses or touches itself"):
        Domain(CORNERS, [(0, 1, 2, 3), *SIDES[1:]], resolve=True)


def test_inner_pieces() -> None:
    """Segments are split at vertices; sides of inner facets in a facet's plane are edges of it."""
    points = np.vstack([CORNERS, [0.5, 0.5, 0.5], [0.25, 0.5, 0], [0.75, 0.5, 0]])
    domain = mended(points, SIDES, inner=[(0, 7), (9, 10)], markers={"axis": [6]})
    assert [row.tolist() for row in domain.inner] == [[0, 8], [8, 7], [9, 10]]
    assert domain.markers["axis"].tolist() == np.flatnonzero(domain.piece_origin == 6).tolist()
    wall = np.vstack([CORNERS, [0.25, 0.5, 0], [0.75, 0.5, 0], [0.5, 0.5, 0.5]])
    domain = mended(wall, SIDES, inner=[(8, 9, 10)])
    assert "edge in a facet" in kinds(domain) and len(domain.inner) == 1 and domain.volume == 1.0


def test_vertices_whose_pieces_are_gone() -> None:
    points = np.vstack([CORNERS, [0, 0, 0.5], [5, 5, 5]])
    domain = mended(points, [*SIDES, (0, 8, 0), (0, 1, 12)])
    assert len(domain.loose) == 1  # which was loose before
    assert domain.origin.tolist() == [0, 1, 2, 3, 4, 5, 6, 7, 9]


def test_degenerate_coordinates() -> None:
    """A plate of one last bit; coordinates far away and very small."""
    for scale, move in ((NUDGE, 1.0), (1e-90, 0.0), (1e90, 0.0)):
        points = CORNERS * scale + move
        domain = mended(points, [*SIDES, SIDES[3]])
        assert len(domain.facets) == 6 and domain.volume > 0
