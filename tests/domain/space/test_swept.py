"""Extrusion and revolution of planar domains: volumes, names, regions, inner pieces; hostile domains."""

from __future__ import annotations

from math import pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import KINDS, random_region

from unstruct import Domain, IncompleteWarning, InputError, check, simplex, tetrahedralize
from unstruct.geometry.parity import left_parity
from unstruct.predicates import orient

FRAME = Domain.polygon(
    [(0, 0), (4, 0), (4, 4), (0, 4)],
    [[(1, 1), (2, 1), (2, 2), (1, 2)]],
    markers={"wall": [0, 1], "hole": [4, 5, 6, 7]},
    regions={"steel": (0.5, 0.5)},
)
HALVES = Domain(
    [(0, 0), (4, 0), (4, 4), (0, 4), (2, 0), (2, 4), (1, 1), (3, 3)],
    [(0, 4), (4, 1), (1, 2), (2, 5), (5, 3), (3, 0)],
    inner=[(4, 5)],
    markers={"middle": [6], "bottom": [0, 1]},
    regions={"a": (0.5, 1), "b": (3, 1)},
)


def signed_volume(domain: Domain) -> float:
    """By the directions in which facets are turned: the volume if they all point out."""
    shell = domain._coarse
    return float(np.linalg.det(shell.points[shell.bounding]).sum() / 6)


def test_extruded_polygon() -> None:
    body = Domain.extruded(FRAME, 2)
    assert body.volume == 30.0 == signed_volume(body) and len(body.points) == 16
    assert {name: rows.tolist() for name, rows in body.markers.items()} == {
        "wall": [0, 1], "hole": [4, 5, 6, 7], "bottom": [8], "top": [9],
    }  # fmt: skip
    assert len(body.facets[8]) == 2 and body.regions["steel"].tolist() == [[0.5, 0.5, 1.0]]
    assert body.contains([(1.5, 1.5, 1), (3, 3, 1), (3, 3, 2.5)]).tolist() == [False, True, False]


@pytest.mark.parametrize("height", [1.5, -1.5, (1.0, 0.5, 2.0), (0.3, -0.1, -0.7)])
def test_extruded_along(height: object) -> None:
    """Downwards, too, "bottom" is the lower end; layers cut the walls."""
    body = Domain.extruded(FRAME, height, layers=3)
    rise = np.ravel(height)[-1]
    assert body.volume == pytest.approx(15 * abs(rise), rel=1e-14)
    assert signed_volume(body) == pytest.approx(body.volume, rel=1e-12)
    assert len(body.points) == 4 * 8 and len(body.facets) == 3 * 8 + 2
    ends = [body.points[body.facets[int(body.markers[name][0])][0]][:, 2] for name in ("bottom", "top")]
    assert set(ends[0]) == {min(0.0, rise)} and set(ends[1]) == {max(0.0, rise)}


def test_inner_lines_and_points_are_swept() -> None:
    body = Domain.extruded(HALVES, 2)
    assert body.volume == 32.0 == signed_volume(body)
    assert [len(row) for row in body.inner] == [4, 2, 2]
    assert body.markers["middle"].tolist() == [len(body.facets)]
    assert {"bottom", "bottom end", "top end"} <= set(body.markers)
    assert (
        body.points[np.unique(np.concatenate([body.facets[i] for i in body.markers["bottom"]]))][:, 1].max()
        == 0
    )
    named = Domain.extruded(HALVES, 2, ends=("low", "high"))
    assert {"low", "high"} <= set(named.markers)


def test_islands_and_touching_rings() -> None:
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    rings = [square * 9, square * 7 + 1, square * 5 + 2, square * 3 + 3, square + 20]
    start = np.arange(0, 20, 4)[:, None, None]
    sides = np.concatenate(start + np.array([(0, 1), (1, 2), (2, 3), (3, 0)]))
    island = Domain(np.concatenate(rings), sides[np.random.default_rng(0).permutation(20)])
    body = Domain.extruded(island, 1)
    assert body.volume == 81 - 49 + 25 - 9 + 1 == pytest.approx(signed_volume(body))
    assert sorted(len(body.facets.rings(i)) for i in range(20, 26)) == [1, 1, 2, 2, 2, 2]
    touching = Domain([(0, 0), (4, 0), (4, 4), (0, 4), (2, 0), (3, 1), (1, 1)],
                      [(0, 4), (4, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 4)])  # fmt: skip
    body = Domain.extruded(touching, 1)
    assert body.volume == 15.0 == pytest.approx(signed_volume(body))


