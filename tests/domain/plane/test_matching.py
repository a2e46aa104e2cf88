"""Matching sides: points equal bit for bit up to the translation or rotation, and the pairs."""

import numpy as np
import pytest
from regions import sector

import unstruct
from unstruct import Arc, Domain, InputError, Spacing, check

METHODS = [
    unstruct.refine,
    unstruct.voronoi_segment,
    unstruct.advancing_front,
    unstruct.circumcenter_insertion,
    unstruct.conforming_delaunay,
]
SQUARE = Domain.rectangle()
INCOMPLETE = pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")


def uneven(x):
    return 0.05 + 0.15 * np.clip(x[:, 0] * (1 - x[:, 1]), 0, 1)


def is_periodic(mesh, domain):
    """Whether the pairs are those of all vertices on matched pieces, exact for the translation of each."""
    expected = set()
    for match in domain.matches:
        one, two = (np.unique(mesh.segments[mesh.piece == k]) for k in match[:2])
        image = {tuple(x): v for v, x in zip(two.tolist(), mesh.points[two].tolist())}
        moved = match.motion(mesh.points[one])
        expected |= {(v, image[tuple(x)]) for v, x in zip(one.tolist(), moved.tolist())}
    return sorted(expected) == [tuple(row) for row in mesh.pairs.tolist()]


@pytest.mark.parametrize("method", METHODS)
def test_a_doubly_periodic_square(method):
    domain = SQUARE.matched("left", "right").matched("bottom", "top")
    mesh = method(domain, uneven)
    assert mesh.complete and check(mesh, domain=domain) and check(mesh, domain=SQUARE)
    assert is_periodic(mesh, domain) and len(mesh.pairs) > 20
    assert (
        np.bincount(mesh.piece)[3] == np.bincount(SQUARE.sampled(uneven).piece).max()
        or method is unstruct.circumcenter_insertion
    )


def wave(bend=0.2):
    """A channel with bent ends, the right end drawn from top to bottom."""
    left, right = Arc.through((0, 0), (bend, 0.5), (0, 1)), Arc.through((0.3, 1), (0.3 + bend, 0.5), (0.3, 0))
    points = [(0, 0), (0, 1), (0.1 + 0.2, 1), (0.1 + 0.2, 0)]
    ends = {0: left, 2: right}
    return Domain(points, [(0, 1), (1, 2), (2, 3), (3, 0)], curves=ends, markers={"in": [0], "out": [2]})


@INCOMPLETE
@pytest.mark.parametrize("method", METHODS)
def test_curved_sides(method):
    domain = wave().matched("in", "out")
    mesh = method(domain, lambda x: 0.03 + 0.1 * np.abs(x[:, 0]))
    assert check(mesh, domain=domain) and is_periodic(mesh, domain) and len(mesh.pairs) > 20


def test_vertices_are_moved_to_match_and_this_is_told():
    rough = Domain([(0, 0.1), (0.1 + 0.2, 0.1), (0.3, 0.7), (0, 0.7)], [(0, 1), (1, 2), (2, 3), (3, 0)])
    domain = rough.matched(3, 1)
    assert [repair.kind for repair in domain.repairs] == ["moved to match"]
    assert domain.repairs[0].vertices == (2,) and "by up to 5.55e-17" in str(domain.repairs[0])
    assert is_periodic(unstruct.refine(domain, 0.05), domain)
    wide = Domain([(0, 0), (1, 0), (1.001, 1), (0, 1)], [(0, 1), (1, 2), (2, 3), (3, 0)])
    with pytest.raises(InputError, match=r"more than the tolerance .*equal up to a translation"):
        wide.matched(3, 1)
    near = wide.matched([3], [1], tolerance=0.01, shift=(1.0, 0.0))
    assert near.points[2].tolist() == [1.0, 1.0] and check(unstruct.refine(near, 0.2), domain=near)


def test_chains_of_pieces_regions_and_a_spacing():
    points = [(0, 0), (2, 0), (2, 0.3), (2, 1), (0, 1), (0, 0.3)]
    domain = Domain(
        points,
        [(k, (k + 1) % 6) for k in range(6)],
        inner=[(2, 5)],
        regions={"low": [(1, 0.1)]},
        markers={"left": [4, 5], "right": [1, 2]},
    ).matched("left", "right")
    graded = domain.spaced({5: Spacing(first=0.01, last=0.1)})
    mesh = unstruct.voronoi_segment(graded, {"low": 0.05, None: 0.2})
    assert check(mesh, domain=graded) and is_periodic(mesh, graded)
    assert (mesh.piece == 1).sum() == (mesh.piece == 5).sum() == len(graded.spacings[5]) - 1
    again = unstruct.refine(graded.sampled(0.2), 0.1)
    assert check(again) and len(again.pairs) == len(mesh.pairs) + 4  # the upper pieces of .175 are halved
    with pytest.raises(InputError, match="different spacings"):
        graded.spaced({1: 3})


