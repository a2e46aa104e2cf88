"""The JavaScript of the player and of the rotating view, run in headless Chromium without a kernel."""

import base64
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from unstruct import delaunay, view
from unstruct.view.draw import frames
from unstruct.view.draw.items import INNER, cut_items
from unstruct.view.draw.sections import FACES, Plane

playwright = pytest.importorskip(
    "playwright.sync_api", reason="playwright is not installed: pip install playwright"
)
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium on the path: apt-get install chromium")
PATIENCE = 900_000  # milliseconds, to end what hangs; a busy machine may be slow

PAGE = """<!doctype html><meta charset="utf-8"><style>CSS</style><div id="here"></div><script>
const state = STATE, heard = {};
window.model = {
  get: (key) => state[key],
  set(key, value) {
    if (JSON.stringify(state[key]) === JSON.stringify(value)) return;
    state[key] = value;
    for (const call of heard["change:" + key] ?? []) call();
  },
  save_changes() {},
  on(event, call) { (heard[event] ??= []).push(call); },
  off(event, call) { heard[event] = heard[event].filter((c) => c !== call); },
};
import("data:text/javascript;base64,MODULE").then(async (made) => {
  window.stop = await made.default.render({ model: window.model, el: document.getElementById("here") });
  window.heard = heard;
  window.made = made;
  window.ready = true;
});
</script>"""


@pytest.fixture(scope="module")
def browser():
    with playwright.sync_playwright() as p:
        made = p.chromium.launch(
            executable_path=BROWSER,
            args=["--no-sandbox", "--disable-gpu", "--no-first-run"],
            timeout=PATIENCE,
        )
        yield made
        made.close()


@pytest.fixture
def show(browser):
    """Open a page with one widget on it; at the end of the test nothing may have gone wrong in it."""
    errors, pages = [], []

    def open_page(widget):
        hidden = ("layout", "comm", "keys", "tabbable", "tooltip")
        state = {k: getattr(widget, k) for k in widget.traits(sync=True) if k[0] != "_" and k not in hidden}
        page = browser.new_page(viewport={"width": 900, "height": 800})
        page.set_default_timeout(PATIENCE)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
        page.on("request", lambda r: errors.append(r.url) if r.url.startswith("http") else None)
        module = base64.b64encode(str(widget._esm).encode()).decode()
        page.set_content(
            PAGE.replace("CSS", str(widget._css))
            .replace("STATE", json.dumps(state))
            .replace("MODULE", module)
        )
        page.wait_for_function("window.ready")
        pages.append(page)
        return page

    yield open_page
    for page in pages:
        page.close()
    assert not errors


def history(length=5):
    rng = np.random.default_rng(0)
    return [
        frames.frame(
            f"step {k} of <b>",
            frames.polygons("cavity", rng.random((k + 1, 3, 2))),
            frames.circles("circumcircle", [[0.5, 0.5], [1e12, 0]], [0.3, 1e12 - 0.25]),
            frames.segments("edge", rng.random((k, 2, 2))),
            frames.dots("inserted", [0.5, 0.5], handles=["P"]),
            frames.labels("vertex", [[0.2, 0.2]], ["A & <B>"]),
            number=f"k = {k}",
            view=(0, 1, 0, 1),
        )
        for k in range(length)
    ]


def test_buttons_slider_and_keys_step_the_player(show):
    page = show(view.player(history(), alt="a test."))
    index = lambda: page.evaluate("model.get('index')")  # noqa: E731
    page.click("[data-do=next]")
    page.click("[data-do=next]")
    assert index() == 2 and page.inner_text(".unstruct-caption") == "step 2 of <b>"
    assert page.inner_text(".unstruct-number") == "k = 2" and page.inner_text("output") == "3/5"
    page.focus(".unstruct-player")
    for key, wanted in (("ArrowLeft", 1), ("End", 4), ("ArrowRight", 4), ("Home", 0), ("ArrowLeft", 0)):
        page.keyboard.press(key)
        assert index() == wanted, key
    assert page.is_disabled("[data-do=back]") and page.is_enabled("[data-do=last]")
    page.fill("input[type=range]", "3")
    assert index() == 3
    page.click("[data-do=first]")
    page.click("[data-do=last]")
    assert index() == 4