def test_curves_are_cut_on_their_true_circles() -> None:
    body = Domain.extruded(Domain.disc(), 1, size=0.2)
    assert np.abs(np.hypot(*body.points[:, :2].T) - 1).max() <= 2 * np.spacing(1.0)
    assert body.volume == pytest.approx(pi, rel=0.01) and len(body.markers["top"]) == 1
    assert len(body.points) % 6 == 0  # five layers


def cracked(shift: float) -> Domain:
    """A region with a wall, a crack of two pieces that ends inside, and two loose points."""
    square = [(0, 0), (2, 0), (2, 1), (0, 1), (1, 0), (1, 1)]
    points = np.array([*square, (0.5, 0.5), (0.3, 0.5), (0.2, 0.8), (1.5, 0.4), (1.7, 0.8)])
    facets = [(0, 4), (4, 1), (1, 2), (2, 5), (5, 3), (3, 0)]
    return Domain(points + np.array([shift, 0.0]), facets, inner=[(4, 5), (6, 7), (7, 8)])


@pytest.mark.parametrize("turn", [0.0, 90.0])
def test_ends_are_polygons_cut_along_what_is_inside(turn: float) -> None:
    """Each inner point is a corner of polygons; there are few of them, and all is divided by a size."""
    body = Domain.revolved(cracked(1.0), turn) if turn else Domain.extruded(cracked(0.0), 1)
    names = ("start", "end") if turn else ("bottom", "top")
    ends = np.concatenate([body.markers[name] for name in names])
    assert len(ends) <= 12 and body.facets.corners[ends].max() >= 4
    assert body.volume == pytest.approx(signed_volume(body), rel=1e-12)
    at = {v for i in ends.tolist() for ring in body.facets.rings(i) for v in ring.tolist()}
    assert len(at) == 2 * len(cracked(0.0).points)
    mesh = tetrahedralize(body, 0.25)
    assert mesh.complete and check(mesh, domain=body)


def test_a_prism_is_divided() -> None:
    """Its ends are triangles, but joined to no other triangle: shapes."""
    prism = Domain.extruded(Domain.polygon([(0, 0), (1, 0), (0, 1)]), 1.0)
    assert tetrahedralize(prism, 0.2).complete
    with pytest.warns(IncompleteWarning, match="split_boundary=True"):
        corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        tetrahedralize(Domain(corners, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]), 0.2)


@pytest.mark.parametrize("angle", [360.0, 180.0, 270.0])
@pytest.mark.parametrize("low", [0.0, 0.5])
def test_flat_walls_around_an_axis_are_polygons(angle: float, low: float) -> None:
    body = Domain.revolved(Domain.rectangle((low, 0), (1, 1)), angle)
    walls = np.concatenate([body.markers[name] for name in ("bottom", "top")])
    assert len(walls) == 2 and body.volume == pytest.approx(signed_volume(body), rel=1e-12)
    rings = 2 if angle == 360.0 and low > 0 else 1
    assert [len(body.facets.rings(i)) for i in walls.tolist()] == [rings, rings]
    mesh = tetrahedralize(body, 0.2)
    assert mesh.complete and check(mesh, domain=body)


def test_discs_whose_middle_is_needed_are_fans() -> None:
    """An inner piece, or a cone, ends in the middle of a disc: it stays a corner."""
    rod = Domain([(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 1), (1, 2), (2, 3), (3, 0)])
    needle = Domain(
        [*rod.points, (0, 0.5)], [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0)], inner=[(1, 4)],
    )  # fmt: skip
    body = Domain.revolved(needle, count=8)
    assert body.volume == pytest.approx(signed_volume(body), rel=1e-12) and len(body.points) == 2 * 8 + 1
    funnel = Domain([(0, 0), (1, 0), (1, 1)], [(0, 1), (1, 2), (2, 0)], inner=None)
    body = Domain.revolved(funnel, count=8)
    assert len(body.points) == 17 and (body.facets.corners == 3).sum() == 16, (
        "the cone and the disc share a tip"
    )
    assert len(Domain.revolved(rod, count=8).points) == 16


