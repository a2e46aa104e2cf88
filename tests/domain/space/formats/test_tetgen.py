"""TetGen's .smesh and .poly: holes and regions by seeds, facets of several polygons, wrong files."""

from __future__ import annotations

import tempfile
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, DomainError, InputError
from unstruct.domain.space import faults

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def smesh(cubes: list[tuple[float, float]], holes: str = "0\n", regions: str = "0\n", first: int = 1) -> str:
    """Cubes (lower corner, side) with marks 1, 2, ..., in a file numbered from ``first``."""
    points = np.concatenate([CORNERS * side + low for low, side in cubes])
    lines = [f"# cubes\n{len(points)} 3 0 0"]
    lines += [f"{i + first} {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(points.tolist())]
    lines.append(f"{6 * len(cubes)} 1  # facets")
    for k in range(len(cubes)):
        lines += [f"4 {' '.join(str(v + 8 * k + first) for v in side)} {k + 1}" for side in SIDES]
    return "\n".join(lines) + f"\n{holes}{regions}"


def test_holes_follow_from_seeds(tmp_path: Path) -> None:
    """A cube in a cube is a hole with a seed in it, and a wall without one."""
    (tmp_path / "a.smesh").write_text(smesh([(0, 4), (1, 1)], "1\n1 1.5 1.5 1.25\n"))
    hole = Domain.read(tmp_path / "a.smesh")
    assert hole.volume == 63.0 and len(hole.inner) == 0 and hole.hole_seeds.tolist() == [[1.5, 1.5, 1.25]]
    (tmp_path / "A.SMESH").write_text(
        smesh([(0, 4), (1, 1)], regions="2\n1 1.5 1.5 1.25 7 .5\n2 3 3 3 -1.5 -1\n")
    )
    wall = Domain.read(tmp_path / "A.SMESH")
    assert wall.volume == 64.0 and len(wall.facets) == 6 and len(wall.inner) == 6
    assert wall.markers["2"].tolist() == [*range(6, 12)] and wall.max_areas == {"7": 0.5}
    assert wall.regions["7"].tolist() == [[1.5, 1.5, 1.25]] and wall.regions["-1.5"].tolist() == [[3, 3, 3]]
    (tmp_path / "b.smesh").write_text(smesh([(0, 4), (1, 2), (1.5, 0.5)], "1\n0 1.25 1.25 1.25\n", first=0))
    nested = Domain.read(tmp_path / "b.smesh")
    assert nested.volume == 64 - 8 + 0.125 and len(nested.facets) == 18
    (tmp_path / "c.smesh").write_text(smesh([(1.5, 0.5), (0, 4), (1, 2)], "1\n0 1.75 1.75 1.6\n"))
    inside = Domain.read(tmp_path / "c.smesh")
    assert inside.volume == 64 - 0.125 and len(inside.facets) == 12 and len(inside.inner) == 6
    assert inside.piece_origin.tolist() == [*range(12), *range(12, 18)]


def test_a_wall_between_two_rooms_and_one_outside(tmp_path: Path) -> None:
    points = [
        *CORNERS.tolist(),
        *(CORNERS[4:] + np.array([1, 0, 0])).tolist(),
        [0, 0, 3.0],
        [1, 0, 3],
        [0, 1, 3],
    ]
    number = {4: 8, 5: 9, 6: 10, 7: 11, 0: 4, 1: 5, 2: 6, 3: 7}
    facets = [*SIDES, *[[number[v] for v in side] for side in SIDES[1:]], (12, 13, 14)]
    lines = [f"{len(points)} 3", *(f"{i} {x} {y} {z}" for i, (x, y, z) in enumerate(points))]
    lines += [f"{len(facets)} 0", *(f"{len(row)} {' '.join(map(str, row))}" for row in facets), "0"]
    (tmp_path / "a.smesh").write_text("\n".join(lines))
    found = Domain.read(tmp_path / "a.smesh")
    assert found.volume == 2.0 and len(found.facets) == 10
    assert sorted(row.tolist() for row in found.inner) == [[4, 6, 7, 5], [12, 13, 14]]


def test_a_sheet_that_encloses_nothing(tmp_path: Path) -> None:
    text = smesh([(0, 1)]).replace("6 1  # facets", "5 1").replace("4 2 6 8 4 1\n", "")
    (tmp_path / "a.smesh").write_text(text)
    found = Domain.read(tmp_path / "a.smesh")
    assert len(found.facets) == 0 and len(found.inner) == 5


@pytest.mark.parametrize("suffix", [".smesh", ".poly"])
def test_round_trip(tmp_path: Path, suffix: str) -> None:
    """Points bit for bit; facets and inner facets, holes, regions and marks as they were."""
    frame = Domain.polygon(
        [(0, 0), (4, 0), (4, 4), (0, 4)],
        [[(1, 1), (2, 1), (2, 2), (1, 2)]],
        markers={"5": [0]},
        regions={"2": (3, 3)},
    )
    shells = Domain(
        np.vstack([CORNERS * 4, CORNERS + 1.1]), [*SIDES, *[[v + 8 for v in side] for side in SIDES]]
    )
    ridge = Domain(
        [(0, 0), (4, 0), (4, 4), (0, 4), (1, 2), (3, 2)], [(0, 1), (1, 2), (2, 3), (3, 0)], inner=[(4, 5)]
    )
    for body in (Domain.extruded(frame, 1 / 3), shells, Domain.extruded(ridge, 1), Domain.ball(size=0.9)):
        body.write(tmp_path / f"a{suffix}")
        again = Domain.read(tmp_path / f"a{suffix}")
        assert np.array_equal(again.points, body.points) and again.volume == body.volume
        assert {k: v.tolist() for k, v in again.regions.items()} == {
            k: v.tolist() for k, v in body.regions.items()
        }
        if suffix == ".poly" or body is shells:
            assert [np.ravel(row).tolist() for row in again.facets] == [
                np.ravel(r).tolist() for r in body.facets
            ] or (len(again.facets) == len(body.facets))
            assert len(again.inner) == len(body.inner)
        again.write(tmp_path / f"b{suffix}")
        one, two = ((tmp_path / f"{name}{suffix}").read_text().splitlines() for name in "ab")
        assert [row for row in one if row[0] != "#"] == [
            row for row in two if row[0] != "#"
        ]  # comments are names
    shells.write(tmp_path / "c.smesh")
    assert len(Domain.read(tmp_path / "c.smesh").hole_seeds) == 1


def poly(facet: str) -> str:
    """A cube of side 4 in TetGen's .poly, its bottom written as ``facet``; points 8 to 11 lie in it."""
    points = [*(CORNERS * 4).tolist(), [1, 1, 0], [2, 1, 0], [2, 2, 0], [1, 2, 0]]
    points += [[1, 1, 1], [2, 1, 1], [2, 2, 1], [1, 2, 1]]
    points = points if "11" in facet else points[:11] if "10" in facet else points[:9]
    lines = [f"{len(points)} 3 0 0", *(f"{i} {x} {y} {z}" for i, (x, y, z) in enumerate(points)), "6 0"]
    for i, side in enumerate(SIDES):
        lines.append(facet.strip() if i == 4 else f"1\n4 {' '.join(map(str, side))}")
    return "\n".join(lines)


def test_facets_of_several_polygons(tmp_path: Path) -> None:
    """A pit in the bottom: an outline and a hole with its seed, and sides and a floor of the pit."""
    pit = ["4 12 13 14 15", *[f"4 {8 + k} {8 + (k + 1) % 4} {12 + (k + 1) % 4} {12 + k}" for k in range(4)]]
    text = poly("2 1\n4 0 2 6 4\n4 8 9 10 11\n1 1.5 1.5 0").replace("\n6 0\n", "\n11 0\n")
    (tmp_path / "A.POLY").write_text(text + "\n" + "\n".join(f"1\n{row}" for row in pit) + "\n0\n")
    found = Domain.read(tmp_path / "A.POLY")
    assert found.volume == 63.0 and len(found.facets) == 11
    # an inner ring without a seed: lines of the mesh, not a hole; two lines; vertices alone
    for facet, many in (
        ("2\n4 0 2 6 4\n4 8 9 10 11", 10),
        ("3\n4 0 2 6 4\n2 8 9\n1 10", 5),
        ("2\n4 0 2 6 4\n2 0 8", 0),
    ):
        (tmp_path / "b.poly").write_text(poly(facet) + "\n0\n")
        found = Domain.read(tmp_path / "b.poly")
        assert found.volume == 64.0 and len(found.facets) >= 5 + many


def test_points_in_a_file_beside_and_lines_that_go_on(tmp_path: Path) -> None:
    head, _, rest = smesh([(0, 1)]).partition("6 1  # facets")
    (tmp_path / "A.NODE").write_text(head)
    (tmp_path / "A.SMESH").write_text(
        "\ufeff0 3 0 0\r\n6 1" + rest.replace("4 1 2 4 3 1", "4 1 2\n4\n3 1"), "utf-8"
    )
    assert Domain.read(tmp_path / "A.SMESH").volume == 1.0
    (tmp_path / "A.POLY").write_text(
        "0 3 0 0\n6 1" + "".join(f"\n1 0 1\n{r[:-2]}" for r in rest.split("\n")[1:7]) + "\n0\n"
    )
    assert Domain.read(tmp_path / "A.POLY").volume == 1.0


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda t: "", r"a\.smesh ends where the number of vertices is expected"),
        (lambda t: t[:150], r"a\.smesh ends where"),
        (lambda t: t.replace("8 3 0 0", "8 2 0 0"), "the file is in 2 dimensions, not 3"),
        (lambda t: t.replace("1 0.0 0.0 0.0", "1 0.0 nan 0.0"), "line 3: 'nan' among vertices is not finite"),
        (lambda t: t.replace("1 0.0 0.0 0.0", "1 0.0 zz 0.0"), "line 3: 'zz' among vertices is no number"),
        (
            lambda t: t.replace("4 1 2 4 3 1", "4 1 2 4 9 1"),
            "line 12: there is no vertex 9; the file has 1 to 8",
        ),
        (lambda t: t.replace("4 1 2 4 3 1", "0 1 2 4 3 1"), "line 12: a polygon has 0 corners"),
        (
            lambda t: t.replace("4 1 2 4 3 1", "4 1 2 4.5 3 1"),
            "line 12: '4.5' among corners is no whole number",
        ),
        (lambda t: t.replace("6 1  #", "-6 1  #"), "line 11: the number of facets is -6"),
        (lambda t: t[: -len("0\n0\n")] + "1\n1 0.5 0.5\n", "line 19: holes needs 4 entries"),
        (
            lambda t: t[: -len("0\n0\n")] + "1\n1 0.5 0.5 0\n",
            "hole 0 at .* lies on facet 4; move it into the hole",
        ),
        (lambda t: t[: -len("0\n")] + "1\n1 5 5 5 1\n", "outside the body"),
    ],
)
def test_wrong_files_are_refused(tmp_path: Path, change: object, told: str) -> None:
    (tmp_path / "a.smesh").write_text(change(smesh([(0, 1)])))
    with pytest.raises(InputError, match=told):
        Domain.read(tmp_path / "a.smesh")


