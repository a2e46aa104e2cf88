"""Whole runs: everything ends, and is valid, whatever the body."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, HiddenVertexWarning, Layers, UnstructError, check, prismatic_layers
from unstruct.generate.prisms.run import PrismOptions, PrismRun
from unstruct.generate.prisms.walls import base_of

LAYERS = Layers(thickness=0.4, growth=1.2, count=6)


def voxels(filled: np.ndarray) -> tuple[np.ndarray, list[list[int]]]:
    """The surface of unit cubes, as squares."""
    number: dict[tuple[int, ...], int] = {}
    sides = []
    solid = np.pad(filled, 1)
    for cell in zip(*np.nonzero(solid)):
        for axis, end in product(range(3), (0, 1)):
            beside = list(cell)
            beside[axis] += 2 * end - 1
            if solid[tuple(beside)]:
                continue
            corners = []
            for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = list(cell)
                corner[axis] += end
                corner[(axis + 1) % 3] += i
                corner[(axis + 2) % 3] += j
                corners.append(number.setdefault(tuple(map(int, corner)), len(number)))
            sides.append(corners if end else corners[::-1])
    return np.array(list(number), dtype=float), sides


def notch(width: float, n: int = 8) -> Domain:
    """A block with a notch in the shape of a V, that may be as narrow as one likes."""
    x = [0.0, 1 - width, 1.0, 1 + width, 2.0]
    low = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (x[3], 1.0), (1.0, 0.2), (x[1], 1.0), (0.0, 1.0)]
    flat = Domain.polygon(low)
    return Domain.extruded(flat, 1.0)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(["inside", "outside"]), st.sampled_from([0.1, 0.4, 3.0]))
@pytest.mark.filterwarnings("ignore::unstruct.HiddenVertexWarning")
def test_bodies_of_cubes(seed: int, side: str, thickness: float) -> None:
    """Integer coordinates, coplanar faces, concave corners, vertices that see nothing; or a named refusal."""
    rng = np.random.default_rng(seed)
    points, sides = voxels(rng.random((3, 3, 2)) < 0.55)
    if not len(points):
        return
    try:
        mesh = prismatic_layers(
            Domain(points, sides), layers=Layers(thickness=thickness, growth=1.2, count=4), side=side
        )
    except UnstructError as error:
        assert any(word in str(error) for word in ("touch at point", "more than two facets", "no layer"))
        return
    assert check(mesh)
    height, wanted = mesh.steps["height"], mesh.steps["wanted"]
    full = mesh.steps["reason"] == "full"
    assert (height[full] == wanted[full]).all() and (height[~full] < wanted[~full]).all()


@settings(max_examples=20, deadline=None)
@given(
    st.integers(0, 10**6), st.sampled_from([0.05, 0.2, 0.4]), st.sampled_from(["visible", "angle", "staged"])
)
@pytest.mark.filterwarnings("ignore::unstruct.HiddenVertexWarning")
def test_rough_balls(seed: int, rough: float, normals: str) -> None:
    rng = np.random.default_rng(seed)
    shell = Domain.ball(size=0.7).triangulated
    points = shell.points * (1 + rough * rng.standard_normal((len(shell.points), 1)))
    try:
        domain = Domain(points, shell.triangles)
    except UnstructError:
        return
    for side in ("inside", "outside"):
        assert check(prismatic_layers(domain, layers=LAYERS, side=side, normals=normals))


@pytest.mark.parametrize("width", [0.5, 1e-2, 1e-5, 1e-9])
def test_narrow_notches(width: float) -> None:
    for side in ("inside", "outside"):
        mesh = prismatic_layers(notch(width), layers=LAYERS, side=side)
        assert check(mesh)
        # The lowest end of the narrowest one sees its sides under an angle that rounding loses.
        assert (mesh.counts["collapsed"] > 0) == (width == 1e-9) and mesh.counts["rounds"] < 20
    limited = mesh.counts["limited: column"] + mesh.counts["limited: crossing"]
    assert (limited > 0) == (width < 0.5)


@pytest.mark.parametrize("unit", [2.0**-250, 1e-30, 1e30, 2.0**250])
def test_huge_and_small_units(unit: float) -> None:
    body = notch(0.1)
    mesh = prismatic_layers(body, layers=LAYERS)
    other = prismatic_layers(
        Domain(body.points * unit, body.facets), layers=Layers(thickness=0.4 * unit, growth=1.2, count=6)
    )
    assert check(other) and (other.cells["wedge"] == mesh.cells["wedge"]).all()
    if np.frexp(unit)[0] == 0.5:  # a power of two changes nothing
        assert (other.points == mesh.points * unit).all()


@pytest.mark.parametrize("first", [1e-3, 1e-7, 1e-9])
def test_far_from_the_origin(first: float) -> None:
    """At 10^7 a double is good to 2e-9: places are rounded, and the rounded wedges are what is tested."""
    shell = Domain.ball(size=0.5).triangulated
    try:
        mesh = prismatic_layers(
            Domain(shell.points + 1e7, shell.triangles), layers=Layers(first=first, growth=1.2, count=6)
        )
    except UnstructError as error:
        assert first == 1e-9 and "no layer" in str(error)
        return
    assert check(mesh)


def hidden_vertex() -> Domain:
    """Four cubes in a row that winds around a point: its six squares look to all sides."""
    return Domain(*voxels(np.array([27 >> i & 1 for i in range(8)]).reshape(2, 2, 2) > 0))


def test_hidden_vertices_are_told() -> None:
    body = hidden_vertex()
    with pytest.warns(HiddenVertexWarning, match=r"1 vertex .* point \d+ at \(2, 2, 2\)"):
        mesh = prismatic_layers(body, layers=LAYERS)
    hidden = np.flatnonzero(mesh.steps["reason"] == "hidden")
    assert mesh.counts["hidden"] == len(hidden) == 1
    assert mesh.steps["place"][hidden[0]].tolist() == [2, 2, 2]
    assert mesh.steps["height"][hidden[0]] == 0.0 and mesh.steps["level"][hidden[0]] == 0
    assert check(mesh) and mesh.complete and mesh.counts["collapsed"] > 0


def test_a_run_is_the_same_twice_and_ends() -> None:
    rng = np.random.default_rng(2)
    shell = Domain.ball(size=0.5).triangulated
    noisy = Domain(shell.points * (1 + 0.15 * rng.standard_normal((len(shell.points), 1))), shell.triangles)
    base = base_of(noisy, None, "outside")
    runs = [PrismRun(base, LAYERS, PrismOptions(smoothing=5)) for _ in range(2)]
    for run in runs:
        run.advance()
    assert (runs[0].places == runs[1].places).all() and runs[0].rounds == runs[1].rounds < 60
    rays = runs[0].rays
    assert (rays.height <= rays.wanted).all() and ((rays.level == 0) == (rays.height == 0)).all()
    assert np.abs((rays.direction**2).sum(axis=1) - 1)[rays.level > 0].max() < 1e-14


def test_layers_by_place_and_by_vertex() -> None:
    ball = Domain.ball(size=0.5)
    by_place = Layers(
        first=lambda x: 0.01 + 0.02 * (1 + x[:, 2]), growth=lambda x: 1.2 + 0.1 * x[:, 0], count=8
    )
    mesh = prismatic_layers(ball, layers=by_place)
    assert check(mesh)
    low, high = mesh.steps["wanted"].min(), mesh.steps["wanted"].max()
    assert high > 3 * low
    first = 0.01 + 0.02 * (1 + ball.points[:, 2])
    growth = 1.2 + 0.1 * ball.points[:, 0]
    same = prismatic_layers(ball, layers=Layers(first=first, growth=growth, count=8))
    assert (same.points == mesh.points).all()
    for stretching in ("tanh", "exponential", lambda s: s * s + s):
        some = {"first": 0.01} if not callable(stretching) else {}
        layers = Layers(**some, count=6, thickness=0.2, function=stretching)
        mesh = prismatic_layers(ball, layers=layers)
        assert check(mesh)
        height = mesh.points[mesh.steps["vertex"][0] :: len(ball.points)] - mesh.steps["place"][0]
        assert np.sqrt((height**2).sum(axis=1)) == pytest.approx(layers.cumulative(), abs=1e-12)