@given(st.sampled_from(sorted(KINDS)), st.integers(0, 10_000), st.sampled_from([1.0, -0.5, (0.25, 0.5, 1.0)]))
@settings(max_examples=12, deadline=None)
def test_random_regions_are_extruded(kind: str, seed: int, height: object) -> None:
    if kind in ("wide exponents", "near"):
        height = 1.0  # along a slope rounding can make points equal
    planar = random_region(seed, kind)
    body = Domain.extruded(planar, height)
    chords = planar.sampled()
    flat = Domain(**chords.parts())
    assert body.volume == pytest.approx(flat.area * abs(np.ravel(height)[-1]), rel=1e-9)
    assert signed_volume(body) == pytest.approx(body.volume, rel=1e-9, abs=1e-12)


# ---------------------------------------------------------------------- revolution


def test_revolved_rectangle_is_a_prism() -> None:
    body = Domain.revolved(Domain.rectangle((0, 0), (1, 2)), count=6)
    assert len(body.points) == 12 and body.facets.corners.tolist() == [6, *[4] * 6, 6], "ends are one polygon"
    assert body.volume == pytest.approx(3 * sqrt(3), rel=1e-14) == signed_volume(body)
    assert list(body.markers) == ["bottom", "right", "top"]  # the piece on the axis has no wall
    ring = Domain.revolved(Domain.rectangle((1, 0), (2, 2)), count=8)
    assert ring.volume == pytest.approx(2 * 8 * sin(pi / 4) / 2 * 3, rel=1e-14) == signed_volume(ring)


@pytest.mark.parametrize("angle", [20.0, 90.0, 200.0, 359.0, 360.0])
def test_revolved_by_an_angle(angle: float) -> None:
    planar = Domain.rectangle((1, 0), (2, 2), regions={"x": (1.5, 1)})
    body = Domain.revolved(planar, angle, size=0.5)
    assert body.volume == pytest.approx(6 * pi * angle / 360, rel=0.03)
    assert signed_volume(body) == pytest.approx(body.volume, rel=1e-12)
    assert ("start" in body.markers) == (angle < 360)
    around = np.hypot(*body.points[:, :2].T)
    true = np.unique(planar.sampled(0.5).points[:, 0])
    assert np.abs(around[:, None] - true).min(axis=1).max() <= 2 * np.spacing(2.0)


@pytest.mark.parametrize("angle", [200.0, 360.0])
def test_revolved_with_inner_pieces_at_the_axis(angle: float) -> None:
    body = Domain.revolved(HALVES, angle, count=6)
    assert signed_volume(body) == pytest.approx(body.volume, rel=1e-12)
    assert (body.inner.corners == 2).sum() == 12 and (body.inner.corners == 4).sum() == 6
    assert set(body.regions) == {"a", "b"}
    axis = Domain([(0, 0), (1, 0), (0, 1), (0, 3)], [(0, 1), (1, 2), (2, 0)], inner=[(2, 3)])
    whole = Domain.revolved(axis, angle, count=5)
    assert whole.inner.corners.tolist() == [2] and whole.points[whole.inner[0]][:, :2].max() == 0


@pytest.mark.parametrize("angle", [200.0, 360.0])
def test_points_of_pieces_on_the_axis_vanish(angle: float) -> None:
    planar = Domain.rectangle((0, 0), (1, 2), markers={"wall": [1]})
    body = Domain.revolved(planar, angle, size=0.2)
    assert len(body.loose) == 0
    assert signed_volume(body) == pytest.approx(body.volume, rel=1e-12)
    at = body.points[:, 0] ** 2 + body.points[:, 1] ** 2 == 0
    assert at.sum() == (0 if angle == 360 else 11)  # the ends of the body have them, whole discs have none
    wall = np.unique(np.concatenate([body.facets[i] for i in body.markers["wall"]]))
    assert np.hypot(*body.points[wall, :2].T) == pytest.approx(1.0)
    corner = Domain([(0, 0), (1, 0), (1, 2), (0, 2), (0, 1)], [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0)])
    assert len(Domain.revolved(corner, count=6).points) == 12
    asked = Domain([*corner.points, (0.5, 1.5)], corner.facets)
    assert len(Domain.revolved(asked, count=6).inner) == 6
    held = Domain([(0, 0), (1, 0), (1, 2), (0.5, 2), (0, 3), (0, 1)], [(0, 1), (1, 2), (2, 3), (3, 0)])
    kept = Domain.revolved(held, count=6)
    assert kept.points[kept.loose].tolist() == [[0, 0, 3], [0, 0, 1]]  # loose points that are given stay


