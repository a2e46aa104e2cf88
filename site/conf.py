"""The website: python -m sphinx -W -E -b html site site/_build/html

Nothing is executed and nothing is fetched: pages are the stored notebooks, mathematics is rendered by
the MathJax that a package brings along, and players run on the widget states stored in the notebooks.
"""

from __future__ import annotations

import shutil
import sys
import tomllib
from importlib.util import find_spec
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from pages import write_pages, write_scripts  # noqa: E402
from previews import add_preview, sentences  # noqa: E402

PROJECT = tomllib.loads((HERE.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]
MATHJAX = Path(find_spec("sphinx-mathjax-offline").origin).parent / "static" / "mathjax"

project = PROJECT["name"]
author = PROJECT["authors"][0]["name"]
copyright = f"2026, {author}. Text and figures CC BY 4.0, code MIT"
release = PROJECT["version"]
language = "en"

extensions = ["myst_nb"]
exclude_patterns = ["_build", "_made"]
templates_path = []
nb_execution_mode = "off"  # the book's own script executes, its tests compare
nb_render_markdown_format = "myst"  # tables in outputs
nb_render_image_options = {"align": "center"}
nb_code_prompt_show = "Show {type}"
nb_code_prompt_hide = "Hide {type}"
myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

html_theme = "sphinx_book_theme"
html_title = "Unstructured mesh generation"
html_static_path = ["_static", "_made", str(MATHJAX / "tex-svg.js")]
html_css_files = ["book.css", "print.css"]
html_js_files = [(name, {"defer": "defer"}) for name in ("scripts.js", "widgets.js", "ledger.js", "reach.js")]
html_show_sourcelink = False
html_copy_source = False
html_show_search_summary = False  # it would fetch pages, which a browser forbids when they lie on a disk
html_context = {"default_mode": "auto"}
html_theme_options = {
    "navbar_persistent": [],
    "show_navbar_depth": 1,
    "show_toc_level": 2,
    "use_download_button": False,
    "use_fullscreen_button": True,
    "use_source_button": False,
    "use_repository_button": False,
    "use_issues_button": False,
}
mathjax_path = "tex-svg.js"
# A hundred formulas between a reader and the next link are too many for the Tab key.
mathjax3_config = {"options": {"menuOptions": {"settings": {"inTabOrder": False}}}}

BOOK = HERE.parent / "book"
write_pages(BOOK, HERE)
write_scripts(HERE.parent / "unstruct" / "view", HERE / "_made")
shutil.copyfile(HERE.parent / "book" / "cover.png", HERE / "_made" / "cover.png")


def setup(app: Any) -> None:
    app.add_config_value("page_sentences", sentences(BOOK), "html")
    app.connect("html-page-context", add_preview)
