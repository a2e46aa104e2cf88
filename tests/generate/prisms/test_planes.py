"""Planes beside walls and of borders, and what lies in none."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError, Layers, Mesh, check, prismatic_layers
from unstruct.generate.prisms.planes import planes_of_loops
from unstruct.generate.prisms.stars import stars_of
from unstruct.generate.prisms.walls import base_of

LAYERS = Layers(first=0.02, growth=1.2, count=4)


def test_a_tilted_border_keeps_its_plane_up_to_rounding() -> None:
    rng = np.random.default_rng(0)
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    rim = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    flat = np.column_stack([np.cos(rim), np.sin(rim), 0 * rim])
    points = np.concatenate([flat, 0.7 * flat + [0, 0, 0.5], [[0, 0, 0.8]]]) @ turn.T
    rows = []
    for i in range(12):
        j = (i + 1) % 12
        rows += [(i, j, 12 + j), (i, 12 + j, 12 + i), (12 + i, 12 + j, 24)]
    mesh = prismatic_layers(Mesh(points, np.array(rows)), layers=LAYERS)
    assert check(mesh)
    height = mesh.points @ turn[:, 2]
    assert height.min() > -1e-14
    assert (np.abs(height) < 1e-14).sum() == 5 * 12


def test_planes_of_two_loops() -> None:
    """A tube: both ends are planes of constant x, and so their normals are exact."""
    rim = np.linspace(0, 2 * np.pi, 8, endpoint=False)
    ring = np.column_stack([0 * rim, np.cos(rim), np.sin(rim)])
    points = np.concatenate([ring, ring + np.array([1 / 3, 0, 0])])
    rows = [t for i in range(8) for j in [(i + 1) % 8] for t in ((i, j, 8 + j), (i, 8 + j, 8 + i))]
    triangles = np.array(rows, dtype=np.int32)
    planes, normals = planes_of_loops(points, np.arange(16), triangles, stars_of(triangles, 16).mates)
    assert np.abs(normals).tolist() == [[1, 0, 0]] * 2
    assert (planes[:8, 0] != planes[8:, 0]).all() and (planes[:, 1] == -1).all()
    for side in ("inside", "outside"):
        mesh = prismatic_layers(Mesh(points, triangles), layers=LAYERS, side=side)
        assert check(mesh) and set(mesh.points[:, 0]) == {0.0, 1 / 3}


def test_a_border_in_no_plane_and_facets_in_none() -> None:
    rim = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    bent = np.column_stack([np.cos(rim), np.sin(rim), 0.1 * np.cos(2 * rim)])
    points = np.concatenate([bent, [[0, 0, 1.0]]])
    rows = np.array([(i, (i + 1) % 12, 12) for i in range(12)])
    with pytest.raises(InputError, match="loop of 12 edges that does not lie in a plane: point"):
        prismatic_layers(Mesh(points, rows), layers=LAYERS)
    lid = np.array([(0, (i + 1) % 12, i) for i in range(2, 11)] + [(0, 2, 1)])
    closed = Domain(points, np.concatenate([rows, lid]), markers={"roof": np.arange(12)})
    with pytest.raises(InputError, match="in 3 planes: no ray can stay in all of them"):
        prismatic_layers(closed, layers=LAYERS, walls="roof")


def test_rays_at_corners_have_two_planes() -> None:
    base = base_of(Domain.box(), ["bottom", "top"], "inside")
    assert (base.walls.planes >= 0).all()
    mesh = prismatic_layers(Domain.box(), layers=LAYERS, walls=["bottom", "top"], side="inside")
    assert check(mesh) and np.abs(mesh.steps["direction"]).tolist() == [[0, 0, 1]] * 8
    sides = [name for name in ("left", "right", "front", "back") if name in mesh.markers]
    assert sides == ["left", "right", "front", "back"]
