"""Regions meshed in parts: valid, exact where parts meet, and the same whoever works on them."""

from __future__ import annotations

import pickle
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from functools import partial
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import unstruct
from unstruct import Domain, InputError, MeshError
from unstruct.examples.regions import plate, running_domain
from unstruct.generate.parallel.records import mesh_part


def _graded(finest, growth, x):
    return finest + growth * np.sqrt((x * x).sum(axis=1))


def _two_regions():
    points = [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1), (0.5, 0.5), (1.2, 0.2), (1.7, 0.9)]
    ring = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0)]
    return Domain(
        points, ring, inner=[(1, 4), (7, 8)], regions={"left": [(0.2, 0.2)], "right": [(1.5, 0.2)]},
        markers={"crack": [7], "side": [5], "border": [6]},
    )  # fmt: skip


REGIONS = {
    "square": (Domain.rectangle(), 0.05),
    "disc": (Domain.disc(), 0.08),
    "ring": (Domain.disc().with_holes(Domain.disc((0.1, 0), 0.4)), partial(_graded, 0.02, 0.1)),
    "airfoil": (
        Domain.rectangle((-1, -1), (2, 1)).with_holes(Domain.naca("2412")),
        partial(_graded, 0.02, 0.1),
    ),
    "regions": (_two_regions(), 0.05),
    "sizes of regions": (_two_regions(), {"left": 0.06, "right": 0.03}),
    "two squares": (Domain([(0, 0), (1, 0), (1, 1), (0, 1), (3, 0), (4, 0), (4, 1), (3, 1)],
                           [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]), 0.08),
    "plate": (plate(), 0.08),
    "running": (running_domain(), 0.07),
    "spaced": (Domain.rectangle().spaced({"left": 30, "top": 7}), 0.06),
}  # fmt: skip


def _area(points, cells):
    """The exact area of triangles."""
    total = Fraction(0)
    exact = [tuple(map(Fraction, row)) for row in points.tolist()]
    for a, b, c in cells.tolist():
        (ax, ay), (bx, by), (cx, cy) = exact[a], exact[b], exact[c]
        twice = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        assert twice > 0
        total += twice / 2
    return total


@pytest.mark.parametrize("name", REGIONS)
@pytest.mark.parametrize("parts", [2, 3, 6])
def test_valid(name, parts):
    domain, size = REGIONS[name]
    mesh = unstruct.mesh_parts(domain, size, parts)
    report = unstruct.check(mesh, domain=domain)
    assert report, report
    assert sorted(set(mesh.markers["part"].tolist())) == list(range(parts))
    assert mesh.counts["parts"] == parts
    assert set(mesh.markers) >= set(domain.markers)
    assert list(mesh.regions) == list(domain.regions)


@pytest.mark.parametrize("name", ["square", "ring", "regions", "plate"])
def test_parts_meet_in_equal_points(name):
    domain, size = REGIONS[name]
    found = unstruct.mesh_parts(domain, size, 5, join=False)
    places = [set(map(tuple, mesh.points.tolist())) for mesh in found.meshes]
    rims = [set(map(tuple, mesh.points[np.unique(mesh.boundary)].tolist())) for mesh in found.meshes]
    met = 0
    for i, j in combinations(range(5), 2):
        assert places[i] & places[j] == rims[i] & rims[j]
        met += len(rims[i] & rims[j])
    assert met
    mesh = found.join()
    assert len(mesh.points) == len(set().union(*places))
    assert _area(mesh.points, mesh.simplices) == sum(_area(m.points, m.simplices) for m in found.meshes)
    sides: dict[tuple[int, int], int] = {}
    for row in mesh.simplices.tolist():
        for a, b in combinations(sorted(row), 2):
            sides[a, b] = sides.get((a, b), 0) + 1
    once = {edge for edge, count in sides.items() if count == 1}
    assert max(sides.values()) == 2
    assert once == {tuple(sorted(edge)) for edge in mesh.markers["facets"].tolist()}


