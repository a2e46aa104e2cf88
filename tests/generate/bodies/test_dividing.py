"""Facets cut by a size: all of a polygon, each edge once, triangles kept, at any place and scale."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, DomainMesh, check, tetrahedralize
from unstruct.generate.bodies.dividing import Divided, divided
from unstruct.sizing.field import as_size

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
THREES = [[f[0], f[i], f[i + 1]] for f in SIDES for i in (1, 2)]
BEND = Domain.polygon(
    [(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2)], [[(0.3, 0.3), (0.6, 0.3), (0.5, 0.7)]]
)


def turn(seed: int) -> np.ndarray:
    return np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]


def cut(domain: Domain, size: object, everything: bool = False) -> Divided:
    found = divided(domain, as_size(size), everything)
    assert found is not None
    assert np.array_equal(found.domain.points[: len(domain.points)], domain.points)
    return found


def areas(domain: Domain, owner: np.ndarray, count: int) -> np.ndarray:
    shell = domain.triangulated
    x = domain.points[shell.triangles]
    area = np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1) / 2
    return np.bincount(owner[shell.piece], area, minlength=count)


def meshed(domain: Domain, size: object, **options: object) -> DomainMesh:
    mesh = tetrahedralize(domain, size, **options)
    report = check(mesh, domain=domain)
    assert report, report
    return mesh


def test_a_box_of_six_polygons_is_a_shape() -> None:
    mesh = meshed(Domain.box(), 0.2)
    assert mesh.complete and 900 < mesh.size < 1300 and mesh.quality("min_dihedral").min() > 25
    assert mesh.counts["added on edges and facets"] == len(mesh.steiner) > 150
    length = np.linalg.norm(
        np.diff(mesh.points[mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)], axis=1), axis=2
    )
    assert 0.1 < length.min() and length.max() < 0.36
    assert tetrahedralize(Domain.box(), 2.0).size == 6  # nothing is to be cut


@pytest.mark.parametrize("seed", range(4))
def test_parts_cover_their_polygons(seed: int) -> None:
    body = Domain.extruded(BEND, 0.7)
    domain = Domain(body.points @ turn(seed).T + [5, -7, 1], body.facets, markers=body.markers)
    found = cut(domain, 0.2)
    mine = areas(found.domain, found.parent, len(domain.pieces))
    assert mine == pytest.approx(areas(domain, np.arange(len(domain.pieces)), len(domain.pieces)), rel=1e-12)
    mesh = meshed(domain, 0.2)
    assert mesh.complete and set(mesh.markers) >= set(domain.markers)
    assert mesh.quality("min_dihedral").min() > 20


def test_planes_of_constant_coordinate_stay_exact() -> None:
    domain = Domain.box((0.1, 0.2, 0.3), (0.7, 0.9, 1.1))
    found = cut(domain, 0.1)
    for piece in range(6):
        rows = found.domain.triangulated.triangles[found.parent == piece]
        spread = np.ptp(found.domain.points[rows].reshape(-1, 3), axis=0)
        assert len(rows) > 50 and spread.min() == 0.0


def test_triangles_are_kept_unless_all_are_asked_for() -> None:
    domain = Domain(CORNERS, THREES)
    assert divided(domain, as_size(0.2)) is None
    found = cut(domain, 0.2, everything=True)
    assert np.bincount(found.parent).min() > 10 and len(found.domain.facets) > 200
    mesh = meshed(domain, 0.2, split_boundary=True)
    assert mesh.complete and mesh.quality("min_dihedral").min() > 20
    # One side of the box as triangles: their edges stay, those of the others are cut.
    mixed = Domain(CORNERS, [*THREES[:2], *SIDES[1:]])
    found = cut(mixed, 0.25)
    assert np.bincount(found.parent)[:2].tolist() == [1, 1] and np.bincount(found.parent)[2:].min() > 10
    meshed(mixed, 0.25)


def test_inner_pieces_regions_and_names() -> None:
    inside = CORNERS * 0.3 + 0.35
    extra = [(0.1, 0.1, 0.1), (0.1, 0.1, 0.9)]
    domain = Domain(
        np.vstack([CORNERS, inside, extra]),
        SIDES,
        inner=[*([i + 8 for i in side] for side in SIDES), (17, 16)],
        markers={"low": [0], "core": range(6, 12), "wire": [12]},
        regions={"shell": (0.2, 0.2, 0.2), "core": (0.5, 0.5, 0.5)},
    )
    found = cut(domain, 0.1)
    assert found.parent.max() == 12 and (found.parent == 12).sum() == 8
    span = found.span[found.parent == 12]
    assert np.sort(span[:, 0])[1:] == pytest.approx(np.sort(span[:, 1])[:-1]) and span.min() == 0
    mesh = meshed(domain, 0.1)
    assert mesh.complete and (mesh.piece == 12).sum() == 8 and len(mesh.markers["wire"]) == 8
    core = mesh.markers["region"] == mesh.regions["core"]
    x = mesh.points[mesh.simplices[core]]
    volume = np.linalg.det(x[:, 1:] - x[:, :1]).sum() / 6
    assert volume == pytest.approx(0.3**3, rel=1e-12)


def test_an_inner_piece_that_ends_inside_a_polygon() -> None:
    """It ends at two of its vertices: the edge between them is cut once, and there in the polygon."""
    domain = Domain(np.vstack([CORNERS, [(0.5, 0.2, 0.2), (0.5, 0.8, 0.8)]]), SIDES, inner=[(0, 3, 9, 8)])
    mesh = meshed(domain, 0.2)
    assert mesh.complete and len(mesh.markers["inner"]) > 10


def test_polygons_that_are_not_quite_flat() -> None:
    points = CORNERS.copy()
    points[7] = 1.0, 1.0, 1.0005
    mesh = meshed(Domain(points, SIDES), 0.2)
    assert mesh.complete and mesh.quality("min_dihedral").min() > 20


@pytest.mark.parametrize("scale", [1e-150, 1e-3, 1e150])
def test_scales(scale: float) -> None:
    mesh = meshed(Domain(CORNERS * scale, SIDES), 0.3 * scale)
    assert mesh.complete and mesh.size > 150


def test_far_from_the_origin() -> None:
    mesh = meshed(Domain(CORNERS @ turn(1).T + 1e8, SIDES), 0.3)
    assert mesh.size > 150


def test_many_small_facets_at_once() -> None:
    ring = Domain.revolved(Domain.rectangle((1, 0), (1.4, 0.4)), size=0.1)
    found = cut(ring, lambda x: 0.06 + 0.02 * x[:, 2])
    assert (np.bincount(found.parent) > 2).all()
    mine = areas(found.domain, found.parent, len(ring.pieces))
    assert mine == pytest.approx(areas(ring, np.arange(len(ring.pieces)), len(ring.pieces)), rel=1e-9)


def test_false_keeps_all() -> None:
    with pytest.warns(UserWarning):
        mesh = tetrahedralize(Domain.box(), 0.3, split_boundary=False)
    assert len(mesh.steiner) == 0 and not mesh.complete


@given(
    st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=3, max_size=8),
    st.integers(0, 50),
    st.sampled_from([0.7, 1.3, 2.9]),
)
@settings(max_examples=15, deadline=None)
def test_random_prisms(corners: list[tuple[int, int]], seed: int, size: float) -> None:
    """Columns over star-shaped polygons on a grid, turned: valid, and the volume to rounding."""
    angle = [np.arctan2(y - 3.1, x - 3.07) for x, y in corners]
    ring = [corners[i] for i in np.argsort(angle, kind="stable")]
    ring = [p for i, p in enumerate(ring) if p != ring[i - 1]]
    try:
        planar = Domain.polygon(ring)
    except ValueError:
        return
    body = Domain.extruded(planar, 2.0)
    domain = Domain(body.points @ turn(seed).T, body.facets)
    mesh = meshed(domain, size)
    exact = 2 * sum(Fraction(a[0] * b[1] - a[1] * b[0], 2) for a, b in zip(ring, ring[1:] + ring[:1]))
    x = mesh.points[mesh.simplices]
    assert np.linalg.det(x[:, 1:] - x[:, :1]).sum() / 6 == pytest.approx(abs(float(exact)), rel=1e-9)
