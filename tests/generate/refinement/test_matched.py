"""`refine` of a mesh with matching sides: both are cut in the same way, bit for bit, or not at all."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import sector

import unstruct
from unstruct import Domain, Mesh, check, refine
from unstruct.geometry.motion import Motion

pytestmark = pytest.mark.filterwarnings("ignore::unstruct.IncompleteWarning")
SQUARE = Domain.rectangle().matched("left", "right").matched("bottom", "top")
COARSE = refine(SQUARE, 0.3)
TURNED = refine(sector(7).matched("low", "high", rotation=360 / 7), 0.3)
LAYERS = Domain(
    [(0, 0), (2, 0), (2, 0.3), (2, 1), (0, 1), (0, 0.3)],
    [(k, (k + 1) % 6) for k in range(6)],
    inner=[(2, 5)],
    regions={"low": [(1, 0.1)], "high": [(1, 0.8)]},
    markers={"left": [4, 5], "right": [1, 2]},
).matched("left", "right")


def sides(mesh: Mesh) -> None:
    """All boundary vertices on the sides of the motions are in pairs, which are exact."""
    assert check(mesh)
    for motion, pairs in mesh.periodic:
        assert np.array_equal(motion(mesh.points[pairs[:, 0]]), mesh.points[pairs[:, 1]])
        both = {frozenset(edge) for edge in np.sort(mesh.boundary, axis=1).tolist()}
        image = dict(pairs.tolist())
        chain = [edge for edge in both if all(v in image for v in edge)]
        assert len(chain) == len(pairs) - 1 and all(
            frozenset(image[v] for v in edge) in both for edge in chain
        )


@settings(deadline=None, max_examples=15)
@given(st.sampled_from([COARSE, TURNED]), st.integers(0, 2**32), st.sampled_from([0.05, 0.2, 0.6]))
def test_random_sizes(mesh, seed, spread):
    rng = np.random.default_rng(seed)
    wave, phase = rng.normal(size=(2, 3)) * 4, rng.random(3) * 6

    def size(x):
        return 0.04 + spread * ((np.sin(x @ wave + phase) ** 2).mean(axis=1))

    fine = refine(mesh, size)
    sides(fine)
    assert set(map(tuple, mesh.pairs)) <= set(map(tuple, fine.pairs))
    again = refine(unstruct.smooth(fine), 0.5 * 0.04)
    sides(again)


def test_what_asks_for_cuts():
    for mesh, options, pairs in (
        (COARSE, {"size": 0.1}, 20), (COARSE, {"size": 0.02}, 98), (COARSE, {"max_area": 1e-3}, 50),
        (COARSE, {"min_angle": 30}, 8), (COARSE, {"size": 0.1, "split_boundary": False}, 8),
        (COARSE, {"size": 0.1, "split_boundary": "inner"}, 8), (COARSE, {"size": 1.0}, 8),
    ):  # fmt: skip
        fine = refine(mesh, **options)
        sides(fine)
        assert len(fine.pairs) == pairs, options
        assert fine.complete or {why.split(":")[0] for why in fine.reasons} == {"kept"}
        assert fine.complete == ("split_boundary" not in options), options


def test_sizes_of_regions_and_names():
    mesh = refine(LAYERS, 0.4)
    fine = refine(mesh, {"low": 0.05, "high": 0.2})
    sides(fine)
    x = fine.points[fine.pairs[:, 0]]
    assert (
        (x[:, 1] <= 0.3).sum() >= 7 and (x[:, 1] > 0.3).sum() == 4 and sorted(fine.regions) == ["high", "low"]
    )
    assert len(fine.markers["left"]) == len(fine.markers["right"]) == len(fine.pairs) - 1
    left = refine(mesh, {"low": 0.05})
    sides(left)
    sides(refine(mesh, 0.01, budget=300))  # the budget is not spent on the sides alone


def test_sides_whose_motion_is_not_known_or_does_not_fit_stay():
    mesh = COARSE
    unknown = [(None, pairs) for _, pairs in mesh.periodic]
    plain = Mesh(mesh.points, mesh.simplices, markers=mesh.markers, periodic=unknown)
    assert refine(plain, 0.1).pairs.tolist() == mesh.pairs.tolist()
    points = np.array(mesh.points)
    motion, pairs = mesh.periodic[0]
    inner = next(v for v in pairs[:, 1].tolist() if 0 < points[v, 1] < 1)
    points[inner, 1] += 1e-6
    moved = Mesh(points, mesh.simplices, markers=mesh.markers, periodic=[(motion, pairs)])
    fine = refine(moved, 0.1)
    assert check(fine) and len(fine.pairs) == len(pairs) + 2 * 1 and not fine.complete
    pair = [(motion, [[0, 1]])]  # vertices alone: they are handed on
    assert len(refine(Mesh(mesh.points, mesh.simplices, periodic=pair), 0.1).pairs) == 1


def test_edges_that_match_several_others_stay():
    """A strip of squares, each the image of the one before: edges are images and have images."""
    n = 4
    points = np.array([(x, y) for x in range(n) for y in (0.0, 1.0)])
    cells = [
        row
        for k in range(n - 1)
        for row in ([2 * k, 2 * k + 2, 2 * k + 1], [2 * k + 1, 2 * k + 2, 2 * k + 3])
    ]
    pairs = [[v, v + 2] for v in range(2 * n - 2)]
    steps = [[2 * k, 2 * k + 1] for k in range(n)]
    mesh = Mesh(points, cells, markers={"steps": steps},
                periodic=[(Motion.translation([1, 0]), pairs)])  # fmt: skip
    fine = refine(mesh, 0.3)
    assert check(fine) and fine.pairs.tolist() == pairs and not fine.complete


def test_a_point_that_would_fall_on_a_vertex_is_not_put():
    """The middle of a side is rounded inward, where a vertex is already: both sides stay whole."""
    shift = np.array([-1.0, 1.0])
    for step in range(100):
        a, b = np.array([0.1, 0.3]), np.array([0.7, 0.9 + step * 1e-9])
        middle = a + 0.5 * (b - a)
        if unstruct.predicates.orient(np.array([a, b, middle])) > 0:
            break
    motion = Motion.translation(shift)
    for place, pairs in ((middle, 2), (middle + 0.1 * shift, 3)):
        mesh = Mesh(
            [a, b, *motion([b, a]), place],
            [[0, 1, 4], [4, 1, 2], [4, 2, 3], [4, 3, 0]],
            periodic=[(motion, [[0, 3], [1, 2]])],
        )
        fine = refine(mesh, 0.4)
        sides(fine)
        assert check(mesh) and len(fine.pairs) == pairs
        assert fine.complete or {why.split(":")[0] for why in fine.reasons} <= {"kept", "narrow"}
