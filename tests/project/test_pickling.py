"""Domains, meshes and sizes go through a pickle, as to another process, and are the same there."""

from __future__ import annotations

import copy
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np
import pytest
from regions import KINDS, random_region

from unstruct import Arc, Domain, Mesh, check, delaunay, refine, sizing, voronoi
from unstruct.examples import regions as example_regions

PLACES = np.random.default_rng(7).random((30, 2))
TWO = np.array([[0.2, 0.3], [0.8, 0.6]])
MESH = delaunay(PLACES)

DOMAINS = {
    "airfoil": lambda: Domain.naca("2412", closed=False, attack=5),
    "spline": lambda: Domain.smooth([[0, 0], [2, 0], [2, 1], [0, 1]], [[[0.5, 0.3], [1, 0.3], [1, 0.6]]]),
    "disc": Domain.disc,
    "plate": example_regions.plate,
    "running": example_regions.running_domain,
}


def again(value: Any) -> Any:
    return pickle.loads(pickle.dumps(value))


def assert_equal(one: Any, other: Any) -> None:
    """All arrays of two objects, and that they stay read-only."""
    for name, value in vars(one).items():
        if isinstance(value, np.ndarray):
            found = getattr(other, name)
            assert np.array_equal(value, found) and found.flags.writeable == value.flags.writeable, name


@pytest.mark.parametrize("name", DOMAINS)
def test_domains_and_their_meshes(name: str) -> None:
    domain = DOMAINS[name]()
    other = again(domain)
    assert_equal(domain, other)
    assert {k: v.tolist() for k, v in domain.markers.items()} == {
        k: v.tolist() for k, v in other.markers.items()
    }
    t = np.linspace(0, 1, 9)
    assert all(np.array_equal(domain.at(i, t), other.at(i, t)) for i in range(len(domain.pieces)))
    mesh = refine(other, 0.5)
    _ = mesh.edges, mesh.volumes, mesh.find_simplex(mesh.points[:1])  # what is kept goes along
    for found in (again(mesh), copy.deepcopy(mesh)):
        assert type(found) is type(mesh) and found.counts == mesh.counts and found.complete == mesh.complete
        assert_equal(mesh, found)
        assert not any(rows.flags.writeable for rows in [*found.markers.values(), *found.cells.values()])
        assert check(found, domain=domain)
        assert (found.find_simplex(PLACES) == mesh.find_simplex(PLACES)).all()


@pytest.mark.parametrize("kind", sorted(set(KINDS) - {"curves"}))  # which are local functions of the tests
def test_random_domains(kind: str) -> None:
    domain = random_region(5, kind)
    assert_equal(domain, again(domain))


def test_a_mesh_of_several_kinds_of_cells() -> None:
    cells = {"quad": [[0, 1, 2, 3]], "triangle": [[1, 4, 2]]}
    mesh = Mesh([[0, 0], [1, 0], [1, 1], [0, 1], [2, 0]], cells=cells, markers={"end": [[4]]})
    found = again(mesh)
    assert found.face_counts() == mesh.face_counts() and found.markers["end"].tolist() == [[4]]


def own(x: np.ndarray) -> np.ndarray:
    return 0.1 + x[:, 0] ** 2


SIZES = {
    "constant": sizing.as_size(0.3),
    "function": sizing.as_size(own),
    "points": sizing.points(TWO, 0.1),
    "lines": sizing.lines(TWO, 0.1, far=0.2),
    "polygons": sizing.polygons([[0.2, 0.2], [0.7, 0.3], [0.4, 0.8]], 0.05),
    "minimum": sizing.minimum(0.3, sizing.points(TWO, 0.1), own),
    "maximum": sizing.maximum(0.3, own),
    "product": sizing.product(0.5, own),
    "clip": sizing.clip(own, 0.2, 0.4),
    "limited": sizing.limited(own, 0.3, [0, 0], [1, 1], tolerance=0.1),
    "features": sizing.from_features(Domain.rectangle(), 0.5, far=0.2),
    "curvature": sizing.from_curvature(Domain.disc(), far=1.0),
    "background": sizing.background(MESH, own(PLACES)),
}


@pytest.mark.parametrize("name", SIZES)
def test_sizes(name: str) -> None:
    field = SIZES[name]
    found = again(field)
    assert repr(found) == repr(field) and found.constant == field.constant
    inside = (PLACES[MESH.simplices]).mean(axis=1)
    assert np.array_equal(found(inside), field(inside))
    table, other = (f.table([0, 0], [1, 1], max_nodes=2000) for f in (field, again(field)))
    assert np.array_equal(table(inside), other(inside)) and np.array_equal(
        again(table)(inside), table(inside)
    )


def job(task: tuple[Domain, sizing.SizeField]) -> Mesh:
    return refine(*task)


def test_another_process() -> None:
    """Not a forked one: all must go through the pickle."""
    task = Domain.naca("0012"), sizing.points([[0.0, 0.0]], 0.05)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        found = next(iter(pool.map(job, [task])))
    here = refine(*task)
    assert np.array_equal(found.points, here.points) and np.array_equal(found.simplices, here.simplices)


def test_arcs() -> None:
    arc = Arc.through([0, 0], [1, 1], [2, 0])
    assert np.array_equal(again(arc).point(np.array([0.3])), arc.point(np.array([0.3])))


def test_a_diagram_keeps_the_points_of_its_mesh() -> None:
    diagram = voronoi(np.random.default_rng(0).random((20, 2)))
    for found in (again(diagram), copy.deepcopy(diagram)):
        assert found.points is found.mesh.points and found.duplicates is found.mesh.duplicates
        assert not found.points.flags.writeable and np.array_equal(found.points, diagram.points)
        assert np.array_equal(found.areas(), diagram.areas())
