"""What carries meaning in pictures stands out from the paper and from plain cells, as WCAG 2 AA asks."""

import re
from pathlib import Path

import pytest
from contrast import GRAPHIC, TEXT, contrast
from matplotlib.colors import to_hex

from unstruct import view
from unstruct.view.draw.colors import PAPER, RC

MUTED = {"muted"}  # what no longer matters, and is there for orientation only
CELL = view.ROLES["cell"].fill


def test_the_formula():
    assert contrast("#000000", "#ffffff") == pytest.approx(21) and contrast("#777777", "#777777") == 1
    assert contrast("#767676", "#ffffff") == pytest.approx(4.54, abs=0.01)  # the known gray at the limit


@pytest.mark.parametrize("name", sorted(set(view.ROLES) - MUTED))
def test_lines_stand_out(name):
    role = view.ROLES[name]
    assert contrast(role.color, PAPER) >= GRAPHIC
    if name != "cell":
        assert contrast(role.color, CELL) >= GRAPHIC


@pytest.mark.parametrize("name", view.ROLES)
def test_names_can_be_read(name):
    role = view.ROLES[name]
    assert contrast(role.ink, PAPER) >= TEXT
    if contrast(role.color, PAPER) >= TEXT:
        assert role.ink == role.color, "a color that can be read is left as it is"


def test_curves_of_plots_stand_out():
    colors = RC["axes.prop_cycle"].by_key()["color"]
    assert all(contrast(to_hex(color), PAPER) >= GRAPHIC for color in colors)


def test_focus_is_seen_on_light_and_dark_pages():
    style = (Path(view.__file__).parent / "draw" / "player.css").read_text("utf-8")
    (ring,) = re.findall(r":focus-visible \{\s*outline: 2px solid (#\w+)", style)
    assert min(contrast(ring, page) for page in ("#ffffff", "#14181e", "#111111")) >= GRAPHIC
