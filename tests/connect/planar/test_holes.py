"""The convex hull without holes: `constrained_delaunay(domain, hull="holes")`, Triangle's -pc."""

import numpy as np
import pytest

from unstruct import Domain, InputError, check, constrained_delaunay, refine

BOX = """8 2 0 1
1 0 0 0
2 0 3 0
3 3 0 0
4 3 3 33
5 1 1 0
6 1 2 0
7 2 1 0
8 2 2 0
5 1
1 1 2 5
2 5 7 0
3 7 8 0
4 8 6 10
5 6 5 0
1
1 1.5 1.5
"""  # of the shape of Triangle's box.poly: only the left side is a segment


@pytest.fixture
def box(tmp_path):
    path = tmp_path / "box.poly"
    path.write_text(BOX)
    return Domain.read(path)


def test_the_box_of_triangle(box, tmp_path):
    assert len(box.facets) == 0 and box.hole_seeds.tolist() == [[1.5, 1.5]]
    mesh = constrained_delaunay(box, hull="holes")
    assert mesh.size == 8 and check(mesh) and mesh.volume == 8.0
    assert constrained_delaunay(box, hull=True).volume == 9.0
    assert mesh.find_simplex((1.5, 1.5)) == -1 and len(mesh.segments) == 5
    finer = refine(mesh, 0.3)
    assert finer.complete and check(finer) and abs(finer.volume - 8.0) < 1e-12
    with pytest.raises(InputError, match="hull='holes'"):
        constrained_delaunay(box)
    with pytest.raises(InputError, match="hull='holes'"):
        refine(box, 0.3)
    box.write(tmp_path / "again.poly")
    again = Domain.read(tmp_path / "again.poly")
    assert again.hole_seeds.tolist() == [[1.5, 1.5]]
    assert constrained_delaunay(again, hull="holes").volume == 8.0


def test_holes_and_notches_of_a_domain():
    ell = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)]
    domain = Domain.polygon(ell, holes=[[(0.25, 0.25), (0.5, 0.25), (0.5, 0.5), (0.25, 0.5)]])
    hull = constrained_delaunay(domain, hull=True).volume
    mesh = constrained_delaunay(domain, hull="holes")
    assert check(mesh) and hull - mesh.volume == 0.0625 and hull == 11.5
    assert sorted(set(mesh.markers["region"].tolist())) == [0, 1]
    with pytest.raises(InputError, match="hull=True"):
        constrained_delaunay(Domain([(0, 0), (1, 0), (0, 1)], np.empty((0, 2), int)))


def test_an_island_in_a_hole_stays_and_names_are_kept():
    rings = [
        [(0, 0), (9, 0), (9, 9), (0, 9)],
        [(1, 1), (8, 1), (8, 8), (1, 8)],
        [(3, 3), (6, 3), (6, 6), (3, 6)],
    ]
    points = np.concatenate(rings)
    facets = [(4 * r + k, 4 * r + (k + 1) % 4) for r in range(3) for k in range(4)]
    domain = Domain(points, facets, regions={"island": [(4, 4)], "rim": [(0.5, 0.5)]})
    mesh = constrained_delaunay(domain, hull="holes")
    same = constrained_delaunay(domain)
    assert check(mesh, domain=domain) and mesh.volume == same.volume == 41.0
    assert mesh.regions == same.regions
    assert mesh.volumes[mesh.markers["region"] == 0].sum() == 9.0


def test_what_cannot_be_is_named(tmp_path):
    path = tmp_path / "all.poly"
    path.write_text("3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n3 0\n1 1 2\n2 2 3\n3 3 1\n1\n1 .2 .2\n")
    with pytest.raises(InputError, match="leave nothing"):
        constrained_delaunay(Domain.read(path), hull="holes")
    path = tmp_path / "named.poly"
    path.write_text(BOX + "1\n1 1.25 1.25 7 -1\n")
    with pytest.raises(InputError, match="region '7' lies in a hole"):
        constrained_delaunay(Domain.read(path), hull="holes")
    with pytest.raises(InputError, match="hull must be True, False or 'holes', not 'hole'"):
        constrained_delaunay(Domain.rectangle(), hull="hole")
