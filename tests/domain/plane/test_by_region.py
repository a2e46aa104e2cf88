"""Sizes by region: the pieces, and every method that takes a size."""

import numpy as np
import pytest

import unstruct
from unstruct import Domain, InputError, check

HALVES = Domain(
    [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1)],
    [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0)],
    inner=[(1, 4)],
    regions={"a": [(0.5, 0.5)], "b": [(1.5, 0.5)]},
)
METHODS = [
    unstruct.refine, unstruct.voronoi_segment, unstruct.circumcenter_insertion, unstruct.advancing_front,
]  # fmt: skip


def test_a_piece_takes_the_smaller_size_of_its_sides():
    cut = HALVES.sampled({"a": 0.05, "b": 0.25})
    assert np.bincount(cut.piece).tolist() == [20, 4, 4, 4, 20, 20, 20]
    plain = HALVES.sampled(0.05)
    same = HALVES.sampled({None: 0.05})
    assert np.array_equal(plain.points, same.points) and np.array_equal(plain.ends, same.ends)


def test_pieces_without_a_size_stay_as_coarse_as_is_safe():
    assert np.bincount(HALVES.sampled({"a": 0.1}).piece).tolist() == [10, 1, 1, 1, 10, 10, 10]
    disc = Domain.disc()
    square = Domain.rectangle((5, 0), (6, 1))
    both = Domain(
        np.concatenate([disc.points, square.points]),
        np.concatenate([disc.facets, square.facets + len(disc.points)]),
        curves=disc.curves,
        regions={"square": [(5.5, 0.5)]},
    )
    cut = both.sampled({"square": 0.5})
    assert np.bincount(cut.piece).tolist() == [*np.bincount(disc.sampled().piece), 2, 2, 2, 2]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("size", [{"a": 0.05, "b": 0.2}, {"a": 0.05, None: 0.2}, {"b": 0.2, None: 0.05}])
def test_every_method_meets_the_size_of_each_region(method, size):
    mesh = method(HALVES, size)
    assert mesh.complete and check(mesh, domain=HALVES)
    region = mesh.markers["region"]
    edges = [np.sqrt(mesh.volumes[region == r].mean() * 4 / np.sqrt(3)) for r in (0, 1)]
    assert 0.03 < edges[0] < 0.06 and 0.1 < edges[1] < 0.23
    assert abs(mesh.volumes[region == 0].sum() - 1) < 1e-12


def test_conforming_takes_sizes_by_region():
    mesh = unstruct.conforming_delaunay(HALVES, {"a": 0.05})
    assert np.bincount(mesh.piece).tolist() == [20, 1, 1, 1, 20, 20, 20]
    assert mesh.complete and check(mesh, domain=HALVES, delaunay=True)


def test_a_field_in_one_region_and_a_number_in_another():
    size = {"a": lambda x: 0.05 + 0.1 * x[:, 1], None: 0.15}
    mesh = unstruct.voronoi_segment(HALVES, size)
    assert mesh.complete and check(mesh, domain=HALVES)
    x = mesh.points[mesh.simplices].mean(axis=1)
    low = (mesh.markers["region"] == 0) & (x[:, 1] < 0.2)
    high = (mesh.markers["region"] == 0) & (x[:, 1] > 0.8)
    assert 2 * mesh.volumes[low].mean() < mesh.volumes[high].mean()


@pytest.mark.parametrize("method", METHODS[1:])
def test_a_region_without_a_size_is_named(method):
    with pytest.raises(InputError, match=r"no entry for region 'b'.*key None"):
        method(HALVES, {"a": 0.1})
    nameless = Domain(HALVES.points, HALVES.facets, inner=HALVES.inner, regions={"a": [(0.5, 0.5)]})
    with pytest.raises(InputError, match=r"a region without a name \(near \(1\."):
        method(nameless, {"a": 0.1})
    with pytest.raises(InputError, match=r"size names region 'c'.*\['a', 'b'\]"):
        method(HALVES, {"c": 0.1})
    with pytest.raises(InputError, match="size must be positive"):
        method(HALVES, {"a": 0.1, "b": -1})


def test_without_a_default_refine_has_no_limit_in_other_regions():
    free = unstruct.refine(HALVES, {"a": 0.1})
    area = unstruct.refine(HALVES, max_area={None: 0.005})
    assert check(free, domain=HALVES) and check(area, domain=HALVES)
    assert free.volumes[free.markers["region"] == 1].max() > 0.02
    assert area.volumes.max() <= 0.005
    finer = unstruct.refine(area, {"a": 0.04, None: 0.1}, max_area={"b": 0.001, None: 0.1})
    assert check(finer, domain=HALVES)
    assert finer.volumes[finer.markers["region"] == 1].max() <= 0.001


def test_a_thin_region_and_a_curved_border():
    disc = Domain.disc((0.5, 0.5), 0.3)
    square = Domain.rectangle()
    thin = [(0.05, 0.02), (0.95, 0.02), (0.95, 0.025), (0.05, 0.025)]
    ring = np.array([(0, 1), (1, 2), (2, 3), (3, 0)])
    domain = Domain(
        np.concatenate([square.points, disc.points, thin]),
        square.facets,
        inner=np.concatenate([disc.facets + 4, ring + 4 + len(disc.points)]),
        curves={piece + 4: curve for piece, curve in disc.curves.items()},
        regions={"disc": [(0.5, 0.5)], "thin": [(0.5, 0.022)]},
    )
    mesh = unstruct.voronoi_segment(domain, {"disc": 0.03, "thin": 0.005, None: 0.2})
    assert mesh.complete and check(mesh, domain=domain)
    region = mesh.markers["region"]
    assert mesh.volumes[region == 1].max() < 0.005**2
    assert mesh.volumes[region == 0].mean() < 0.5 * 0.03**2