def test_it_plays_to_the_end_and_stops(show):
    page = show(view.player(history(4), alt="a test.", interval=20))
    page.click("[data-do=play]")
    page.wait_for_function("model.get('index') === 3 && document.querySelector('[aria-label=play]')")
    once = """() => {
        const button = document.querySelector("[data-do=play]");
        button.click();
        return button.getAttribute("aria-label");
    }"""
    assert page.evaluate(once) == "pause"
    page.wait_for_function("model.get('index') === 3 && document.querySelector('[aria-label=play]')")
    page.click("[data-do=first]")
    assert page.evaluate(once) == "pause" and page.evaluate(once) == "play", "a second click halts it"
    page.evaluate(once)
    page.evaluate("stop()")
    assert page.evaluate("Object.values(heard).flat().length") == 0, "a closed player must not listen"


def test_every_item_is_drawn_and_described(show):
    page = show(view.player(history(), alt="a test."))
    page.keyboard.press("Tab")
    page.evaluate("model.set('index', 4)")
    assert page.locator("[data-kind=polygons] > path").count() == 5
    assert page.locator("[data-kind=polygons] > g > path").count() == 5, "the cavity is hatched"
    assert page.locator("[data-kind=circles] circle").count() == 1
    assert page.locator("[data-kind=circles] path").count() == 1, "the huge circle is cut to an arc"
    assert page.locator("[data-kind=labels] text").text_content() == "A & <B>"
    assert page.get_attribute(".unstruct-picture", "aria-label") == "a test. Step 5 of 5: step 4 of <b> k = 4"
    path = page.get_attribute("[data-kind=circles] path", "d")
    across = [float(p.split()[0]) for p in path[1:].split("L")]
    size = page.evaluate("document.querySelector('.unstruct-picture').viewBox.baseVal.width")
    assert np.allclose(across, size / 4, atol=0.05), "a circle of radius 1e12 through x = 1/4 is a line there"


def test_a_dragged_point_is_reported_to_python(show):
    page = show(view.player(history(1), alt="a test."))
    assert page.is_hidden(".unstruct-choice") and page.is_hidden(".unstruct-bar"), (
        "one frame has nothing to step"
    )
    box = page.locator(".unstruct-grip").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    picture = page.locator(".unstruct-picture").bounding_box()
    page.mouse.move(picture["x"] + 0.25 * picture["width"], picture["y"] + 0.25 * picture["height"])
    page.wait_for_function("model.get('dragged').handle")
    page.mouse.up()
    dragged = page.evaluate("model.get('dragged')")
    assert dragged["handle"] == "P" and abs(dragged["x"] - 0.25) < 0.02 and abs(dragged["y"] - 0.75) < 0.02


def drawn_for(page, change):
    """What a change draws: how often a picture is replaced, its elements, and the shapes on a canvas.

    Counted, not timed: it says the same on each machine, however busy.
    """
    page.evaluate("() => { window.requestAnimationFrame = (call) => call(); }")  # no wait for the screen
    return page.evaluate(
        """(change) => {
        const pen = CanvasRenderingContext2D.prototype, fill = pen.fill, stroke = pen.stroke;
        const seen = new MutationObserver(() => {}), group = document.querySelector("svg g");
        let painted = 0;
        pen.fill = function (...given) { painted += 1; return fill.apply(this, given); };
        pen.stroke = function (...given) { painted += 1; return stroke.apply(this, given); };
        if (group) seen.observe(group, { childList: true });
        Function(change)();
        const replaced = seen.takeRecords().length;
        Object.assign(pen, { fill, stroke });
        return { replaced, elements: group ? group.querySelectorAll("*").length : 0, painted };
    }""",
        change,
    )


def test_a_step_draws_what_it_shows_once(show):
    """With a thousand triangles and their circles in the picture."""
    rng = np.random.default_rng(1)
    big = [
        frames.frame(
            "",
            frames.polygons("cell", rng.random((1000, 3, 2))),
            frames.circles("circumcircle", rng.random((1000, 2)), rng.random(1000)),
        )
        for _ in range(2)
    ]
    page = show(view.player(big, alt="a test."))
    drawn = drawn_for(page, "model.set('index', 1)")
    assert drawn["replaced"] == 1 and 2000 <= drawn["elements"] <= 2020


@pytest.mark.parametrize("dark", [False, True])
def test_the_words_can_be_read_on_light_and_dark_pages(show, dark):
    page = show(view.player(history(), alt="a test."))
    page.evaluate(
        f"document.body.style = 'background: {'#111; color: #eee' if dark else '#fff; color: #111'}'"
    )
    words, button, paper = (
        page.evaluate(f"getComputedStyle(document.querySelector('{where}')).{what}")
        for where, what in (
            (".unstruct-caption", "color"),
            ("button", "color"),
            (".unstruct-picture", "backgroundColor"),
        )
    )
    assert words == button == ("rgb(238, 238, 238)" if dark else "rgb(17, 17, 17)")
    assert paper == "rgb(255, 255, 255)"