def test_one_part_is_the_method():
    domain = Domain.disc()
    one, whole = unstruct.mesh_parts(domain, 0.1, 1), unstruct.voronoi_segment(domain, 0.1)
    assert np.array_equal(one.points, whole.points) and np.array_equal(one.simplices, whole.simplices)
    assert not one.markers["part"].any()


def test_joined_in_one_part_without_joining_at_first():
    domain = Domain.disc()
    mesh = unstruct.mesh_parts(domain, 0.1, 1, join=False).join()
    assert unstruct.check(mesh, domain=domain)


def _equal(one, two):
    assert np.array_equal(one.points, two.points)
    assert np.array_equal(one.simplices, two.simplices)
    assert np.array_equal(one.segments, two.segments)
    for name, values in one.markers.items():
        assert np.array_equal(values, two.markers[name]), name


def test_threads_give_the_same_bits():
    domain, size = REGIONS["airfoil"]
    here = unstruct.mesh_parts(domain, size, 6)
    for workers in (1, 2, 3):
        with ThreadPoolExecutor(workers) as pool:
            _equal(here, unstruct.mesh_parts(domain, size, 6, map=pool.map))


def test_what_is_sent_suffices():
    def sent(work, parts):
        return [work(pickle.loads(pickle.dumps(part))) for part in reversed(parts)][::-1]

    domain, size = REGIONS["ring"]
    _equal(unstruct.mesh_parts(domain, size, 4), unstruct.mesh_parts(domain, size, 4, map=sent))


def test_a_size_that_cannot_be_sent():
    def sent(work, parts):
        return [work(pickle.loads(pickle.dumps(part))) for part in parts]

    with pytest.raises(InputError, match=r"cannot be sent .* not lambdas"):
        unstruct.mesh_parts(Domain.rectangle(), lambda x: np.full(len(x), 0.1), 2, map=sent)


def test_matched_sides_match_across_parts():
    domain = Domain.rectangle().matched("left", "right")
    mesh = unstruct.mesh_parts(domain, 0.05, 5)
    assert unstruct.check(mesh, domain=domain)
    one, two = mesh.points[mesh.pairs].transpose(1, 0, 2)
    assert len(one) == 21 and np.array_equal(one + np.array([1.0, 0.0]), two)


@pytest.mark.parametrize(
    "method", [unstruct.refine, unstruct.advancing_front, unstruct.circumcenter_insertion]
)
def test_other_methods(method):
    domain, size = REGIONS["regions"]
    mesh = unstruct.mesh_parts(domain, size, 4, method=method)
    assert unstruct.check(mesh, domain=domain)


@pytest.mark.parametrize("parts", [2, 5, 8, 16])
def test_balanced(parts):
    for name in ("square", "ring", "airfoil"):
        domain, size = REGIONS[name]
        fine = size / 3 if isinstance(size, float) else partial(_graded, 0.006, 0.03)
        assert unstruct.mesh_parts(domain, fine, parts).figures["largest part"] < 1.05


def test_corners_of_parts_are_not_sharp():
    """The bound that holds: the least coarse angle, here 25 degrees, or an angle of the region."""
    found = unstruct.mesh_parts(Domain.rectangle(), 0.02, 7, join=False)
    least = found.join().figures["least coarse angle"]
    assert least > 24.99
    for part in found.parts:
        after = {int(a): [] for a in part.facets.ravel()}
        for a, b in part.facets.tolist():
            after[a].append(b)
            after[b].append(a)
        for v, ends in after.items():
            for p, q in combinations(part.points[ends] - part.points[v], 2):
                cosine = (p * q).sum() / np.sqrt((p * p).sum() * (q * q).sum())
                assert np.degrees(np.arccos(np.clip(cosine, -1, 1))) >= least - 1e-6