def test_crossing_facets_are_faults(tmp_path: Path) -> None:
    (tmp_path / "a.smesh").write_text(smesh([(0, 2), (1, 2)]))
    with pytest.raises(DomainError, match="crosses inner facet"):
        Domain.read(tmp_path / "a.smesh")
    (tmp_path / "a.poly").write_text(poly("3\n4 0 2 6 4\n2 8 10\n2 9 11") + "\n0\n")
    with pytest.raises(InputError, match=r"line \d+: the polygons of this facet cross or overlap"):
        Domain.read(tmp_path / "a.poly")


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.3, 1.0]))
def test_faults_are_told_in_the_numbers_of_the_file(seed: int, far: float) -> None:
    """Cubes in and beside each other, with vertices moved, sides left out or repeated, and a seed."""
    rng = np.random.default_rng(seed)
    points = np.concatenate([CORNERS * side + low for low, side in [(0, 4), (1, 1), (rng.integers(0, 6), 2)]])
    moved = rng.integers(len(points), size=2)
    points[moved] += far * rng.integers(-2, 3, (2, 3))
    rows = np.concatenate([np.array(SIDES) + 8 * k for k in range(3)])
    rows = rows[rng.permutation(len(rows))[: rng.integers(16, 19)]]
    if far and rng.random() < 0.2:
        rows = np.vstack([rows, rows[:1]])
    lines = [f"{len(points)} 3 0 0", *(f"{i} {x} {y} {z}" for i, (x, y, z) in enumerate(points.tolist()))]
    lines += [f"{len(rows)} 0", *(f"4 {' '.join(map(str, row))}" for row in rows.tolist())]
    told = wanted = None
    try:
        Domain(points, (), inner=rows)
    except InputError as error:
        wanted = str(error)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.smesh"
        path.write_text("\n".join([*lines, "1", "0 1.5 1.5 1.5", "0"]))
        try:
            Domain.read(path)
        except InputError as error:
            told = str(error)
    if wanted is not None and told != wanted:
        assert told is not None and "hole 0" in told  # what is found first
    if wanted is None and told is not None:
        assert "hole 0" in told


def test_that_facets_do_not_meet_is_asked_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def embedded(*_: object) -> bool:
        asked.append(1)
        return True

    monkeypatch.setattr(faults, "embedded", embedded)
    (tmp_path / "a.smesh").write_text(smesh([(0, 4), (1, 1)], "1\n1 1.5 1.5 1.25\n"))
    assert Domain.read(tmp_path / "a.smesh").volume == 63.0 and len(asked) == 1
