"""Surfaces that cross or touch themselves, or have thin walls, seams or needles."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from surface_shapes import joined, remeshed, surface_delaunay_of

import unstruct
from unstruct import Domain, Mesh
from unstruct.base.progress import progress_bar
from unstruct.domain.given_surface import given_surface
from unstruct.generate.surface.intrinsic_run import IntrinsicRun
from unstruct.generate.surface.needles import without_needles
from unstruct.generate.surface.own_crossings import OWN_CROSSING
from unstruct.geometry.embedded import meeting_pairs
from unstruct.geometry.support_features import same_points


def ball(size: float, scale: tuple, shift: tuple = (0.0, 0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    body = Domain.ball(size=size)
    return np.array(body.points) * scale + shift, np.array(body.triangulated.triangles)


def box(low: tuple, high: tuple) -> tuple[np.ndarray, np.ndarray]:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    rows = np.array([row for a, b, c, d in quads for row in ((a, b, c), (a, c, d))])
    return corners * (np.array(high) - low) + low, rows


def ellipsoids() -> Mesh:
    """Two that interpenetrate."""
    return joined(ball(0.3, (1, 0.5, 0.5)), ball(0.3, (0.5, 1, 0.4), (0.4, 0.1, 0.05)))


def wing() -> Mesh:
    """A body with a wing through it, whose trailing edge is thin."""
    points, rows = box((-0.2, -1.5, -0.02), (0.3, 1.5, 0.02))
    points[points[:, 0] > 0, 2] *= 0.1
    return joined(ball(0.3, (1, 0.3, 0.3)), (points, rows))


def tube(n: int = 80, around: int = 12, radius: float = 0.12) -> Mesh:
    """Along a figure eight that is nearly flat: one closed surface that crosses itself."""
    t, a = 2 * np.pi * np.arange(n) / n, 2 * np.pi * np.arange(around) / around
    center = np.stack([np.sin(t), np.sin(t) * np.cos(t), 0.05 * np.cos(t)], axis=1)
    along = np.roll(center, -1, axis=0) - np.roll(center, 1, axis=0)
    side = np.cross(along, [0.0, 0.0, 1.0])
    up = np.cross(side, along)
    side, up = (x / np.linalg.norm(x, axis=1)[:, None] for x in (side, up))
    ring = np.cos(a)[:, None] * side[:, None] + np.sin(a)[:, None] * up[:, None]
    i, j = (x.ravel() for x in np.meshgrid(np.arange(n), np.arange(around), indexing="ij"))
    k, m = (i + 1) % n, (j + 1) % around
    one, two, three, four = i * around + j, i * around + m, k * around + j, k * around + m
    rows = np.concatenate([np.stack([one, two, three], axis=1), np.stack([two, four, three], axis=1)])
    return Mesh((center[:, None] + radius * ring).reshape(-1, 3), rows)


@pytest.mark.parametrize("surface", [ellipsoids(), wing(), tube()], ids=["ellipsoids", "wing", "tube"])
def test_where_the_given_surface_crosses_itself_nothing_is_refined_in_vain(surface: Mesh) -> None:
    """Sizes fell to an eighth all along the crossing, and vertices went over to the other sheet."""
    size = 0.05 * float(np.linalg.norm(np.ptp(surface.points, axis=0)))
    mesh = remeshed(surface, size)
    assert unstruct.check(mesh, domain=surface)
    crossing = mesh.unrefined[mesh.reasons == OWN_CROSSING]
    pairs = meeting_pairs(mesh.points, mesh.simplices)
    assert len(pairs) and set(pairs.ravel().tolist()) <= set(crossing.tolist())
    assert mesh.counts["own crossings"] > 0 and mesh.size < 5000
    straight = surface_delaunay_of(surface, size)
    assert straight.size < 20 * surface.size and straight.counts["own crossings"] > 0
    assert any(OWN_CROSSING in why for why in straight.reasons)


def test_a_slit_that_ends_at_the_boundary_stays_open() -> None:
    """Both its sides were collapsed to one edge: its end has copies, so no two edges had the same ends."""
    points = [(0, 0), (1, 0), (2, 0), (2, 1), (0, 1), (1, 0.5), (0.995, 0.25), (1.005, 0.25)]
    rows = [(0, 1, 6), (0, 6, 4), (4, 6, 5), (4, 5, 3), (1, 2, 7), (2, 3, 7), (3, 5, 7)]
    surface = Mesh(np.column_stack([points, np.zeros(8)]), rows)
    mesh = remeshed(surface, 1.0)
    sides = {frozenset((a, b)) for row in mesh.simplices.tolist() for a, b in zip(row, row[1:] + row[:1])}
    assert len(np.unique(mesh.simplices)) - len(sides) + mesh.size == 0
    assert unstruct.check(mesh, domain=surface)


def test_seams_follow_sizes_that_are_lowered() -> None:
    """Half a tube with a fin on it: edges of the seam stayed as long as was asked for."""
    n = 24
    angle = np.pi * np.arange(n + 1) / n
    ring = np.column_stack([0.2 * np.cos(angle), np.zeros(n + 1), 0.2 * np.sin(angle)])
    points = np.concatenate([ring, ring + np.array([0.0, 2.0, 0.0]), [[0, 0, 0.6], [0, 2, 0.6]]])
    i = np.arange(n)
    rows = np.concatenate(
        [
            np.column_stack([i, i + 1, i + n + 2]), np.column_stack([i, i + n + 2, i + n + 1]),
            [[n // 2, 2 * n + 3, 2 * n + 2], [n // 2, n // 2 + n + 1, 2 * n + 3]],
        ]
    )  # fmt: skip
    surface = Mesh(points, rows)
    mesh = remeshed(surface, 0.3, deviation=0.005)
    ends = Counter(tuple(sorted((a, b))) for r in mesh.simplices.tolist() for a, b in zip(r, r[1:] + r[:1]))
    seam = np.array([edge for edge, count in ends.items() if count == 3])
    length = np.linalg.norm(mesh.points[seam[:, 0]] - mesh.points[seam[:, 1]], axis=1)
    assert length.sum() == pytest.approx(2.0) and length.max() < 0.2
    assert unstruct.check(mesh, domain=surface) and mesh.counts["lowered"] > 0


def test_walls_that_are_thinner_than_the_size() -> None:
    """They had angles of a few degrees between their creases, and no word."""
    mesh = remeshed(joined(box((0, 0, 0), (1, 1, 0.03))), 0.2)
    assert mesh.complete and mesh.figures["least angle"] > 20 and mesh.size < 4000
    told = remeshed(joined(box((0, 0, 0), (1, 1, 1e-3))), 0.2)
    assert told.size < 1000 and all("creases" in why for why in told.reasons) and len(told.reasons)


def fan(n: int) -> Mesh:
    """A disk of needles, as CAD systems write it, closed by a cone."""
    angle = 2 * np.pi * np.arange(n) / n
    points = [*np.column_stack([np.cos(angle), np.sin(angle), np.zeros(n)]), (0.0, 0.0, 0.3)]
    rows = [[0, i + 1, i] for i in range(1, n - 1)] + [[i, (i + 1) % n, n] for i in range(n)]
    return Mesh(np.array(points), rows)


def test_fans_of_needles_are_divided_otherwise_for_searches() -> None:
    """Each search looked at all of their boxes."""
    surface = fan(300)
    given = given_surface(surface)
    other = without_needles(given).support
    assert (other.features == given.support.features).all() and (other.chain == given.support.chain).all()
    flat = (other.points[other.triangles][:, :, 2] == 0.0).all(axis=1)
    corners = other.points[other.triangles[flat]]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    assert (area < 0).all() and -area.sum() / 2 == pytest.approx(150 * np.sin(np.pi / 150))
    degree = np.bincount(other.triangles[flat].ravel())
    assert degree.max() < 30 and flat.sum() == 298
    mesh = remeshed(surface, 0.2)
    assert unstruct.check(mesh, domain=surface)


@pytest.mark.parametrize("genus", [1, 2, 3])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_thirty_degrees_on_closed_surfaces_with_handles(genus: int, seed: int) -> None:
    """Thin frames without kept edges: what the theorem of `intrinsic_run` says is measured."""
    rng = np.random.default_rng(seed)
    width = float(rng.uniform(0.02, 0.3))
    holes = []
    for k in range(genus):
        shift = rng.uniform(0, 0.1, 2)
        holes.append(np.array([(k, 0), (k + 0.8, 0), (k + 0.8, 0.7), (k, 0.7)]) + width + shift * width)
    outer = [(0, 0), (genus - 0.2 + 2.2 * width, 0), (genus - 0.2 + 2.2 * width, 0.7 + 2.2 * width)]
    outer += [(0, 0.7 + 2.2 * width)]
    frame = Domain.extruded(Domain.polygon(outer, holes), float(rng.uniform(0.01, 0.2)))
    shell = frame.triangulated
    given = given_surface(Mesh(frame.points, shell.triangles), None)  # no names, so no edges are kept
    rows = same_points(given.support.points)[given.support.triangles].astype(np.int32)
    run = IntrinsicRun(given, rows, None, 30.0, 200_000, progress_bar(False, ""))
    assert not run.sharp.any()
    shortest = float(run.found.sides.length.min())
    run.refine()
    assert not run.out_of_budget and len(run.angles_below()) == 0
    assert run.found.sides.length.min() >= shortest * (1 - 1e-9)
    many, sides = int(run.found.shape.numbers[1]), run.found.sides
    assert many - len(sides.twin) // 2 + len(sides.twin) // 3 == 2 - 2 * genus
