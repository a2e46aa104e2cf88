"""The face: arguments, accounts, names, defaults."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from unstruct import Domain, InputError, Layers, Mesh, check, prismatic_layers

LAYERS = Layers(first=0.02, growth=1.2, count=4)


def test_the_account_of_a_ball() -> None:
    ball = Domain.ball(size=0.4, markers={"half": np.arange(7)})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh = prismatic_layers(ball, layers=LAYERS)
    rays, columns = len(ball.points), len(ball.facets)
    assert check(mesh) and mesh.complete
    assert mesh.counts["rays"] == rays and mesh.counts["wedges"] == 4 * columns == mesh.size
    assert mesh.figures["share of full heights"] == 1.0
    assert mesh.figures["least scaled Jacobian"] == pytest.approx(mesh.quality("scaled_jacobian").min())
    steps = mesh.steps
    assert steps is not None
    assert (mesh.points[steps["vertex"]] == ball.points).all() and (steps["place"] == ball.points).all()
    assert (steps["level"] == 4).all() and (steps["reason"] == "full").all()
    assert steps["height"] == pytest.approx(np.full(rays, LAYERS.thickness))
    assert np.bincount(steps["cell_layer"]).tolist() == [0] + [columns] * 4
    assert steps["cap"].shape == (columns, 3) and (steps["cap"] == mesh.markers["cap"]).all()
    top = mesh.points[np.unique(steps["cap"])]
    assert np.abs(np.sqrt((top**2).sum(axis=1)) - 1 - LAYERS.thickness).max() < 0.01
    assert len(mesh.markers["half"]) == 7
    assert (np.sort(mesh.markers["half"], axis=1) == np.sort(np.asarray(ball.facets)[:7], axis=1)).all()
    assert (mesh.origin[: len(ball.points)] >= 0).all() and (mesh.origin[len(ball.points) :] == -1).all()
    assert len(mesh.boundary) == 2 * columns


def test_a_mesh_and_a_domain_give_the_same() -> None:
    ball = Domain.ball(size=0.4)
    rows = ball.triangulated.triangles
    unused = np.concatenate([[[9.0, 9.0, 9.0]], ball.points])
    one = prismatic_layers(ball, layers=LAYERS)
    two = prismatic_layers(Mesh(unused, rows + 1), layers=LAYERS)
    assert (one.points == two.points).all() and (one.cells["wedge"] == two.cells["wedge"]).all()
    first = slice(0, len(ball.points))
    assert (two.origin[first] == one.origin[first] + 1).all()


@pytest.mark.parametrize("normals", ["visible", "staged", "angle", "area"])
def test_every_rule_for_directions(normals: str) -> None:
    for side in ("inside", "outside"):
        for smoothing in (0, 3):
            mesh = prismatic_layers(
                Domain.box(), layers=LAYERS, side=side, normals=normals, smoothing=smoothing, ridge=30
            )
            assert check(mesh) and mesh.counts["collapsed"] == 0


def test_wrong_arguments_are_named() -> None:
    box = Domain.box()
    for options, name in (
        ({"layers": 3}, "layers must be Layers"),
        ({"layers": Layers(first=0.1, growth=1.2)}, "count"),
        ({"layers": LAYERS, "side": "beside"}, "side must be"),
        ({"layers": LAYERS, "normals": "best"}, "normals must be"),
        ({"layers": LAYERS, "stop": "never"}, "stop must be"),
        ({"layers": LAYERS, "cells": "cube"}, "cells must be"),
        ({"layers": LAYERS, "smoothing": -1}, "smoothing"),
        ({"layers": LAYERS, "ridge": -1}, "ridge"),
        ({"layers": LAYERS, "ridge": "x"}, "ridge"),
        ({"layers": LAYERS, "recompute": 1}, "recompute"),
        ({"layers": LAYERS, "fill_options": 3}, "fill_options"),
    ):
        with pytest.raises(InputError, match=name):
            prismatic_layers(box, **options)  # type: ignore[arg-type]


def test_progress_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    prismatic_layers(
        Domain.box(), layers=Layers(thickness=2.0, count=3, growth=1.1), side="inside", progress=True
    )
    assert "round" in capsys.readouterr().err
