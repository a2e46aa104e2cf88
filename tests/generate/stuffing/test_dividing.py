"""Where moves cannot raise an angle, levels meet elsewhere: leaves are divided, and all begins anew."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.generate.stuffing.test_raising import assert_angles_or_told, assert_on_surface, cone
from tests.helpers.value_tables import assert_sound, dihedral_range
from unstruct import Domain, examples, isosurface_stuffing
from unstruct.generate.stuffing.dividing import filled_leaves
from unstruct.generate.stuffing.filling import background_of, filled_background
from unstruct.generate.stuffing.laying import Laid, laid_in_level_set
from unstruct.generate.stuffing.sampling import LevelSet
from unstruct.generate.stuffing.surfaces import laid_in_surface
from unstruct.generate.tree.balancing import balanced
from unstruct.generate.tree.linear import linear_of, merged
from unstruct.generate.tree.lookup import boxes_of
from unstruct.sizing.field import as_size

pytestmark = pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
MANY = 10**6
Boxes = tuple[np.ndarray, np.ndarray, np.ndarray]


def stuck() -> Laid:
    """A body in which seven cells, down to 6.8 degrees, cannot be raised by moves."""
    body = examples.noise(44)
    return laid_in_level_set(LevelSet(body, body.box, True), as_size(cone(44)), True, 1e-10, (MANY, False))


def boxes(laid: Laid) -> Boxes:
    """Lower and upper corners of leaves, and their levels."""
    grid = laid.grid
    low = boxes_of(grid.first, grid.low, grid.side, grid.depth)[0]
    return low, low + grid.side * 0.5 ** grid.levels[:, None].astype(float), grid.levels


def levels_at(x: np.ndarray, some: Boxes) -> np.ndarray:
    """The levels of all leaves that contain a point, some of them at their sides."""
    low, high, level = some
    return level[((low <= x) & (x <= high)).all(axis=1)]


def test_levels_meet_elsewhere() -> None:
    laid = stuck()
    background = background_of(laid.grid, laid.vertices, laid.sign)
    before = filled_background(background, laid.shares)
    assert len(before.poor) > 0
    after, _, filling = filled_leaves(laid, MANY)
    assert len(filling.poor) == 0
    old, new, meet = boxes(laid), boxes(after), 0
    for row in np.unique(before.owner[before.poor]):
        around = [levels_at(x, old) for x in background.points[background.cells[row]]]
        finest = max(level.max() for level in around)
        meet += min(level.min() for level in around) < finest
        for x in background.points[background.cells[row]]:
            assert levels_at(x, new).min() >= finest
    assert meet > 0


def test_the_angle_is_raised() -> None:
    mesh = isosurface_stuffing(examples.noise(44), cone(44), cap=True, graded=True)
    assert_sound(mesh)
    assert_on_surface(mesh, examples.noise(44))
    least, most = dihedral_range(mesh)
    assert least >= 10
    assert most <= 165
    assert mesh.counts["divided"] > 0


def test_the_budget_is_kept_and_the_rest_told() -> None:
    most = len(stuck().grid.first)
    mesh = isosurface_stuffing(examples.noise(44), cone(44), cap=True, graded=True, budget=most)
    assert_sound(mesh)
    assert dihedral_range(mesh)[0] < 10
    assert mesh.counts["divided"] == 0
    assert any("below 10" in reason for reason in mesh.reasons)
    assert_angles_or_told(mesh)


def ball() -> Laid:
    field = as_size(lambda x: 0.15 + 0.3 * np.abs(x[:, 0]))
    return laid_in_surface(Domain.ball(size=0.4), field, True, (MANY, False))


@pytest.mark.parametrize("make", [stuck, ball])
def test_signs_over_another_tree(make: Callable[[], Laid]) -> None:
    """Where vertices are the same, so are their signs; the old vertices are all there."""
    laid = make()
    rows = np.flatnonzero(laid.grid.levels == laid.grid.depth - 1)[::5]
    split = list(laid.tree.split)
    split[-1] = merged(split[-1], laid.grid.first[rows] >> np.uint64(3))
    other = laid.over(balanced(linear_of(split, 3), "edges"))
    assert len(other.grid.first) > len(laid.grid.first)
    known = dict(zip(map(tuple, other.vertices[1].tolist()), other.sign.tolist(), strict=True))
    found = [known[tuple(place)] for place in laid.vertices[1].tolist()]
    assert np.array_equal(found, laid.sign)