@INCOMPLETE
def test_sides_that_are_not_split_are_the_reason():
    domain = SQUARE.matched("left", "right")
    mesh = unstruct.refine(domain, min_angle=30, max_area=1e-3)
    assert not mesh.complete and check(mesh, domain=domain)
    assert {reason.split(":")[0] for reason in mesh.reasons} == {"kept"}
    assert mesh.pairs.tolist() == [[0, 1], [3, 2]]
    assert len(unstruct.refine(SQUARE, 0.3).pairs) == 0


def test_errors():
    with pytest.raises(InputError, match="matched twice"):
        SQUARE.matched("left", "right").matched("right", "top")
    with pytest.raises(InputError, match="matched twice"):
        SQUARE.matched("left", "left")
    with pytest.raises(InputError, match="equal up to a translation"):
        SQUARE.matched("left", "top")
    with pytest.raises(InputError, match="2 pieces and 4 vertices"):
        SQUARE.matched([0, 2], [1])
    with pytest.raises(InputError, match="first names marker 'west'"):
        SQUARE.matched("west", "right")
    with pytest.raises(InputError, match="shift must be two finite numbers"):
        SQUARE.matched("left", "right", shift=1)
    with pytest.raises(InputError, match="facet 0 has no image between points 3 and 2"):
        bent = wave()
        Domain(bent.points, bent.facets, curves={0: bent.curves[0]}).matched(0, 2)
    with pytest.raises(InputError, match="cannot be simplified"):
        SQUARE.matched("left", "right").simplified(0.1)


# ---------------------------------------------------------------------- rotations


@INCOMPLETE
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("parts", "center", "bend"), [(7, (0, 0), 0), (4, (3.3, -2.1), 0), (5, (0, 0), 0.2)])
def test_sectors(method, parts, center, bend):
    plain = sector(parts, center, bend=bend)
    domain = plain.matched("low", "high", rotation=360 / parts, center=center)
    mesh = method(domain, lambda x: 0.03 + 0.1 * np.abs(x[:, 1] - center[1]))
    assert check(mesh, domain=domain) and is_periodic(mesh, domain) and len(mesh.pairs) > 8
    ((motion, pairs),) = mesh.periodic
    assert np.array_equal(motion(mesh.points[pairs[:, 0]]), mesh.points[pairs[:, 1]])
    away = [np.hypot(*(mesh.points[column] - center).T) for column in pairs.T]
    assert np.abs(away[0] - away[1]).max() < 2.0**-48


@pytest.mark.parametrize("center", [(0.0, 0.0), (0.1, 1 / 3)])
def test_sides_that_share_the_center(center):
    ends = np.add(center, [(0, 0), (1, 0), (0, 1)])
    domain = Domain(ends, [(0, 1), (1, 2), (2, 0)]).matched(0, 2, rotation=90, center=center)
    mesh = unstruct.refine(domain, 0.1)
    assert check(mesh, domain=domain) and len(mesh.pairs) == 10  # the center is no pair
    assert np.array_equal(
        domain.matches[0].motion(mesh.points[mesh.pairs[:, 0]]), mesh.points[mesh.pairs[:, 1]]
    )


def test_errors_of_rotations():
    domain = sector(7)
    with pytest.raises(InputError, match=r"turned by 50° about \(0, 0\), is .* equal up to a rotation"):
        domain.matched("low", "high", rotation=50)
    with pytest.raises(InputError, match="moves nothing"):
        domain.matched("low", "high", rotation=360)
    with pytest.raises(InputError, match="a shift or a rotation, not both"):
        domain.matched("low", "high", rotation=360 / 7, shift=(1, 0))
    with pytest.raises(InputError, match="center must be two finite numbers"):
        domain.matched("low", "high", rotation=360 / 7, center=(0, np.nan))
    with pytest.raises(InputError, match="facet 0 has no image between points 3 and 2"):
        bent = sector(7, bend=0.2)
        Domain(bent.points, bent.facets, curves={0: bent.curves[0]}).matched(0, 2, rotation=360 / 7)
