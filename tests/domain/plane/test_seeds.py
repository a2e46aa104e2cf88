"""Seeds on pieces and vertices are refused, in every format, by name; all others pick the right part."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from unstruct import Domain, check, constrained_delaunay
from unstruct.base.errors import InputError

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]
RING = [[0, 1], [1, 2], [2, 3], [3, 0]]


@pytest.mark.parametrize(
    ("seed", "place"),
    [
        ((2, 0), "facet 0"),
        ((4, 4), "point 2"),
        ((1, 2), "point 4"),
        ((1, 1), "inner segment 0"),
        ((0.1, 0.1), "inner segment 0"),
        ((-1, 2), "outside the region"),
    ],
)
def test_seeds_on_pieces(seed: tuple[float, float], place: str) -> None:
    """The second seed of the second region: it is named, and what it lies on."""
    regions = {"a": [[3, 1]], "b": [[1, 3], seed]}
    with pytest.raises(InputError, match=rf"regions\['b'\]\[1\] = \[{float(seed[0])}, .* lies (on )?{place}"):
        Domain([*SQUARE, (1, 2)], RING, inner=[[0, 2]], regions=regions)


def test_seeds_beside_pieces() -> None:
    """The next double is beside: exact signs decide, and the cells get the right numbers."""
    for above in (False, True):
        y = math.nextafter(1.0, 9 if above else -9)
        domain = Domain(SQUARE, RING, inner=[[0, 2]], regions={"a": [1, y]})
        mesh = constrained_delaunay(domain)
        inside = mesh.points[mesh.simplices].mean(axis=1)[mesh.markers["region"] == 0]
        assert ((inside[:, 1] > inside[:, 0]) == above).all() and check(mesh, domain=domain)


def test_seeds_on_curves() -> None:
    """A seed on a curve, up to rounding, is refused. One at a billionth of the size beside it is not."""
    makers: list[Any] = [
        lambda **o: Domain.naca("2412", **o),
        Domain.disc,
        lambda **o: Domain.smooth(SQUARE, **o),
    ]
    for make in makers:
        plain = make()
        middle = plain.bounds.mean(axis=0)
        for piece in plain.curves:
            for t in (0.1, 0.37, 0.5, 0.93):
                x = plain.at(piece, t)[0]
                with pytest.raises(InputError, match=rf"regions\['a'\]\[0\] = .* lies on facet {piece}"):
                    make(regions={"a": x})
        x = plain.at(0, 0.37)[0]
        inner = x + 1e-8 * (middle - x)
        domain = make(regions={"a": inner})
        assert check(constrained_delaunay(domain), domain=domain)
        with pytest.raises(InputError, match="lies outside the region"):
            make(regions={"a": x - 1e-8 * (middle - x)})
    with pytest.raises(InputError, match=r"\[0.6, 0.8\] lies on facet 0"):
        Domain.disc(regions={"a": [0.6, 0.8]})  # the sum of squares is not exactly 1


POLY = """8 2 0 0
1 0 0
2 4 0
3 4 4
4 0 4
5 1 1
6 3 1
7 3 3
8 1 3
8 0
1 1 2
2 2 3
3 3 4
4 4 1
5 5 6
6 6 7
7 7 8
8 8 5
{holes}
{regions}
"""


@pytest.mark.parametrize(
    ("holes", "regions", "message"),
    [
        (["2 1"], [], r"hole 0 at \[2.0, 1.0\] lies on segment 4"),
        (["2 2", "1 1"], [], r"hole 1 at \[1.0, 1.0\] lies on point 4"),
        (["3 2"], [], r"hole 0 at \[3.0, 2.0\] lies on segment 5"),
        (["2 2"], ["2 0 7"], r"regions\['7'\]\[0\] = \[2.0, 0.0\] lies on facet 0"),
        (["2 2"], ["2 2 7"], "outside the region"),
        (["2 2"], ["3 3 7"], "lies on point 6"),
        ([], ["3 2 7"], "lies on inner segment 1"),
    ],
)
def test_seeds_of_poly_files(tmp_path: Path, holes: list[str], regions: list[str], message: str) -> None:
    def section(rows: list[str]) -> str:
        return "\n".join([str(len(rows)), *(f"{i + 1} {row}" for i, row in enumerate(rows))])

    path = tmp_path / "a.poly"
    path.write_text(POLY.format(holes=section(holes), regions=section(regions)))
    with pytest.raises(InputError, match=message):
        Domain.read(path)


def test_many_seeds() -> None:
    """A grid of squares, each with its name: by many seeds at once the same numbers as one by one."""
    n = 12
    points = np.stack(np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0)), axis=-1).reshape(-1, 2)
    number = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    sides = [number[:, :-1], number[:, 1:]], [number[:-1], number[1:]]
    every = np.concatenate([np.stack(pair, axis=-1).reshape(-1, 2) for pair in sides])
    ends = points[every]
    rim = ((ends == 0).all(axis=1) | (ends == n).all(axis=1)).any(axis=1)
    rng = np.random.default_rng(5)
    place = rng.permutation([(i + 0.25, j + 0.5) for i in range(n) for j in range(n)])
    regions = {f"{i}": [x] for i, x in enumerate(place)}
    domain = Domain(points, every[rim], inner=every[~rim], regions=regions)
    mesh = constrained_delaunay(domain)
    assert check(mesh, domain=domain) and mesh.regions == {name: k for k, name in enumerate(regions)}
    found = mesh.markers["region"][mesh.find_simplex(place)]
    assert found.tolist() == list(range(n * n)) and (np.bincount(mesh.markers["region"]) == 2).all()
    some = Domain(points, every[rim], inner=every[~rim], regions=dict(list(regions.items())[:9]))
    few = constrained_delaunay(some)
    assert few.markers["region"][few.find_simplex(place[:9])].tolist() == list(range(9))
    regions["last"] = [place[0] + [0.5, 0]]
    with pytest.raises(InputError, match=r"regions\['last'\]\[0\] = .* lies in the same part as '0'"):
        constrained_delaunay(Domain(points, every[rim], inner=every[~rim], regions=regions))
