"""The reference has every public name, with an example that runs as its page is made."""

from __future__ import annotations

import re

import pytest
from book_files import BOOK, notebook

import unstruct

TEXT = (BOOK / "reference_examples.txt").read_text(encoding="utf-8")
EXAMPLES = dict(zip(*[iter(re.split(r"^=== (.*)\n", TEXT, flags=re.M)[1:])] * 2))
PICTURES = [  # the functions of `unstruct.view` that draw; the others are the book's frames and widgets
    *(name for name in dir(unstruct.view) if name.startswith("plot")),
    *"setup color_cells picture view3d draw draw_items strip player insertion_frames line_style".split(),
]
SPACES = ("sizing", "simplex", "topology", "predicates", "studies", "examples")
PAGE = "\n".join(
    output.get("data", {}).get("text/html", "")
    for cell in notebook(BOOK / "reference.ipynb").cells
    for output in cell.get("outputs", [])
)


def public() -> list[str]:
    spaces = {*SPACES, "plain", "view"}
    names = [name for name in unstruct.__all__ if name not in spaces]
    names += [f"view.{name}" for name in PICTURES]
    return names + [f"{space}.{name}" for space in SPACES for name in getattr(unstruct, space).__all__]


@pytest.mark.parametrize("name", public())
def test_every_name_has_an_example(name: str) -> None:
    assert name in EXAMPLES, f"book/reference_examples.txt has no example of {name}"
    used = name.rpartition(".")[2]
    assert re.search(rf"\b{used}\b", EXAMPLES[name]), f"the example of {name} does not use it"
    assert "print(" in EXAMPLES[name], f"the example of {name} shows nothing"


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_example_is_short_and_on_the_page(name: str) -> None:
    lines = EXAMPLES[name].strip().splitlines()
    assert len(lines) <= 12 and max(map(len, lines)) <= 110, name
    first = lines[0].replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    assert first.replace('"', "&quot;").replace("'", "&#x27;") in PAGE, f"the page has no example of {name}"
