"""Airfoils from coordinate files: both orders, sharp and open tails, splines and polygons."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

from unstruct import Domain, InputError
from unstruct.domain.plane.sections import read_section, section_parts


def skin(digits: str, n: int, closed: bool) -> tuple[np.ndarray, np.ndarray]:
    """The upper and the lower side of a section, from the tail to the nose and back."""
    curves = Domain.naca(digits, closed=closed).curves
    t = np.linspace(0, 1, n)
    return np.round(curves[0].point(t), 7) + 0.0, np.round(curves[1].point(t), 7) + 0.0  # as in files


def written(path: Path, rows: np.ndarray, head: str = "NACA\n") -> Path:
    path.write_text(head + "".join(f"  {x!r} {y!r}\r\n" for x, y in rows.tolist()))
    return path


@pytest.mark.parametrize("digits", ["0012", "2412", "6409"])
@pytest.mark.parametrize("closed", [True, False])
def test_the_spline_is_near_the_true_section(tmp_path: Path, digits: str, closed: bool) -> None:
    upper, lower = skin(digits, 50, closed)
    path = written(tmp_path / "A.DAT", np.concatenate([upper, lower[1:]]), "\ufeffNACA, größer\n\n")
    true, found = Domain.naca(digits, closed=closed), Domain.read(path)
    assert set(found.markers) == set(true.markers) and len(found.points) == len(true.points)
    assert found.area == pytest.approx(true.area, rel=1e-4)
    t = np.linspace(0, 1, 400)
    near = np.concatenate([curve.point(t) for curve in found.curves.values()])
    far = np.concatenate([curve.point(np.linspace(0, 1, 4000)) for curve in true.curves.values()])
    gaps = np.hypot(*(near[:, None] - far[None]).transpose(2, 0, 1)).min(axis=1)
    assert gaps.max() < 1e-3
    polygon = Domain.read(path, shape="polygon")
    assert len(polygon.points) == len(upper) + len(lower) - (2 if closed else 1) and not polygon.curves
    counts = [len(polygon.markers[name]) for name in ("upper", "lower")]
    assert (
        sum(counts) == 98 and abs(counts[0] - counts[1]) <= 4
    )  # the nose is the point farthest from the tail


def test_the_spline_goes_through_all_points_and_is_smooth_there(tmp_path: Path) -> None:
    upper, lower = skin("2412", 30, True)
    rows = np.concatenate([upper, lower[1:]])
    parts = section_parts(rows, "spline")
    knots = parts["curves"][0].function.args[0]
    spline = parts["curves"][0].function
    assert np.array_equal(spline(knots), rows)
    step = 1e-5
    for order in (1, 2):  # differences on both sides of each inner point
        ahead, behind = (
            sum(c * spline(knots[1:-1] + way * i * step) for i, c in enumerate(weights))
            / (way * step) ** order
            for way in (1, -1)
            for weights in [[(-1.5, 2, -0.5), (2, -5, 4, -1)][order - 1]]
        )
        assert np.abs(ahead - behind).max() < 1e-3 * max(np.abs(ahead).max(), 1)
    assert np.array_equal(
        pickle.loads(pickle.dumps(parts["curves"][1])).point(np.array([0.3])),
        parts["curves"][1].point(np.array([0.3])),
    )


def test_lednicer_is_recognized(tmp_path: Path) -> None:
    upper, lower = skin("2412", 20, True)
    selig = written(tmp_path / "s.dat", np.concatenate([upper, lower[1:]]))
    sides = np.concatenate([upper[::-1], lower])
    lednicer = written(tmp_path / "l.dat", sides, "NACA\n 20. 20.\n\n")
    assert np.array_equal(read_section(selig)[0], read_section(lednicer)[0])
    assert read_section(selig)[1] == "NACA"
    with pytest.raises(InputError, match=r"announces 20 \+ 19 points \(Lednicer's order\), but has 40"):
        Domain.read(written(tmp_path / "l.dat", sides, "NACA\n 20. 19.\n\n"))


def test_the_other_way_around_upper_stays_upper(tmp_path: Path) -> None:
    upper, lower = skin("2412", 20, False)
    rows = np.concatenate([upper, lower[1:]])
    for shape in ("spline", "polygon"):
        one, other = section_parts(rows, shape), section_parts(rows[::-1], shape)
        k = {name: len(pieces) for name, pieces in one["markers"].items()}
        assert k == {name: len(pieces) for name, pieces in other["markers"].items()}
        assert one["markers"]["upper"][0] == 0 and other["markers"]["lower"][0] == 0


def test_repeated_points_are_one(tmp_path: Path) -> None:
    rows = [[1, 0], [1, 0], [0.5, 0.1], [0, 0], [0, 0], [0.5, -0.1], [1, 0]]
    path = written(tmp_path / "a.dat", np.array(rows), "")
    assert len(Domain.read(path, shape="polygon").points) == 4
    assert Domain.read(path).area == pytest.approx(0.1, rel=0.5)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("name\n1 0\n0.5 1\nhello x\n", r"a\.dat, line 4: 'hello x' is no point 'x y' of an airfoil"),
        ("name\n1 0\n0.5 1 3\n", r"a\.dat, line 3"),
        ("name\n1 0\n0 0\n1 0\n", r"a\.dat has 3 different points: a section needs four"),
        ("", r"a\.dat has 0 different points"),
        ("name\n0 0\n1 0\n1 1\n0.1 0.1\n0.2 0.9\n", "lead from the trailing edge|cross|touch|meet"),
    ],
)
def test_faults_are_named_by_their_line(tmp_path: Path, text: str, told: str) -> None:
    (tmp_path / "a.dat").write_text(text)
    with pytest.raises(InputError, match=told):
        Domain.read(tmp_path / "a.dat")
    with pytest.raises(InputError, match="shape = 'circle' must be 'spline' or 'polygon'"):
        section_parts(np.eye(2), "circle")
