"""Still pictures of widgets: stored beside the live view, so that a page shows them before it has run."""

import base64
import io

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest
from PIL import Image

from unstruct import delaunay, view
from unstruct.view import frames as fr
from unstruct.view.draw.stills import with_still

VIEW = "application/vnd.jupyter.widget-view+json"
STEPS = [fr.frame(f"step {k}", fr.dots("vertex", [[0, 0], [1, k]])) for k in range(3)]
WIDGETS = {
    "player": lambda: view.player(STEPS, alt="two points"),
    "panel": view.bowyer_watson,
    "space": lambda: view.view3d(delaunay(np.random.default_rng(1).random((9, 3))), alt="a few tetrahedra"),
}


def stored(widget):
    shown = widget._repr_mimebundle_()
    return shown[0] if isinstance(shown, tuple) else shown


@pytest.mark.parametrize("make", WIDGETS.values(), ids=WIDGETS)
def test_a_widget_brings_a_picture(make):
    before = plt.get_fignums()
    data = stored(make())
    assert {VIEW, "text/plain", "image/png"} <= set(data)
    with Image.open(io.BytesIO(base64.b64decode(data["image/png"]))) as picture:
        width, height = picture.size
        assert 150 <= width <= 700 and 150 <= height <= 700
        assert len(np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0)) > 3, (
            "something is drawn"
        )
    assert len(data["image/png"]) < 60_000
    assert plt.get_fignums() == before, "the figure is closed"


def test_the_picture_is_that_of_the_frame_shown():
    player = view.player(STEPS, alt="two points")
    first = stored(player)["image/png"]
    player.index = 2
    assert stored(player)["image/png"] != first
    player.index = 0
    assert stored(player)["image/png"] == first


def test_a_widget_without_a_view_stays_so():
    assert with_still(None, b"") is None
    assert with_still(({}, {}), b"x") == ({"image/png": "eA=="}, {})
