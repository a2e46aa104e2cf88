"""Pictures of bodies in space, still and turning: facets, what is inside, names, and faults."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest

from unstruct import Domain, DomainError, InputError, Mesh, view

HALVES = Domain(
    [(0, 0), (2, 0), (2, 1), (0, 1), (1, 0), (1, 1)],
    [(0, 4), (4, 1), (1, 2), (2, 5), (5, 3), (3, 0)],
    inner=[(4, 5)],
    regions={"a": (0.5, 0.5)},
)


def kinds(items: list) -> dict[tuple[str, str], int]:
    return {(item["kind"], item["role"]): len(item["data"]) for item in items}


def test_items_of_a_body() -> None:
    box = view.mesh_items3(Domain.box())
    assert kinds(box) == {("polygons", "cell"): 6, ("labels", "inserted"): 6} and box[0]["opacity"] == 1.0
    body = view.mesh_items3(Domain.extruded(HALVES, 1))
    found = kinds(body)
    assert found["polygons", "front"] == 1 and found["points", "voronoi"] == 1 and body[0]["opacity"] < 1
    frame = Domain.polygon([(0, 0), (4, 0), (4, 4), (0, 4)], [[(1, 1), (2, 1), (2, 2), (1, 2)]])
    assert kinds(view.mesh_items3(Domain.extruded(frame, 1)))["polygons", "cell"] == 8 + 2 * 8


def test_faults_are_marked() -> None:
    with pytest.raises(DomainError) as caught:
        Domain([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2), (0, 1, 3), (1, 2, 3)])
    items = view.mesh_items3(caught.value)
    assert ("polygons", "bad") in kinds(items)
    assert [i["text"] for i in items if i["role"] == "bad" and i["kind"] == "labels"] == [
        ["open boundary"] * 3
    ]
    assert caught.value.plot() is not None
    with pytest.raises(DomainError) as caught:
        Domain([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2), (0, 1, 7)])
    assert kinds(view.mesh_items3(caught.value))["polygons", "cell"] == 1
    plt.close("all")


def test_plot_and_view() -> None:
    box = Domain.box(regions={"steel": (0.5, 0.5, 0.5)})
    ax = box.plot(azimuth=30, elevation=10)
    assert {"steel", "left", "top"} <= {text.get_text() for text in ax.texts}
    assert {text.get_text() for text in box.plot(names=False, numbers=True).texts} >= {"f0", "7"}
    assert {text.get_text() for text in view.plot(box, azimuth=0).texts} >= {"steel"}
    widget = view.view3d(Domain.torus(), alt="A torus.")
    assert widget.scene["ball"][3] > 1.3 and len(widget.scene["items"][0]["data"]) == len(
        Domain.torus().facets
    )
    assert len(box.plot(vertices=True).collections) > len(box.plot().collections)
    plt.close("all")


def test_refusals() -> None:
    with pytest.raises(InputError, match="options of bodies in space"):
        Domain.rectangle().plot(azimuth=3)
    with pytest.raises(InputError, match="a view in space shows bodies in space"):
        view.view3d(Domain.rectangle(), alt="flat")
    with pytest.raises(InputError, match="options of meshes"):
        view.plot(Domain.box(), values=np.zeros(6))
    with pytest.raises(
        InputError, match=r"faces are too many .* \(at most 20000\): draw them with view\.plot"
    ):
        view.view3d(Domain.ball(size=0.03), alt="A fine ball.")
    mesh = Mesh(np.eye(4)[:, :3], np.tile([[0, 1, 2, 3]], (10_001, 1)))
    with pytest.raises(InputError, match=r"the 40004 faces of 10001 cells .* \(at most 40000\)"):
        view.view3d(mesh, alt="Many cells.", section=("-y", 0.5))
