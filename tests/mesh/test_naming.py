"""Names of regions: given to a mesh, kept by every method, and in files."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import unstruct
from unstruct import Domain, Mesh, check, constrained_delaunay, refine
from unstruct.base.errors import InputError
from unstruct.studies import recover_edges, remove_outside

NAMES = {"steel": 0, "air": 1}


def domain() -> Domain:
    """A plate [0, 2] x [0, 1] of two halves with names, and a third part without one."""
    points = [[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [1, 1], [1.5, 0], [1.5, 1]]
    sides = [[0, 4], [4, 6], [6, 1], [1, 2], [2, 7], [7, 5], [5, 3], [3, 0]]
    regions = {"steel": [0.5, 0.5], "air": [1.2, 0.5]}
    return Domain(points, sides, inner=[[4, 5], [6, 7]], regions=regions, markers={"left": [7]})


METHODS: dict[str, Callable[[Domain], Any]] = {
    "constrained": constrained_delaunay,
    "hull": lambda d: constrained_delaunay(d, hull=True),
    "conforming": unstruct.conforming_delaunay,
    "refine": lambda d: refine(d, 0.2),
    "circumcenters": lambda d: unstruct.circumcenter_insertion(d, 0.2),
    "voronoi segment": lambda d: unstruct.voronoi_segment(d, 0.2),
    "front": lambda d: unstruct.advancing_front(d, 0.2),
    "raw front": lambda d: unstruct.advancing_front(d, 0.2, finish=False),
    "refine a mesh": lambda d: refine(constrained_delaunay(d), max_area=0.02),
    "smooth": lambda d: unstruct.smooth(refine(d, 0.2)),
    "swap": lambda d: unstruct.swap_diagonals(refine(d, 0.2)),
    "insert": lambda d: unstruct.insert(refine(d, 0.2), [0.33, 0.44]),
    "oriented": lambda d: refine(d, 0.2).oriented(),
    "select": lambda d: refine(d, 0.2).select(slice_of(refine(d, 0.2))),
    "pickle": lambda d: pickle.loads(pickle.dumps(refine(d, 0.2))),
    "copy": lambda d: copy.deepcopy(refine(d, 0.2)),
    "remove outside": lambda d: remove_outside(constrained_delaunay(d, hull=True), d),
}


def slice_of(mesh: Mesh) -> np.ndarray:
    return np.arange(mesh.size)


@pytest.mark.parametrize("name", METHODS)
def test_methods_keep_names(name: str) -> None:
    plate = domain()
    mesh = METHODS[name](plate)
    assert mesh.regions == NAMES
    parts = {"steel": (0.0, 1.0), "air": (1.0, 1.5)}
    for region, (left, right) in parts.items():
        cells = mesh.markers["region"] == mesh.regions[region]
        x = mesh.points[mesh.simplices[cells], 0]
        assert (
            x.min() == left and x.max() == right and mesh.volumes[cells].sum() == pytest.approx(right - left)
        )
    assert check(mesh)


def test_limits_by_name_and_by_number() -> None:
    mesh = constrained_delaunay(domain())
    by_name, by_number = refine(mesh, max_area={"air": 1e-3}), refine(mesh, max_area={1: 1e-3, 2: 1.0})
    assert np.array_equal(by_name.points, by_number.points) and by_name.regions == NAMES
    air = by_name.markers["region"] == 1
    assert by_name.volumes[air].max() <= 1e-3 < by_name.volumes[~air].max()
    sized = refine(mesh, {"air": 0.05})
    assert sized.size > 2 * refine(mesh, {"air": 0.2}).size
    with pytest.raises(
        InputError, match=r"region 'wood', but the regions of the domain are \[2, 'air', 'steel'\]"
    ):
        refine(mesh, max_area={"wood": 1})
    with pytest.raises(InputError, match="region 'air' is named twice: by its name, and by its number 1"):
        refine(mesh, max_area={"air": 1, 1: 2})


def test_names_that_no_cell_or_marker_has() -> None:
    mesh = constrained_delaunay(domain())
    left = mesh.select(mesh.markers["region"] == 0)
    assert left.regions == NAMES
    assert unstruct.swap_diagonals(mesh, constrained=["facets", "inner"]).regions == {}
    assert recover_edges(mesh, [[0, 1]]).regions in ({}, NAMES)


@pytest.mark.parametrize(
    ("regions", "message"),
    [
        ({"a": 0.5}, r"regions\['a'\] must be a whole number, not 0.5"),
        ({"a": True}, "must be a whole number"),
        ({"a": 0, "b": 0}, "'a' and 'b' have the same number 0"),
        ([1], "must be a dict"),
    ],
)
def test_wrong_names(regions: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], markers={"region": [0]}, regions=regions)


def test_names_need_a_marker() -> None:
    with pytest.raises(InputError, match="does not have"):
        Mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], regions={"a": 0})


@pytest.mark.parametrize("suffix", ["vtu", "vtk", "msh"])
@pytest.mark.parametrize("values", [[0, 1, 1], [5, -2, 7], [3, 3, 0], [2**31 + 5, 0, 1]])
def test_numbers_and_names_come_back(tmp_path: Path, suffix: str, values: list[int]) -> None:
    """Numbers of any size, names of regions that are empty, and names like those of regions without one."""
    points = np.random.default_rng(1).random((9, 2))
    numbers = {"region 4": values[0], "two words": values[1], "none": 11}
    if len(set(numbers.values())) < 3:
        numbers = {"ä<b>": values[0], "none": 11}
    mesh = Mesh(points, np.arange(9).reshape(3, 3), markers={"region": values}, regions=numbers)
    mesh.write(tmp_path / f"mesh.{suffix}")
    again = Mesh.read(tmp_path / f"mesh.{suffix}")
    called = {number: name for name, number in again.regions.items()}
    assert set(again.regions) == set(numbers)
    if suffix != "msh" or 0 <= min(values) <= max(values) < 2**31 - 1:
        assert again.regions == numbers and again.markers["region"].tolist() == values
    for value, other in zip(values, again.markers["region"].tolist()):
        assert called.get(other) == {number: name for name, number in numbers.items()}.get(value)


def test_formats_without_names_say_so(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="not written: 'facets', 'inner', 'left', 'region'"):
        constrained_delaunay(domain()).write(tmp_path / "mesh.off")


def test_scikit_fem_and_meshio_know_the_names() -> None:
    mesh = refine(domain(), 0.3)
    fields = mesh.to_meshio().field_data
    assert {name: rows.tolist() for name, rows in fields.items()} == {"steel": [0, 2], "air": [1, 2]}
    pytest.importorskip("skfem")
    theirs = mesh.to_skfem()
    assert list(theirs.subdomains) == ["steel", "air", "region 2"] and "left" in theirs.boundaries
    for name, number in mesh.regions.items():
        assert (mesh.markers["region"][theirs.subdomains[name]] == number).all()