@given(
    st.integers(3, 9),
    st.integers(0, 3),
    st.integers(2, 9),
    st.floats(0.02, 0.2),
    st.booleans(),
    st.integers(0, 2**32 - 1),
)
@settings(deadline=None, max_examples=25)
def test_any_region(corners, holes, parts, size, round_, seed):
    random = np.random.default_rng(seed)
    angle = np.sort(random.random(corners)) * 2 * np.pi
    if np.diff(np.append(angle, angle[0] + 2 * np.pi)).max() > 3.0 or np.diff(angle).min() < 0.05:
        angle = np.arange(corners) * 2 * np.pi / corners
    radius = random.uniform(0.8, 1.6, corners)
    ring = np.column_stack([np.cos(angle), np.sin(angle)]) * radius[:, None]
    places = np.array([(-0.15, -0.15), (0.15, -0.1), (0.0, 0.15)])[:holes]
    rings = [place + 0.07 * random.random((3, 2)) for place in places]
    try:
        domain = Domain.smooth(ring, rings) if round_ else Domain.polygon(ring, rings)
    except InputError:
        return  # the ring is no region
    try:
        mesh = unstruct.mesh_parts(domain, size, parts)
    except InputError as error:
        assert "too many" in str(error)
        return
    report = unstruct.check(mesh, domain=domain)
    assert report, report


def _broken(domain, size, **_):
    if domain.contains((0.9, 0.9)):
        raise ZeroDivisionError("on purpose")
    return unstruct.voronoi_segment(domain, size)


def test_an_error_names_the_part():
    with pytest.raises(
        MeshError, match=r"part \d of 3, from \(.*\) to \(1, 1\), .*ZeroDivisionError: on purpose"
    ):
        unstruct.mesh_parts(Domain.rectangle(), 0.1, 3, method=_broken)


def test_a_part_that_is_tried_again():
    failed = []

    def stubborn(work, parts):
        for part in parts:
            if part.number == 1 and not failed:
                failed.append(part)
            yield work(part)

    domain = Domain.rectangle()
    _equal(unstruct.mesh_parts(domain, 0.1, 3, map=stubborn), unstruct.mesh_parts(domain, 0.1, 3))
    assert np.array_equal(mesh_part(failed[0]).points, mesh_part(failed[0]).points)


def test_refused():
    square = Domain.rectangle()
    with pytest.raises(InputError, match=r"too many.*take at most \d+ parts"):
        unstruct.mesh_parts(square, 0.1, 1000)
    with pytest.raises(InputError, match="at least 1"):
        unstruct.mesh_parts(square, 0.1, 0)
    with pytest.raises(InputError, match="metric"):
        unstruct.mesh_parts(square, unstruct.sizing.directional((1, 0), 0.1, 0.2), 2)
    with pytest.raises(InputError, match="method must be a function"):
        unstruct.mesh_parts(square, 0.1, 2, method="front")
    found = unstruct.mesh_parts(square, 0.1, 2, join=False)
    with pytest.raises(InputError, match="gather"):
        found.join([1, 2])
    with pytest.raises(InputError, match="2 parts, but 1"):
        found.join(found.meshes[:1])
    with pytest.raises(InputError, match="pvtu"):
        found.write("parts.vtk")


def test_written_by_part(tmp_path):
    pytest.importorskip("meshio")
    domain, size = REGIONS["regions"]
    found = unstruct.mesh_parts(domain, size, 4, join=False)
    index, *files = found.write(tmp_path / "two.pvtu")
    assert [file.name for file in files] == [f"two_{k}.vtu" for k in range(4)]
    read = [unstruct.Mesh.read(file) for file in files]
    assert [mesh.size for mesh in read] == [mesh.size for mesh in found.meshes]
    assert all((mesh.markers["part"] == k).all() for k, mesh in enumerate(read))
    whole = found.join()
    numbers = np.concatenate([mesh.markers["region"] for mesh in read])
    assert np.array_equal(numbers, whole.markers["region"])
    pyvista = pytest.importorskip("pyvista")
    shown = pyvista.read(index)
    assert shown.n_cells == whole.size
    assert np.array_equal(np.asarray(shown.cell_data["part"]), whole.markers["part"])
