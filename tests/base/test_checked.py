"""Dictionaries whose entries are checked whenever they are put in; what users hang on meshes and domains."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from unstruct import Domain, InputError, Mesh, UnstructError, check, constrained_delaunay, join
from unstruct.base.checked import CheckedDict

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1.0]]
WRONG = {
    "far": [[0, 99]], "negative": [[-5, 0]], "no rows": 5, "none": None, "text": "x", "reals": [[0.5, 1]],
    "ragged": [[0, 1], [2]], "texts": np.array([["a"]]), "too long": np.arange(99), "dict": {},
    "deep": np.zeros((2, 2, 2)), "beyond 32 bits": [[0, 2**40]], "objects": [None, None],
    "dates": np.full(2, np.datetime64(0, "s")), "complex": [1j, 2j], "no vertices": np.empty((3, 0), int),
    "masked": np.ma.masked_array([1, 2], [True, False]),
}  # fmt: skip
TETRAHEDRA = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]
CELLS: dict[str, tuple[Any, dict[str, Any]]] = {
    "triangles": (SQUARE, {"triangle": [[0, 1, 2], [0, 2, 3]]}),
    "surface": ([[*p, p[0]] for p in SQUARE], {"triangle": [[0, 1, 2], [0, 2, 3]]}),
    "mixed": ([*SQUARE, [2, 0]], {"quad": [[0, 1, 2, 3]], "triangle": [[1, 4, 2]]}),
    "tetrahedra": (TETRAHEDRA, {"tetra": [[0, 1, 2, 3], [1, 2, 3, 4]]}),
}


@pytest.mark.parametrize("what", WRONG)
@pytest.mark.parametrize("kind", CELLS)
def test_wrong_markers_of_meshes(kind: str, what: str) -> None:
    """They are refused where they come in: in the constructor, and when they are put in afterwards."""
    points, cells = CELLS[kind]
    with pytest.raises(InputError, match=r"markers\['w'\]"):
        Mesh(points, cells=cells, markers={"w": WRONG[what]})
    mesh = Mesh(points, cells=cells)
    for put in (
        lambda: mesh.markers.__setitem__("w", WRONG[what]),
        lambda: mesh.markers.update(w=WRONG[what]),
        lambda: mesh.markers.setdefault("w", WRONG[what]),
        lambda: mesh.markers.__ior__({"ok": [[0, 1]], "w": WRONG[what]}),
    ):
        with pytest.raises(InputError, match=r"markers\['w'\]"):
            put()
    assert not mesh.markers


@pytest.mark.parametrize("what", ["far", "negative", "no rows", "none", "text", "ragged", "deep", "dict"])
@pytest.mark.parametrize("make", [Domain.rectangle, Domain.box])
def test_wrong_markers_of_domains(make: Callable[[], Domain], what: str) -> None:
    domain = make()
    # a seed may be anywhere in space, until the domain is meshed
    for names in (domain.markers,) if what in ("far", "negative") else (domain.markers, domain.regions):
        before = dict(names)
        with pytest.raises(InputError, match=r"(markers|regions)\['w'\]"):
            names["w"] = WRONG[what]
        assert dict(names) == before
    with pytest.raises(InputError, match=r"outside 0\.\.(3|5)"):
        domain.markers["w"] = [99]


@pytest.mark.parametrize("name", [None, ("a", 1), 2.5, True, b"a", "half \ud800"])
def test_names_are_texts(name: Any) -> None:
    points, cells = CELLS["triangles"]
    for wrong in (
        lambda: Mesh(points, cells=cells, markers={name: [0, 1]}),
        lambda: Mesh(points, cells=cells, markers={"region": [0, 1]}, regions={name: 0}),
        lambda: Domain(SQUARE, [[0, 1], [1, 2], [2, 3], [3, 0]], markers={name: [0]}),
        lambda: Domain.rectangle().regions.__setitem__(name, (0.5, 0.5)),
    ):
        with pytest.raises(InputError, match="has the name"):
            wrong()


def test_numbers_become_texts() -> None:
    points, cells = CELLS["triangles"]
    mesh = Mesh(points, cells=cells, markers={3: [[0, 1]], np.int64(4): [1, 2]})
    assert list(mesh.markers) == ["3", "4"]
    with pytest.raises(InputError, match="'3' twice"):
        Mesh(points, cells=cells, markers={3: [[0, 1]], "3": [[1, 2]]})


def test_what_is_put_in_is_kept_and_written(tmp_path: Any) -> None:
    mesh = constrained_delaunay(Domain.rectangle())
    mesh.markers["wall"] = [[0, 1]]
    mesh.markers |= {"value": [0.5, 1.5]}
    mesh.regions["left"] = int(mesh.markers["region"][0])
    with pytest.raises(InputError, match="'left' and 'right' have the same number"):
        mesh.regions["right"] = mesh.regions["left"]
    assert mesh.markers["wall"].dtype == np.int32 and not mesh.markers["value"].flags.writeable
    mesh.write(tmp_path / "a.vtu")
    again = Mesh.read(tmp_path / "a.vtu")
    assert again.markers["wall"].tolist() == [[0, 1]] and again.regions == {"left": 0}
    assert check(mesh) and join(mesh).markers["value"].tolist() == [0.5, 1.5]


def test_copies_check_too() -> None:
    mesh, domain = constrained_delaunay(Domain.rectangle()), Domain.box()
    for some in (copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))):
        for names in (some(mesh).markers, some(domain).markers, some(mesh.markers), some(domain.regions)):
            assert isinstance(names, CheckedDict)
            with pytest.raises(UnstructError):
                names["w"] = [[0, 99]]
    assert isinstance(mesh.markers.copy(), CheckedDict) and type(mesh.markers | {}) is dict


@pytest.mark.parametrize(
    ("argument", "value"),
    [
        ("origin", [0, 1, 2, 2**40]),
        ("origin", [[0], [1, 2]]),
        ("duplicates", [[0, 2**33]]),
        ("neighbors", [[-1, 1, 5], [-1, -1, 0]]),
        ("neighbors", [[-1, 1, -2], [-1, -1, 0]]),
        ("hidden", [2**32]),
    ],
)
def test_wrong_numbers(argument: str, value: Any) -> None:
    with pytest.raises(InputError, match=argument):
        Mesh(SQUARE, [[0, 1, 2], [0, 2, 3]], **{argument: value})


def test_numbers_of_regions(tmp_path: Any) -> None:
    """Those beyond 53 bits went through reals on the way to a file; beyond 64 bits there are none."""
    large = 2**62 + 1
    mesh = Mesh(SQUARE, [[0, 1, 2], [0, 2, 3]], markers={"region": [large, large + 1]})
    mesh.write(tmp_path / "a.msh")
    assert Mesh.read(tmp_path / "a.msh").markers["region"].tolist() == [large, large + 1]
    with pytest.raises(InputError, match=r"markers\['region'\]\[1\] = 9223372036854775808 is beyond"):
        Mesh(SQUARE, [[0, 1, 2], [0, 2, 3]], markers={"region": np.array([0, 2**63], np.uint64)})
