"""Caps that meet: by brute force over all pairs, planes in which layers end, layers within layers."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, Layers, check, prismatic_layers
from unstruct.generate.prisms.clear import Border, Over, clashes, inside_out, skin_of, surrounded
from unstruct.generate.prisms.records import Others
from unstruct.geometry.triangle_pairs import edges_of, meetings_in_space

LAYERS = Layers(thickness=0.5, growth=1.1, count=5)
NO_BORDER = Border(np.empty((0, 2), dtype=np.int64), np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int64))


def ball(radius: float = 1.0, center: tuple[float, ...] = (0.0, 0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    domain = Domain.ball(size=0.5)
    return domain.points * radius + np.array(center), domain.triangulated.triangles


def together(*bodies: tuple[np.ndarray, np.ndarray]) -> Domain:
    start = np.cumsum([0] + [len(points) for points, _ in bodies])
    return Domain(
        np.concatenate([points for points, _ in bodies]),
        np.concatenate([rows + n for (_, rows), n in zip(bodies, start)]),
    )


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.1, 0.4, 1.0]), st.integers(0, 3))
def test_clashes_are_those_of_all_pairs(seed: int, rough: float, still: int) -> None:
    """Caps over a ball with heights by chance, some of them zero, on a grid that gives touching ones."""
    rng = np.random.default_rng(seed)
    points, rows = ball()
    top = points * (1 + rough * rng.random((len(points), 1)))
    top += rough * rng.standard_normal(top.shape) * rng.integers(0, 2, (len(top), 1))
    top = np.round(top * 8) / 8
    moves = np.ones(len(points), dtype=bool)
    moves[rng.integers(0, len(points), still)] = False
    top[~moves] = points[~moves]
    every = np.concatenate([points, top])
    number = np.where(moves, len(points) + np.arange(len(points)), np.arange(len(points)))
    cap = number[rows][moves[rows].any(axis=1)]
    x = every[cap]
    if (np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]) == 0).all(axis=1).any():
        return  # a flat triangle, which no positive column has
    others = Others(points, np.empty((0, 3), dtype=np.int32), np.empty(0, dtype=np.int32))
    planes = np.full((len(points), 2), -1, dtype=np.int32)
    base, changed = np.arange(len(points)), np.ones(len(points), dtype=bool)
    skin = skin_of(others, rows, base, top, moves, planes, NO_BORDER, changed)
    found = clashes(skin)
    triangles = np.concatenate([rows, cap]).astype(np.int32)
    edges = edges_of(triangles)
    met = meetings_in_space(every, triangles, edges)
    key = {frozenset(e): i for i, e in enumerate(edges.tolist())}
    wanted: set[int] = set()
    hits: dict[int, set[int]] = {}
    for e, t in zip(met.edge.tolist(), met.triangle.tolist()):
        hits.setdefault(e, set()).add(t)
    for row in triangles.tolist():
        for pair in combinations(row, 2):
            for t in hits.get(key[frozenset(pair)], ()):
                wanted |= {v - len(points) for v in row + triangles[t].tolist() if v >= len(points)}
    assert set(found.tolist()) == wanted
    some = np.zeros(len(points), dtype=bool)
    some[found[:1]] = True
    few = skin_of(others, rows, base, top, moves, planes, NO_BORDER, some)
    assert set(clashes(few).tolist()) <= wanted and (len(found) == 0 or found[0] in clashes(few))


@pytest.mark.parametrize("gap", [0.5, 0.05, 1e-3])
def test_caps_of_two_bodies(gap: float) -> None:
    domain = together(ball(), ball(1.0, (2.0 + gap, 0.1, 0.0)))
    mesh = prismatic_layers(domain, layers=LAYERS)
    assert check(mesh) and mesh.counts["limited: crossing"] > 0 and mesh.counts["collapsed"] == 0


def test_layers_that_would_contain_a_whole_body() -> None:
    """A speck of dust within the layers of a ball: nothing crosses, but layers would overlap."""
    domain = together(ball(), ball(0.01, (1.4, 0.0, 0.0)))
    mesh = prismatic_layers(domain, layers=Layers(thickness=0.6, growth=1.1, count=5))
    assert check(mesh) and mesh.counts["limited: crossing"] > 0
    alone = prismatic_layers(together(ball()), layers=Layers(thickness=0.6, growth=1.1, count=5))
    assert alone.counts["limited: crossing"] == 0


def test_caps_that_have_passed_each_other() -> None:
    """In a thin shell each cap may lie beyond the other: found by a corner of a cap, not of a base."""
    domain = together(ball(), ball(0.8))
    for thickness in (0.15, 0.17, 0.19):
        mesh = prismatic_layers(
            domain, layers=Layers(thickness=thickness, count=3, growth=1.1), side="inside"
        )
        assert check(mesh) and mesh.counts["limited: crossing"] > 0
    assert check(prismatic_layers(domain, layers=LAYERS))


def test_facets_that_are_no_walls_are_kept_clear() -> None:
    """The lid of a box, and a small body in it that is no wall."""
    box = Domain.box()
    mesh = prismatic_layers(
        box, layers=Layers(thickness=1.5, count=4, growth=1.1), walls="bottom", side="inside"
    )
    assert check(mesh) and mesh.points[:, 2].max() < 1.0
    points, rows = ball(0.05, (0.5, 0.5, 0.5))
    both = box.with_holes(Domain(points, rows))
    mesh = prismatic_layers(
        both, layers=Layers(thickness=0.9, count=4, growth=1.1), walls="bottom", side="inside"
    )
    assert check(mesh) and mesh.points[:, 2].max() < 0.55


def test_sides_stay_within_their_facets() -> None:
    """A step: layers on the lower floor must not pass the corner at which the plane beside them ends."""
    step = Domain.polygon([(0, 0), (2, 0), (2, 2), (1, 2), (1, 0.3), (0, 0.3)])
    duct = Domain.extruded(step, 1.0, markers=None)
    floor = [i for i, row in enumerate(duct.facets) if (duct.points[row][:, 1] == 0).all()]
    mesh = prismatic_layers(
        duct, layers=Layers(thickness=0.9, count=4, growth=1.1), walls=floor, side="inside"
    )
    assert check(mesh)
    low = mesh.points[mesh.points[:, 0] < 1.0]
    assert low[:, 1].max() < 0.3


def test_surrounded_asks_only_what_is_near() -> None:
    points, rows = ball()
    others = Others(points, np.empty((0, 3), dtype=np.int32), np.empty(0, dtype=np.int32))
    n = len(points)
    planes, moves = np.full((n, 2), -1, dtype=np.int32), np.ones(n, dtype=bool)
    skin = skin_of(others, rows, np.arange(n), 1.5 * points, moves, planes, NO_BORDER, moves)
    assert len(surrounded(skin, rows, moves)) == 0


def hollow(low: float, high: float, hole: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """The surface of a cube with a cubic hole in it, each from a lowest to a highest coordinate."""
    outer, inner = Domain.box((low,) * 3, (high,) * 3), Domain.box((hole[0],) * 3, (hole[1],) * 3)
    rows = outer.triangulated.triangles, inner.triangulated.triangles[:, ::-1] + len(outer.points)
    return np.concatenate([outer.points, inner.points]), np.concatenate(rows)


def test_every_part_of_the_cap_of_a_hollow_body_is_asked() -> None:
    """Two hollow boxes whose caps do not meet: regions overlap, and none of them contains the other.

    [0, 10]^3 without (4, 6)^3 and [2, 8]^3: of the first cap only the part in the hole is in the second one.
    """
    bodies = hollow(1.0, 9.0, (3.0, 7.0)), hollow(4.5, 5.5, (4.75, 5.25))
    for caps, expected in (
        ((hollow(0.0, 10.0, (4.0, 6.0)), hollow(2.0, 8.0, (4.9, 5.1))), list(range(8, 24))),
        ((hollow(0.0, 10.0, (3.5, 6.5)), hollow(4.25, 5.75, (4.9, 5.1))), []),
    ):
        domain, tops = together(*bodies), np.concatenate([points for points, _ in caps])
        points, rows = domain.points, np.concatenate([bodies[0][1], bodies[1][1] + 16]).astype(np.int32)
        others = Others(points, np.empty((0, 3), dtype=np.int32), np.empty(0, dtype=np.int32))
        planes, every = np.full((len(points), 2), -1, dtype=np.int32), np.ones(len(points), dtype=bool)
        skin = skin_of(others, rows, np.arange(len(points)), tops, every, planes, NO_BORDER, every)
        assert len(clashes(skin)) == 0 and surrounded(skin, rows, every).tolist() == expected
    mesh = prismatic_layers(domain, layers=Layers(thickness=2.5, growth=1.1, count=5))
    assert check(mesh) and mesh.counts["limited: crossing"] > 0 and mesh.counts["collapsed"] == 0


@pytest.mark.parametrize("share", [0.5, 0.125, 0.0, -(2.0**-20), -0.5])
def test_a_cap_that_has_passed_the_center_is_inside_out(share: float) -> None:
    """Of two balls, one with layers inside that reach through its center; the other has none."""
    domain = together(ball(), ball(0.25, (3.0, 0.0, 0.0)))
    points, rows = domain.points, domain.triangulated.triangles[:, ::-1]
    moves = points[:, 0] < 2.0
    top = np.where(moves[:, None], share * points, points)
    others = Others(points, np.empty((0, 3), dtype=np.int32), np.empty(0, dtype=np.int32))
    planes = np.full((len(points), 2), -1, dtype=np.int32)
    base, changed = np.arange(len(points)), np.ones(len(points), dtype=bool)
    skin = skin_of(others, rows, base, top, moves, planes, NO_BORDER, changed)
    found = inside_out(skin, rows, NO_BORDER, moves)
    assert found.tolist() == ([] if share > 0 else np.flatnonzero(moves).tolist())


def test_what_is_over_one_solid_may_meet() -> None:
    """The halves of both diagonals of a flat quadrilateral lie in each other."""
    square = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)])
    others = Others(square, np.empty((0, 3), dtype=np.int32), np.empty(0, dtype=np.int32))
    rows = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7], [4, 5, 7], [5, 6, 7]], dtype=np.int32)
    base, moves = np.tile(np.arange(4), 2), np.arange(8) > 3
    top = np.concatenate([square, square + np.array([0.0, 0.0, 1.0])])
    planes, owner = np.full((8, 2), -1, dtype=np.int32), np.zeros(4, dtype=np.int64)
    for solid, expected in ((owner, []), (np.array([0, 0, 1, 1]), [4, 5, 6, 7])):
        over = Over(owner, solid)
        skin = skin_of(others, rows, base, top, moves, planes, NO_BORDER, moves, over)
        assert clashes(skin).tolist() == expected
        assert skin.solid.tolist() == [-1, -1, *solid.tolist()] and skin.column[2:].tolist() == [0] * 4


def test_caps_of_fans_enclose_a_volume() -> None:
    """What is over creases is a part of the cap that is asked whether it is inside out."""
    box = Domain.box((0, 0, 0), (1, 1, 1))
    points, rows = box.points, box.triangulated.triangles
    others = Others(points, np.empty((0, 3), dtype=np.int32), np.empty(0, dtype=np.int32))
    base, many = np.concatenate([np.arange(8), np.arange(8)]), len(rows)
    planes, every = np.full((16, 2), -1, dtype=np.int32), np.ones(16, dtype=bool)
    owner = np.arange(many)
    for share, expected in ((0.5, []), (-0.5, list(range(8)))):
        # The columns' own tops are flat; the rest of a smaller box, or one that is turned, is over them.
        top = np.concatenate([np.full((8, 3), 0.5), 0.5 + share * (points - 0.5)])
        over = Over(owner, owner)
        both = np.concatenate([rows, rows + 8]).astype(np.int32)
        skin = skin_of(others, both, base, top, every, planes, NO_BORDER, every, over)
        assert inside_out(skin, rows, NO_BORDER, every).tolist() == expected