def solid():
    corners = np.eye(4)[:, :3]
    return [
        view.item3("cells", "accepted", [[3, 0, 1, 2]], corners),
        view.item3("points", "vertex", corners),
        view.item3("labels", "vertex", corners, text="ABCD"),
        view.item3("segments", "front", [[0, 1]], corners),
        view.item3("spheres", "circumcircle", [[0.5, 0.5, 0.5, 0.75**0.5]]),
    ]


def pixels(page):
    """How many pixels of the picture are not white, and a number that changes with the picture."""
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return page.evaluate(
        """() => {
        const canvas = document.querySelector("canvas");
        const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
        let [ink, sum] = [0, 0];
        for (let k = 0; k < data.length; k += 4) {
            if (data[k] + data[k + 1] + data[k + 2] < 765) ink += 1;
            sum = (sum * 31 + data[k] * 3 + data[k + 1] * 5 + data[k + 2] * 7) % 1000003;
        }
        return [ink, sum];
    }"""
    )


def test_the_view_turns_by_drag_and_keys_and_resets(show):
    page = show(view.view3d(solid(), alt="a tetrahedron.", caption="one"))
    first = pixels(page)
    assert first[0] > 2000 and page.get_attribute("canvas", "aria-label") == "a tetrahedron. one"
    box = page.locator("canvas").bounding_box()
    page.mouse.move(box["x"] + 200, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 260, box["y"] + 180, steps=3)
    page.mouse.up()
    turned = pixels(page)
    assert turned != first and page.evaluate("model.get('azimuth')") == pytest.approx(275)
    assert page.evaluate("model.get('elevation')") == pytest.approx(12)
    for key in ("ArrowLeft", "ArrowUp", "+"):
        before = pixels(page)
        page.keyboard.press(key)
        assert pixels(page) != before, key
    page.click("[data-do=reset]")
    assert pixels(page) == first
    page.evaluate("stop()")
    assert page.evaluate("Object.values(heard).flat().length") == 0


def test_the_slider_explodes_cells_and_hides_where_there_are_none(show):
    page = show(view.view3d(solid()[:1], alt="a tetrahedron."))
    before = pixels(page)
    page.fill("input[type=range]", "1")
    assert page.evaluate("model.get('explode')") == 1 and pixels(page) != before
    surface = show(view.view3d(solid()[1:], alt="points."))
    assert surface.is_hidden("label")


@pytest.mark.parametrize("explode", [0, 0.5])
def test_the_plane_of_a_section_moves_without_a_kernel(show, explode):
    mesh = delaunay(np.random.default_rng(0).random((80, 3)))
    wedge = view.item3("cells", "cell", [[0, 1, 2, 3, 4, 5]], np.eye(6)[:, :3] + 2)
    items = [*view.mesh_items3(mesh, whole=True), wedge]
    widget = view.view3d(items, alt="a cut cube.", section=("x", 0.5), explode=explode)
    page = show(widget)
    normal, low, high = (np.array(widget.scene["section"][k]) for k in ("normal", "low", "high"))
    seen = []
    for share in (0, 0.2, 0.5, 1):
        page.fill("input[aria-label=section]", str(share))
        assert page.evaluate("model.get('section')") == share
        seen.append(pixels(page))
        plane = Plane((low + share * (high - low)) * normal, normal)
        counts = page.evaluate(
            """([share, explode]) => {
            const all = made.primitives(model.get("scene"), explode, share);
            return [all.length, all.filter((thing) => thing.color).length];
        }""",
            [share, explode],
        )
        cut = cut_items(widget.scene["items"], plane, explode)
        assert counts[0] == sum(
            len(i["data"]) * (len(FACES[len(i["data"][0])]) if explode else 1) for i in cut if i["data"]
        )
        if not explode:
            assert counts[1] == sum(color is not None for i in cut for color in i["colors"])
    assert len(set(map(tuple, seen))) == 4
    page.click("[data-do=reset]")
    assert page.evaluate("model.get('section')") == widget.section
    assert show(view.view3d(mesh, alt="a cube.")).is_hidden("label:has([aria-label=section])")


def test_both_renderers_have_the_same_faces():
    script = (Path(view.__file__).parent / "draw" / "space.js").read_text()
    found = re.findall(r"^  (\d): (\[\[.*\]\]),$", script, flags=re.MULTILINE)
    assert {int(size): json.loads(faces) for size, faces in found} == FACES
    assert f'INNER = "{INNER}"' in script


