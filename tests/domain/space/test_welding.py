"""Points that nearly coincide: errors name them, and ``merge`` makes them one."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest

from unstruct import Domain, DomainError, InputError, Mesh

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
SIDES = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
TRIANGLES = np.concatenate([SIDES[:, [0, 1, 2]], SIDES[:, [0, 2, 3]]])


def noisy(noise: float, seed: int = 0) -> np.ndarray:
    """The corners of the triangles of a cube, none where it should be: (36, 3)."""
    return CORNERS[TRIANGLES].reshape(-1, 3) + np.random.default_rng(seed).normal(0, noise, (36, 3))


def as_stl(path: Path, corners: np.ndarray) -> Path:
    rows = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {!r} {!r} {!r}\n".format(*map(float, x)) for x in corner)
        + "endloop\nendfacet\n"
        for corner in corners.reshape(-1, 3, 3)
    )
    path.write_text(f"solid cube\n{rows}endsolid cube\n")
    return path


@pytest.mark.parametrize("resolve", [False, True])
def test_corners_of_stl_that_nearly_coincide(tmp_path: Path, resolve: bool) -> None:
    path = as_stl(tmp_path / "noisy.stl", noisy(1e-7))
    with pytest.raises(DomainError, match=r"Points \d+ and \d+ are only .*e-0[78] apart.* merge=1e-06 of"):
        Domain.read(path, resolve=resolve)
    body = Domain.read(path, merge=1e-6, resolve=resolve)
    assert len(body.points) == 8 and len(body.facets) == 12
    assert body.volume == pytest.approx(1, rel=1e-6)
    assert body.repairs[0].kind == "close points" and body.repairs[0].text.startswith("merged 28 points")
    assert list(body.markers) == ["cube"] and len(body.markers["cube"]) == 12
    assert (noisy(1e-7)[body.origin] == body.points).all()


def test_a_point_apart_at_an_open_edge() -> None:
    points = np.vstack([CORNERS, [[1 + 1e-6, 1 + 1e-6, 1]]])
    rows = np.array(TRIANGLES)
    rows[1][rows[1] == 7] = 8
    surface = Mesh(points, rows)
    with pytest.raises(DomainError, match=r"boundary is open.*Points 7 and 8 are only 1.4e-06 apart"):
        Domain.surface(surface)
    body = Domain.surface(surface, merge=1e-5)
    assert body.volume == 1.0 and len(body.points) == 8


def test_triangles_without_area_go_and_markers_and_numbers_follow() -> None:
    points = np.vstack([CORNERS, [[1, 1, 1 + 1e-6]]])
    rows = np.concatenate([[[3, 7, 8]], TRIANGLES, [[7, 8, 6]]])
    surface = Mesh(points, rows, markers={"part": np.arange(14) // 7 + 1})
    body = Domain.surface(surface, merge=1e-5)
    assert body.volume == 1.0 and len(body.facets) == 12
    assert body.piece_origin.tolist() == list(range(1, 13))
    assert [len(body.markers[name]) for name in ("part 1", "part 2")] == [6, 6]
    assert "2 pieces without area were dropped" in body.repairs[0].text


def test_polygons_lose_vertices(tmp_path: Path) -> None:
    points = np.vstack([CORNERS, [[0, 0, 1e-9]]])
    rows = [[0, 8, 1, 3, 2], *SIDES[1:].tolist()]
    rows[2] = [0, 4, 5, 1, 8]
    lines = ["OFF", "9 6 0", *(" ".join(map(repr, map(float, x))) for x in points)]
    lines += [" ".join(map(str, [len(row), *row])) for row in rows]
    (tmp_path / "box.off").write_text("\n".join(lines))
    body = Domain.read(tmp_path / "box.off", merge=1e-8)
    assert body.volume == 1.0 and body.triangulated.triangles.shape == (12, 3)


def test_what_cannot_be_merged(tmp_path: Path) -> None:
    path = as_stl(tmp_path / "noisy.stl", noisy(1e-7))
    with pytest.raises(InputError, match="more than a hundredth of the extent"):
        Domain.read(path, merge=0.5)
    with pytest.raises(InputError, match=r"merge = -1.0 must be positive"):
        Domain.read(path, merge=-1)
    chain = np.array([[0.0, 0, 0.001 * k] for k in range(5)] + [[1, 0, 0], [0, 1, 0]])
    with pytest.raises(InputError, match=r"points 0 and 4, which are .* between them"):
        Domain.surface(Mesh(chain, [[k, 5, 6] for k in range(5)]), merge=0.0011)
    for source in ("POINT (0 0)", tmp_path / "a.smesh"):
        with pytest.raises(InputError, match="merge is for files of surfaces"):
            Domain.read(source, merge=1e-6)
    assert Domain.surface(Mesh(CORNERS, TRIANGLES), merge=1e-6).repairs == []


def test_soup_of_triangles_gives_one_repair() -> None:
    body = Domain(noisy(0.0), np.arange(36).reshape(-1, 3), resolve=True)
    assert len(body.points) == 8 and body.volume == 1.0
    assert [repair.kind for repair in body.repairs] == ["duplicate points"]
    assert "28 points equal others" in body.repairs[0].text and "leaves 8" in body.repairs[0].text
    assert len(body.repairs[0].vertices) == 36


def test_equal_facets_are_told_what_resolve_does() -> None:
    with pytest.raises(DomainError, match="keeps one of two equal facets if the surface is closed only with"):
        Domain(CORNERS, [*TRIANGLES, TRIANGLES[0]])
    body = Domain(CORNERS, [*TRIANGLES, TRIANGLES[0]], resolve=True)
    assert len(body.facets) == 12 and body.volume == 1.0
