"""`refine(..., refine_if=function)`: the caller's own rule, asked in batches."""

import numpy as np
import pytest

from unstruct import Domain, InputError, check, refine

SQUARE = Domain.rectangle()
INCOMPLETE = pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")


@pytest.mark.parametrize("radius", [0.3, 0.35, 0.4])
def test_a_moving_front(radius):
    calls = []

    def beyond(corners, areas, regions):
        assert corners.shape == (len(areas), 3, 2) and regions.shape == areas.shape
        assert corners.dtype == areas.dtype == np.float64
        assert (areas > 0).all() and (regions == 0).all()
        calls.append(len(areas))
        away = np.abs(np.linalg.norm(corners.mean(axis=1) - 0.5, axis=1) - radius)
        corners[:], areas[:] = areas[:, None, None], np.where(areas > np.maximum(1e-4, 0.005 * away), 1, 0)
        return areas > 0  # what was handed over may be overwritten

    mesh = refine(SQUARE, refine_if=beyond)
    assert mesh.complete and check(mesh, domain=SQUARE, delaunay="constrained")
    assert len(calls) < 40 and calls[0] == 2
    assert not beyond(mesh.corners.copy(), mesh.volumes.copy(), mesh.markers["region"]).any()
    assert mesh.quality("min_angle").min() >= 25 and 500 < mesh.size < 10_000


def test_it_adds_to_the_other_limits_and_to_meshes():
    domain = Domain(
        [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1)],
        [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0)],
        inner=[(1, 4)],
        regions={"a": [(0.5, 0.5)], "b": [(1.5, 0.5)]},
    )
    mesh = refine(domain, 0.3)
    again = refine(mesh, refine_if=lambda corners, areas, regions: (regions == 1) & (areas > 1e-3))
    assert again.complete and check(again, domain=domain)
    region = again.markers["region"]
    assert again.volumes[region == 1].max() <= 1e-3 < again.volumes[region == 0].max()
    assert again.regions == {"a": 0, "b": 1}
    marked = Domain.rectangle()
    numbered = refine(marked, 0.3)
    numbered.markers["region"] = np.full(numbered.size, 7)
    seen = set()
    refine(numbered, refine_if=lambda corners, areas, regions: bool(seen.update(regions)) | (areas < 0))
    assert seen == {7}
    same = refine(SQUARE, 0.2, refine_if=lambda corners, areas, regions: areas < 0)
    assert np.array_equal(same.simplices, refine(SQUARE, 0.2).simplices)


@INCOMPLETE
def test_a_rule_that_never_ends_stops_at_the_budget():
    mesh = refine(SQUARE, refine_if=lambda corners, areas, regions: areas > 0, budget=2000)
    assert len(mesh.points) == 2000 and set(mesh.reasons) == {"budget"}
    assert len(mesh.unrefined) == mesh.size == mesh.counts["missed refine_if"]
    assert check(mesh, domain=SQUARE)


@INCOMPLETE
def test_a_rule_about_one_point_stops_near_rounding():
    def holds(corners, areas, regions):
        u = corners - np.array([1 / 3, 0])
        v = np.roll(u, -1, axis=1)
        return (u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0] >= 0).all(axis=1)

    mesh = refine(SQUARE, refine_if=holds)
    assert not mesh.complete and mesh.size < 2000 and check(mesh, domain=SQUARE)
    assert all(reason.startswith(("too near", "precision")) for reason in mesh.reasons)


@INCOMPLETE
def test_kept_pieces_are_the_reason():
    rule = {"refine_if": lambda corners, areas, regions: areas > 0.01}
    mesh = refine(SQUARE, min_angle=0, split_boundary=False, **rule)
    assert set(mesh.reasons) == {"kept: only a vertex on a piece that must not be split would help"}
    assert len(mesh.segments) == 4 and mesh.counts["missed refine_if"] == len(mesh.unrefined) > 0


@pytest.mark.parametrize(
    "rule",
    [
        lambda c, a, r: a,
        lambda c, a, r: True,
        lambda c, a, r: np.ones((len(a), 1), bool),
        lambda c, a, r: [1, 0],
    ],
)
def test_other_answers_are_refused(rule):
    with pytest.raises(InputError, match=r"refine_if must return .* shape \(2,\) and dtype bool, not"):
        refine(SQUARE, refine_if=rule)


def test_errors_of_the_function_are_its_own():
    with pytest.raises(ZeroDivisionError):
        refine(SQUARE, refine_if=lambda corners, areas, regions: 1 / 0)
    mesh = refine(SQUARE, 0.3)
    before = mesh.simplices.copy()
    with pytest.raises(KeyError):
        refine(mesh, refine_if=lambda corners, areas, regions: {}[3])
    assert np.array_equal(before, mesh.simplices) and check(mesh, domain=SQUARE)
    with pytest.raises(InputError, match="refine_if must be a function of triangles, not int"):
        refine(SQUARE, refine_if=3)
    with pytest.raises(TypeError):
        refine(SQUARE, refine_if=lambda corners: corners)


@INCOMPLETE
def test_a_disc_is_split_on_its_arc():
    disc = Domain.disc()
    mesh = refine(disc, refine_if=lambda corners, areas, regions: areas > 1e-2)
    assert mesh.complete and check(mesh, domain=disc)
    rim = np.unique(mesh.markers["facets"])
    assert np.abs(np.hypot(*mesh.points[rim].T) - 1).max() < 1e-15 and mesh.volumes.max() <= 1e-2