def test_each_face_of_two_thousand_cells_is_painted_once_for_a_turn(show):
    rng = np.random.default_rng(0)
    points = rng.random((8000, 3)) * 0.1 + np.repeat(rng.random((2000, 3)), 4, axis=0)
    page = show(
        view.view3d([view.item3("cells", "cell", np.arange(8000).reshape(-1, 4), points)], alt="many.")
    )
    drawn = drawn_for(page, "model.set('azimuth', 10)")
    assert 4000 <= drawn["painted"] <= 8200  # of 8000 faces, some from behind, and some edges


def test_another_history_starts_at_its_beginning(show):
    panel = view.bowyer_watson()
    page = show(panel.player)
    page.click("[data-do=last]")
    second = panel.player.variants[1]
    page.select_option("select", label=second["name"])
    assert page.evaluate("model.get('variant')") == 1 and page.evaluate("model.get('index')") == 0
    assert page.inner_text(".unstruct-caption") == second["frames"][0]["caption"]


def test_the_nasty_window_is_drawn_once(show):
    frame = view.empty_circle_state(0, 0, "nasty: neighboring doubles")
    page = show(view.player([frame], alt="Signs at a window of neighboring doubles."))
    assert page.locator("[data-kind=points] path").count() == 33**2 + 1
    change = """
        const [frame] = model.get("frames");
        model.set("frames", [{ ...frame, caption: frame.caption + "." }]);
    """
    drawn = drawn_for(page, change)
    assert drawn["replaced"] == 1 and 33**2 <= drawn["elements"] <= 33**2 + 30


def grown(preset, x, y):
    """A panel's state: a point that can be dragged; with the second preset a history of two frames."""
    first = frames.frame(
        f"{preset} {x:g} {y:g}",
        frames.dots("vertex", [[0, 0], [1, 1]]),
        frames.dots("inserted", [[x, y]], handles=["P"]),
        number=f"sum {x + y:g}",
    )
    return first if preset == "plain" else [first, frames.frame("later", *first["items"])]


def test_a_panel_moves_without_a_kernel(show):
    grid = {"preset": ["plain", "<nasty>"], "x": np.linspace(0, 1, 5), "y": np.linspace(0, 1, 3)}
    page = show(view.panel(grown, grid, alt="a test.", start={"x": 0.25}, labels={"y": "height of P"}))
    caption = lambda: page.inner_text(".unstruct-caption")  # noqa: E731
    assert caption() == "plain 0.25 0" and page.is_hidden(".unstruct-bar")
    assert page.locator(".unstruct-grid label span").all_inner_texts() == ["preset", "x", "height of P"]
    slider = page.locator("input[data-axis='1']")
    slider.focus()
    for key in ("ArrowRight", "ArrowRight"):
        slider.press(key)
    assert caption() == "plain 0.75 0" and page.inner_text(".unstruct-number") == "sum 0.75"
    assert slider.get_attribute("aria-valuetext") == "0.75"
    page.locator("input[data-axis='2']").press("End")
    assert caption() == "plain 0.75 1"
    page.select_option("select[data-axis]", label="<nasty>")
    assert caption() == "<nasty> 0.75 1" and page.inner_text(".unstruct-bar output") == "1/2"
    page.click("[data-do=next]")
    assert caption() == "later"
    page.click("[data-do=reset]")
    assert caption() == "plain 0.25 0"
    page.evaluate("stop()")
    assert page.evaluate("Object.values(heard).flat().length") == 0


def test_a_drag_goes_to_the_nearest_state_of_a_panel(show):
    grid = {"preset": ["plain", "other"], "x": np.linspace(0, 1, 5), "y": np.linspace(0, 1, 3)}
    page = show(view.panel(grown, grid, alt="a test.", start={"preset": "other"}, view=(0, 1, 0, 1)))
    picture = page.locator(".unstruct-picture").bounding_box()
    page.mouse.move(picture["x"] + 3, picture["y"] + picture["height"] - 3)
    page.mouse.down()
    page.mouse.move(picture["x"] + 0.7 * picture["width"], picture["y"] + 0.4 * picture["height"])
    page.wait_for_function("document.querySelector('.unstruct-caption').textContent == 'other 0.75 0.5'")
    page.mouse.up()
    assert page.input_value("input[data-axis='1']") == "3"


def test_a_state_of_a_large_panel_is_drawn_once(show):
    points = np.random.default_rng(2).random((500, 3, 2))
    page = show(
        view.panel(
            lambda x, y: frames.frame(
                "", frames.polygons("cell", points + np.array([x, y])), frames.dots("inserted", [x, y])
            ),
            {"x": range(12), "y": range(8)},
            alt="many triangles.",
        )
    )
    drawn = drawn_for(page, "model.set('variant', 50)")
    assert drawn["replaced"] == 1 and 501 <= drawn["elements"] <= 520
