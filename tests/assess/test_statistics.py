"""Figures of a mesh: against formulas written out here, and on meshes whose figures are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from mixed_cells import planar, spatial

from unstruct import InputError, Mesh, MeshError, delaunay
from unstruct.assess.statistics import angle_histogram, compare, statistics

SQUARE = Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]])


def test_a_square_cut_in_two() -> None:
    found = statistics(SQUARE, 1.0)
    assert (found.vertices, found.cells) == (4, 2)
    assert found.min_angle == found.low_angle == pytest.approx(45.0)
    assert found.least_angle == found.min_angle and found.greatest_angle == found.max_angle
    assert found.max_angle == pytest.approx(90.0)
    assert found.mean_round == pytest.approx(2 * (math.sqrt(2) - 1))
    assert (found.short, found.median) == (1.0, 1.0) and found.long == pytest.approx(math.sqrt(2))
    # the diagonal is sqrt(2) times the size, up to rounding: ask a little less
    assert statistics(SQUARE, 1.01).conforming == 1.0
    assert statistics(SQUARE, 0.99).conforming == pytest.approx(0.8)


def test_against_the_law_of_cosines() -> None:
    mesh = delaunay(np.random.default_rng(0).random((300, 2)))
    found = statistics(mesh, lambda x: 0.02 + 0.1 * x[:, 0])
    every, round_ = [], []
    for a, b, c in mesh.points[mesh.simplices].tolist():
        sides = [math.dist(b, c), math.dist(c, a), math.dist(a, b)]
        for k in range(3):
            p, q, r = sides[k], sides[k - 1], sides[k - 2]
            every.append(math.degrees(math.acos((q * q + r * r - p * p) / (2 * q * r))))
        p, q, r = sides
        round_.append((q + r - p) * (r + p - q) * (p + q - r) / (p * q * r))
    assert found.min_angle == pytest.approx(min(every), rel=1e-6)
    assert found.max_angle == pytest.approx(max(every), rel=1e-6)
    assert found.mean_round == pytest.approx(sum(round_) / len(round_))
    counts, edges = angle_histogram(mesh, 18)
    assert counts.sum() == 3 * mesh.size and len(edges) == 19
    np.testing.assert_array_equal(counts, np.histogram(every, 18, (0, 180))[0])
    good = 0
    for i, j in mesh.edges.tolist():
        p, q = mesh.points[i], mesh.points[j]
        quotient = math.dist(p, q) / (0.02 + 0.05 * (p[0] + q[0]))
        good += 1 / math.sqrt(2) <= quotient <= math.sqrt(2)
    assert found.conforming == pytest.approx(good / len(mesh.edges))


def test_without_a_size_its_figures_are_left_out() -> None:
    found = statistics(SQUARE)
    assert math.isnan(found.conforming) and "size" not in str(found)
    assert "45.0°" in str(found)


def test_side_by_side() -> None:
    text = compare({"one": SQUARE, "two": delaunay([[0, 0], [1, 0], [0.5, math.sqrt(3) / 2]])}, 1.01)
    head, _, *lines = text.splitlines()
    assert head == "| | one | two |"
    assert "| minimum angle | 45.0° | 60.0° |" in lines
    assert "| edges within √2 of the size | 100.0% | 100.0% |" in lines


def test_tetrahedra_and_mixtures() -> None:
    mesh = delaunay(np.random.default_rng(0).random((20, 3)))
    found = statistics(mesh)
    assert found.kinds == {"tetra": mesh.size} and found.cells == mesh.size
    assert found.mean_round == pytest.approx(mesh.quality("2r/R").mean())
    assert found.least_scaled == mesh.quality("scaled_jacobian").min() > 0
    assert ("tetrahedra", str(mesh.size)) in found.rows()
    for mixed in (planar(4, jitter=0.2), spatial(2, jitter=0.1)):
        found = statistics(mixed, 1.0)
        assert found.kinds == {kind: len(block) for kind, block in mixed.cells.items()}
        assert found.cells == mixed.size and math.isnan(found.mean_round)
        assert found.mean_scaled == pytest.approx(mixed.quality("scaled_jacobian").mean())
        assert found.min_angle == mixed.quality("min_angle").min()
        ends = mixed.points[mixed.edges]
        assert found.long == pytest.approx(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).max())
        assert "2r/R" not in str(found) and "mean scaled Jacobian" in str(found)
    squares = Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], cells={"quad": [[0, 1, 2, 3]]})
    text = compare({"flat": SQUARE, "square": squares, "solid": spatial(2)})
    lines = text.splitlines()
    assert "| quads |  | 1 |  |" in lines and "| triangles | 2 |  |  |" in lines
    assert "| minimum angle | 45.0° | 90.0° |" in text and "| minimum scaled Jacobian |  | 1.000 |" in text
    assert all(line.count("|") == 5 for line in lines)


def test_other_meshes_are_refused() -> None:
    with pytest.raises(MeshError, match="triangle"):
        statistics(delaunay([[0.0], [1.0]]))
    with pytest.raises(MeshError, match="this is None"):
        statistics(None)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="meshes must be a dict"):
        compare([SQUARE])  # type: ignore[arg-type]
    with pytest.raises(MeshError, match="triangle meshes"):
        angle_histogram(spatial(2))


def test_dihedral_angles_of_tetrahedra() -> None:
    found = statistics(Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]]))
    assert (
        found.min_dihedral == found.low_dihedral == pytest.approx(math.degrees(math.acos(1 / math.sqrt(3))))
    )
    assert found.max_dihedral == pytest.approx(90.0)
    assert "mean 3r/R" in str(found) and "minimum dihedral angle" in str(found)
    assert np.isnan(statistics(SQUARE).min_dihedral) and "dihedral" not in str(statistics(SQUARE))