@pytest.mark.parametrize("angle", [200.0, 360.0])
def test_trapezoids_that_are_flat_up_to_rounding_make_no_flat_cells(angle: float) -> None:
    """Both diagonals are as long; along the outer one the four corners would be a cell of volume 1e-19."""
    for planar in (Domain.disc((2, 0), 0.5), Domain.disc((2, 0), 1).with_holes(Domain.disc((2, 0), 0.5))):
        body = Domain.revolved(planar, angle, size=0.3)
        mesh = tetrahedralize(body)
        assert mesh.complete and check(mesh, domain=body)
        assert simplex.volume(mesh.corners).min() > 1e-6
        if angle == 360:  # no holes in the facets
            again = tetrahedralize(Domain(body.points, [list(row)[::-1] for row in body.facets]))
            assert again.complete and simplex.volume(again.corners).min() > 1e-6
    rows = body.triangulated.bounding.reshape(-1, 2, 3)[:100]  # two triangles of each trapezoid
    for one, two in rows:
        tip = np.setdiff1d(two, one)
        assert len(tip) == 1 and orient(body.points[[*one, *tip]]) >= 0


def test_disc_becomes_a_torus() -> None:
    body = Domain.revolved(Domain.disc((2, 0), 1), size=0.1)
    assert body.volume == pytest.approx(4 * pi**2, rel=0.01) == signed_volume(body)


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: Domain.extruded(FRAME, 0), "stays in the plane"),
        (lambda: Domain.extruded(FRAME, (1, 2)), "height must be three coordinates"),
        (lambda: Domain.extruded(FRAME, (1, 2, 0)), "stays in the plane"),
        (lambda: Domain.extruded(FRAME, 1, layers=0), "layers = 0"),
        (lambda: Domain.extruded(FRAME, 1, layers=10**8), "give a larger size or fewer layers"),
        (lambda: Domain.extruded(FRAME, 1, ends="ab"), "ends must be two names"),
        (lambda: Domain.extruded(Domain.box(), 1), "a body in space cannot be extruded"),
        (lambda: Domain.extruded([(0, 0), (1, 0), (0, 1)], 1), "a planar Domain can be extruded, not a list"),
        (lambda: Domain.revolved(Domain.disc()), "crosses the axis, at"),
        (lambda: Domain.revolved(FRAME, 0), "angle = 0 must be more than 0"),
        (lambda: Domain.revolved(FRAME, 400), "angle = 400"),
        (lambda: Domain.revolved(FRAME, count=2), "count = 2 is too few"),
        (lambda: Domain.revolved(FRAME, size=-1), "size"),
    ],
)
def test_bad_arguments(make: object, told: str) -> None:
    with pytest.raises(InputError, match=told):
        make()


@given(
    st.sampled_from(sorted(set(KINDS) - {"wide exponents", "near"})),
    st.integers(0, 10_000),
    st.sampled_from([0.0, 0.5]),
    st.sampled_from([360.0, 130.0]),
)
@settings(max_examples=15, deadline=None)
def test_random_regions_are_revolved(kind: str, seed: int, away: float, angle: float) -> None:
    """The volume by the divergence theorem: sin(step) times the sum of half the integrals of r^2 dz."""
    chords = random_region(seed, kind).sampled().parts()
    points = chords["points"] - [chords["points"][:, 0].min() - away, 0.0]
    planar = Domain(points, chords["facets"], inner=chords["inner"])
    body = Domain.revolved(planar, angle, count=5)
    ends = points[planar.facets]
    left = left_parity(planar.points, planar.facets)
    (r, z), (s, t) = np.where(left[:, None, None], ends, ends[:, ::-1]).transpose(1, 2, 0)
    moment = ((t - z) * (r * r + r * s + s * s)).sum() / 6
    assert body.volume == pytest.approx(5 * sin(angle / 360 * 2 * pi / 5) * moment, rel=1e-9)
    assert signed_volume(body) == pytest.approx(body.volume, rel=1e-9)
