"""Hexahedra, pyramids and tetrahedra of leaves: conforming for any balanced octree and choice of leaves."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import IncompleteWarning, Mesh, check, octree
from unstruct.generate.hexahedra.pattern import (
    ALL_FACES,
    FAN_OF_LEAF,
    NOT_CHOSEN,
    WHOLE,
    cubes_as_cells,
    kinds_of_leaves,
    leaves_at_ends,
    linked,
)
from unstruct.generate.planting.tree import Tree
from unstruct.generate.tree.vertices import numbered

BOX = [[0.0, 0.0, 0.0], [1.0, 2.0, 4.0]]


def random_tree(seed: int, balance: str, depth: int = 3) -> Tree:
    """Cells divided by chance, all the more near a corner."""
    rng = np.random.default_rng(seed)

    def divide(centers: np.ndarray, sides: np.ndarray) -> np.ndarray:
        return rng.random(len(centers)) < np.where(np.linalg.norm(centers, axis=1) < 2.0, 0.7, 0.2)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)  # more would be divided
        return octree(BOX, divide=divide, min_level=1, max_level=depth, balance=balance)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["edges", "corners"]))
def test_whole_boxes(seed: int, balance: str) -> None:
    tree = random_tree(seed, balance)
    mesh = tree.mesh("hex-dominant")
    assert check(mesh)
    assert mesh.volume == pytest.approx(8.0, rel=1e-14)
    whole = len(mesh.cells.get("hexahedron", ()))
    assert whole + np.count_nonzero(
        _kinds(tree, np.ones(len(tree), dtype=bool), bare=True) == FAN_OF_LEAF
    ) == len(tree)


def _kinds(tree: Tree, chosen: np.ndarray, *, bare: np.ndarray | bool) -> np.ndarray:
    return kinds_of_leaves(tree.grid, numbered(tree.grid), chosen, bare=bare)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.1, 0.95), st.sampled_from(["none", "some", "all"]))
def test_some_leaves(seed: int, share: float, open_faces: str) -> None:
    tree = random_tree(seed, "edges")
    rng = np.random.default_rng(seed)
    some = rng.integers(0, ALL_FACES + 1, len(tree)).astype(np.int8)
    bare = {"none": False, "some": some, "all": True}[open_faces]
    chosen = np.linalg.norm((tree.centers - rng.random(3)) / [1, 2, 4], axis=1) < share
    chosen &= rng.random(len(tree)) < 0.9
    kind = _kinds(tree, chosen, bare=bare)
    assert ((kind != NOT_CHOSEN) == chosen).all()
    cubes = cubes_as_cells(tree.grid, numbered(tree.grid), kind, bare=bare)
    blocks = {"hexahedron": cubes.hexahedra, "pyramid": cubes.pyramids, "tetra": cubes.tetrahedra}
    cells = {name: rows for name, rows in blocks.items() if len(rows)}
    if not cells:
        assert not chosen.any()
        return
    used = np.unique(np.concatenate([rows.ravel() for rows in cells.values()]))
    mesh = Mesh(cubes.points[used], None, cells={n: np.searchsorted(used, r) for n, r in cells.items()})
    found = {p.kind for p in check(mesh).problems}
    assert found <= {"pinched vertex", "pinched edge", "link"}  # leaves may touch at edges and corners only
    low, high = tree.corners
    volumes = np.bincount(cubes.leaf, mesh.volumes, minlength=len(tree))
    assert np.allclose(volumes, np.where(chosen, np.prod(high - low, axis=1), 0.0), rtol=1e-14, atol=0)
    outer = {tuple(sorted(row)) for row in cubes.outer.tolist()}
    bits = {"none": np.zeros_like(some), "some": some, "all": np.full_like(some, ALL_FACES)}[open_faces]
    for row in mesh.boundary.tolist():
        face = used[[v for v in row if v >= 0]]
        if tuple(sorted(face.tolist())) in outer:
            outer.remove(tuple(sorted(face.tolist())))
            continue
        x = cubes.points[face].mean(axis=0)
        at = chosen & ((low <= x) & (x <= high)).all(axis=1)
        faces = np.stack([low == x, high == x], axis=2).reshape(-1, 6)
        assert (((bits[:, None] >> np.arange(6)) & 1 == 1) & faces)[at].any()
    assert not outer
    if not len(cubes.outer):
        return
    x = cubes.points[cubes.outer]
    outward = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    assert ((x.mean(axis=1) - tree.centers[cubes.outer_leaf]) * outward).sum(axis=1).min() > 0


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_components_and_ends(seed: int) -> None:
    tree = random_tree(seed, "corners")
    chosen = np.random.default_rng(seed).random(len(tree)) < 0.4
    start, other = tree.neighbors("faces")
    own = np.repeat(np.arange(len(tree)), np.diff(start))
    label = np.arange(len(tree))
    both = chosen[own] & chosen[other]
    while True:
        before = label.copy()
        np.minimum.at(label, own[both], label[other[both]])
        if (label == before).all():
            break
    assert (linked(tree.grid, chosen) == label).all()
    start, other = tree.neighbors("corners")
    own = np.repeat(np.arange(len(tree)), np.diff(start))
    low, high = tree.corners
    ends = chosen & ((low == tree.box[0]) | (high == tree.box[1])).any(axis=1)
    ends[own[chosen[own] & ~chosen[other]]] = True
    assert (leaves_at_ends(tree.grid, chosen) == ends).all()


def test_one_level_is_hexahedra_only() -> None:
    tree = octree([[0, 0, 0], [1, 1, 1]], 0.25)
    assert (_kinds(tree, np.ones(len(tree), dtype=bool), bare=True) == WHOLE).all()
    mesh = tree.mesh("hexahedra")
    assert list(mesh.cells) == ["hexahedron"]
    assert mesh.size == 64
    assert (mesh.quality("scaled_jacobian") == 1).all()


def test_one_leaf() -> None:
    mesh = octree([[0, 0, 0], [1, 1, 1]]).mesh("hex-dominant")
    assert mesh.size == 1
    assert check(mesh)
