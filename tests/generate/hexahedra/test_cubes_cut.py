"""Cut cubes: watertight and positive for any body, near its surface, with names; what is lost is told."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.generate.hexahedra.test_dominant import SIDES, UNIT, blob, halves
from unstruct import Domain, IncompleteWarning, InputError, check, octree, quadtree


def test_ball() -> None:
    body = Domain.ball(size=0.1)
    mesh = octree(body, 0.2).mesh("cut")
    assert check(mesh)
    assert mesh.complete
    assert mesh.figures["cells missed"] < 0.1
    assert mesh.volume == pytest.approx(body.volume, rel=2e-2)
    away = np.abs(np.linalg.norm(mesh.points[np.unique(mesh.boundary)], axis=1) - 1)
    assert away.max() < 0.02
    assert mesh.quality("min_dihedral").min() < 3  # stuffing has more than ten degrees


def test_a_box_of_whole_leaves_is_not_cut() -> None:
    mesh = octree(Domain(UNIT, SIDES), 0.25, box=[[0, 0, 0], [1, 1, 1]]).mesh("cut")
    assert mesh.volume == 1
    assert mesh.counts["cut edges"] == 0
    assert np.array_equal(mesh.points.min(axis=0), [0, 0, 0])
    shifted = octree(Domain(UNIT, SIDES), 0.25, box=[[-1, -1, -1], [3, 3, 3]]).mesh("cut")
    assert check(shifted)
    assert shifted.volume == 1


@pytest.mark.parametrize("step", [[1, 1, 0], [1, 1, 1]])
def test_bodies_that_touch_are_parted(step: list[int]) -> None:
    points, number = np.unique(np.concatenate([UNIT, UNIT + step]), axis=0, return_inverse=True)
    body = Domain(points, number.ravel()[np.concatenate([SIDES, SIDES + 8])])
    mesh = octree(body, 0.25, box=[[0, 0, 0], [2, 2, 2]]).mesh("cut")
    assert check(mesh)
    assert 1.98 < mesh.volume < 2


def test_names_and_regions() -> None:
    mesh = octree(halves(), 0.1).mesh("cut")
    assert check(mesh)
    assert np.abs(mesh.points[mesh.markers["left"]][..., 0]).max() < 0.02
    assert len(mesh.markers["wall"]) == 0  # inner pieces are passed over
    center = mesh.points[mesh.simplices].mean(axis=1)
    sure = np.abs(center[:, 0] - 0.45) > 0.1
    assert ((center[:, 0] < 0.45) == (mesh.markers["region"] == mesh.regions["a"]))[sure].all()


def test_thin_parts_are_told() -> None:
    fin = np.array([1, 0.45, 0.43]) + UNIT * [1.0, 0.02, 0.02]  # a rod at a cube
    body = Domain(np.concatenate([UNIT, fin + np.array([0.3, 0, 0])]), np.concatenate([SIDES, SIDES + 8]))
    with pytest.warns(IncompleteWarning, match="thinner than a leaf"):
        mesh = octree(body, 0.12).mesh("cut")
    assert check(mesh)
    assert not mesh.complete
    assert mesh.points[mesh.simplices[mesh.unrefined]][..., 0].max() > 0.8


def sector(degrees: float) -> Domain:
    """A wedge of a prism with this angle."""
    a = np.radians(degrees)
    return Domain.extruded(Domain.polygon([[0, 0], [1, 0], [np.cos(a), np.sin(a)]]), 1)


def test_the_tip_of_a_thin_wedge_is_told() -> None:
    """A fifth of the volume was lost, two leaves deep, and nothing was said."""
    body = sector(5)
    with pytest.warns(IncompleteWarning, match="thinner than a leaf, and lost or filled"):
        mesh = octree(body, 0.1).mesh("cut")
    assert mesh.volume < 0.8 * body.volume
    assert mesh.figures["cells missed"] > 2
    assert mesh.points[mesh.simplices[mesh.unrefined]][..., 0].min() < 0.15
    assert "near (0, 0, " in " ".join(mesh.reasons.tolist())


@pytest.mark.parametrize("width", [0.01, 0.05])
def test_a_filled_slit_is_told(width: float) -> None:
    """Only vertices in the slit were free, each in a cavity of its own: no place is far from one."""
    low, high = 0.47 - width / 2, 0.47 + width / 2
    plan = [[0, 0], [1, 0], [1, 1], [high, 1], [high, 0.1], [low, 0.1], [low, 1], [0, 1]]
    body = Domain.extruded(Domain.polygon(plan), 0.5)
    with pytest.warns(IncompleteWarning, match="components and Euler characteristic"):
        mesh = octree(body, 0.12).mesh("cut")
    assert check(mesh)
    assert not mesh.complete


@pytest.mark.parametrize("seed", range(4))
def test_right_angles_that_are_cut_off_are_no_loss(seed: int) -> None:
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    turn[:, 0] *= np.sign(np.linalg.det(turn))
    mesh = octree(Domain(UNIT @ turn.T, SIDES), 0.2).mesh("cut")
    assert mesh.complete
    assert 0 < mesh.figures["cells missed"] < 0.7


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([5, 9, 16]), st.sampled_from(["edges", "corners"]))
@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
def test_random_bodies(seed: int, parts: int, balance: str) -> None:
    body = blob(seed)
    size = (body.bounds[1] - body.bounds[0]).max() / parts
    mesh = octree(body, lambda x: size * (1 + (seed % 3) * np.abs(x[:, 0])), balance=balance).mesh("cut")
    assert check(mesh)


@settings(max_examples=15, deadline=None)
@given(st.lists(st.tuples(*[st.integers(0, 8)] * 3), min_size=2, max_size=2, unique=True), st.integers(0, 5))
@pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
def test_boxes_on_the_lattice(ends: list[tuple[int, int, int]], level: int) -> None:
    """Sides through vertices of leaves, through centers, and through nothing of them."""
    low, high = np.minimum(*map(np.array, ends)), np.maximum(*map(np.array, ends))
    if (low == high).any():
        return
    body = Domain(low + UNIT * (high - low), SIDES)
    try:
        mesh = octree(body, max_level=level, min_level=level, box=[[0, 0, 0], [8, 8, 8]]).mesh("cut")
    except InputError as error:
        assert "no vertex of a leaf lies inside" in str(error)
        return
    assert check(mesh)
    if level >= 3:
        assert mesh.volume == pytest.approx(body.volume, rel=1e-12)


def test_few_units_of_rounding() -> None:
    """The smallest leaves that there may be, around a body of few units of rounding."""
    body = Domain(1.0 + 2.0**-40 * UNIT, SIDES)
    box = [[1 - 2.0**-42] * 3, [1 + 1.25 * 2.0**-40] * 3]
    mesh = octree(body, 2.0**-41, box=box).mesh("cut")
    assert check(mesh)


def test_refused() -> None:
    with pytest.raises(InputError, match="needs the tree of a body"):
        octree([[0, 0, 0], [1, 1, 1]]).mesh("cut")
    with pytest.raises(InputError, match="octrees; this is a quadtree"):
        quadtree([[0, 0], [1, 1]]).mesh("cut")
    with pytest.raises(InputError, match="no vertex of a leaf"):
        octree(Domain(0.3 + 0.1 * UNIT, SIDES), box=[[0, 0, 0], [1, 1, 1]], max_level=0).mesh("cut")
