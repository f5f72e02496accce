"""The picture in a real browser."""

from dataclasses import replace

import numpy as np
import pytest
from playwright.sync_api import Page

from hectorscope.page.theme import DARK, LIGHT, Rgb, Theme, css, for_lines
from tests.browser.conftest import Open, Show
from tests.cases import quick_first
from tests.page import LEVELS, room_snapshot, step_result
from tests.scene import PROJECT, choose_own, is_near, look, names, node, wait_for_pixel

pytestmark = pytest.mark.browser

TEXTURES = """Object.entries(window.__viserMutable.nodeRefFromName)
  .filter(([name]) => /^.floor.map.level.*cells$/.test(name)).flatMap(([, node]) => {
    const found = [];
    node.traverse((child) => child.material?.map && found.push(child.material.map));
    return found;
  })"""
CRISP = f"((textures) => textures.length === {LEVELS} && textures.every((t) => t.magFilter === {{filter}}))"
NEAREST = 1003
FREE, WALL, UNKNOWN = (4.0, -4.0), (0.0, -5.5), (5.5, 4.5)  # x, y in the room
COUNT_PROGRAMS = """() => {
  const context = WebGL2RenderingContext.prototype, link = context.linkProgram;
  window.programs = 0;
  context.linkProgram = function (program) { window.programs += 1; return link.call(this, program); };
}"""
# Whether the points were drawn with another material than when it was so last.
OTHER_SCAN = """() => {
  let material = null;
  window.__viserMutable.nodeRefFromName['/floor/scan/points'].traverse((part) => (material ??= part.material));
  if (material === window.scan || !material.userData.dressed) return false;
  window.scan = material;
  return true;
}"""


def expect(page: Page, place: tuple[float, ...], colour: Rgb) -> None:
    """Wait for a colour: pictures are decoded and drawn after they arrive."""
    seen = wait_for_pixel(page, place, lambda seen: is_near(seen, colour))
    assert is_near(seen, colour), f"at {place}"


@pytest.mark.parametrize("level", quick_first(range(LEVELS)))
def test_each_level_shows_its_cells(again: Open, level: int) -> None:
    """Alone and from above, every level has free, occupied and unknown cells where the map has them."""
    page = again(layout="one", level=level, layers={"grid": False})
    page.wait_for_function(f"window.__viserMutable.nodeRefFromName['/floor/map/level{level}']?.visible")
    look(page, "top")
    expect(page, FREE, DARK.free)
    expect(page, WALL, DARK.occupied)
    expect(page, UNKNOWN, DARK.background)


def test_cells_are_crisp(show: Show, again: Open) -> None:
    """Every map texture is drawn without smoothing, also after new pictures arrived."""
    page = again()
    crisp = f"{CRISP.format(filter=NEAREST)}({TEXTURES})"
    page.wait_for_function(crisp)
    page.evaluate(f"window.before = {TEXTURES}.map((texture) => texture.image)")
    snapshot = room_snapshot(sequence=2)
    changed = tuple(replace(image, cells=3 - image.cells, revision=9) for image in snapshot.maps)
    show.engine.show(replace(snapshot, maps=tuple(replace(m, cells=m.cells % 3) for m in changed)))
    page.wait_for_function(f"{TEXTURES}.every((texture) => !window.before.includes(texture.image))")
    page.wait_for_function(crisp)


def test_a_scan_compiles_nothing_that_one_before_it_compiled(show: Show, again: Open) -> None:
    """Scans follow each other, each with a material of its own; their program is compiled once."""
    page = again()
    for sequence in range(2, 8):
        show.engine.show(replace(room_snapshot(sequence), result=step_result(sequence, beams=100 + sequence)))
        page.wait_for_function(OTHER_SCAN)
        if sequence == 3:
            page.evaluate(COUNT_PROGRAMS)
    assert page.evaluate("window.programs") == 0


def test_levels_stack_without_hiding_the_finest_from_above(again: Open) -> None:
    """In a stack the levels lie over each other; looked at from above, the finest one is seen."""
    page = again(layers={"grid": False})
    page.wait_for_function("window.__viserMutable.nodeRefFromName['/floor/map/level2'].position.z > 0")
    heights = [node(page, f"/floor/map/level{i}")["position"][2] for i in range(LEVELS)]  # type: ignore[index]
    assert heights == pytest.approx([0.0, 6.5, 13.0])  # half of what is shown, 12 m and a margin
    look(page, "top")
    expect(page, FREE, DARK.free)


@pytest.mark.parametrize("layout", quick_first(["stacked", "side"]))
def test_the_first_view_fits_the_map(show: Show, open_page: Open, layout: str) -> None:
    """Who opens the page sees all levels inside the window, at a size that fills it."""
    page = open_page(show.url, own={"layout": layout, "plots": "off"})
    look(page, "fit")
    script = """() => {
      const box = window.__viserMutable.canvas.getBoundingClientRect();
      return [box.left, box.top, box.right, box.bottom];
    }"""
    left, top, right, bottom = page.evaluate(script)
    corners = []
    for i in range(LEVELS):
        x, y, z = node(page, f"/floor/map/level{i}")["position"]  # type: ignore[index]
        corners += [page.evaluate(PROJECT, [x + dx, y + dy, z]) for dx in (-7, 7) for dy in (-5, 5)]
    columns, rows = zip(*corners, strict=True)
    assert left <= min(columns) and max(columns) <= right and top <= min(rows) and max(rows) <= bottom
    assert max((max(columns) - min(columns)) / (right - left), (max(rows) - min(rows)) / (bottom - top)) > 0.6


def test_light_and_dark(show: Show, again: Open, open_page: Open) -> None:
    """Each browser has a theme, which changes the map in an open page."""
    chosen = {"layout": "one", "layers": {"grid": False}}
    page = again(theme="light", **chosen)
    other = open_page(show.url, own={**chosen, "plots": "off"})
    for each, theme in ((page, LIGHT), (other, DARK)):
        look(each, "top")
        expect(each, FREE, theme.free)
        expect(each, WALL, theme.occupied)
        expect(each, UNKNOWN, theme.background)
    choose_own(page, theme="dark")
    expect(page, WALL, DARK.occupied)


def test_layers_are_switched_off(again: Open) -> None:
    """A hidden layer is gone from the picture, the others stay."""
    page = again(layout="one")
    look(page, "top")
    choose_own(page, layers={"map": False})
    page.wait_for_function("!window.__viserMutable.nodeRefFromName['/floor/map'].visible")
    seen = wait_for_pixel(page, WALL, lambda seen: not is_near(seen, DARK.occupied))
    assert not is_near(seen, DARK.occupied)
    assert node(page, "/floor/scan") == {"position": [0.0, 0.0, pytest.approx(0.03)], "visible": True}


@pytest.mark.parametrize("colour", [LIGHT.trajectory, DARK.truth, LIGHT.fused])
def test_lines_come_through_the_film_curve(show: Show, again: Open, colour: Rgb) -> None:
    """Viser sends lines through a film curve; what was made for that comes out as it should."""
    page = again(layers={"map": False})
    ends = np.array([[[-6.0, 3.0, 0.3], [6.0, 3.0, 0.3]]], np.float32)
    line = show.server.scene.server.scene.add_line_segments(
        "/line", ends, for_lines(colour), thickness=30.0, thickness_units="screen"
    )
    page.wait_for_function("!!window.__viserMutable.nodeRefFromName['/line']")
    look(page, "top")
    expect(page, (4.0, 3.0, 0.3), colour)
    line.remove()
    page.wait_for_function("!window.__viserMutable.nodeRefFromName['/line']")


@pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
def test_lines_and_points_have_the_colours_of_the_legend(again: Open, theme: Theme) -> None:
    """The server draws for all in one set of colours; each browser sees those of its own theme."""
    name = "dark" if theme.dark else "light"
    hidden = ("map", "grid", "truth", "prior", "match", "fused", "frames")
    page = again(theme=name, layers=dict.fromkeys(hidden, False))
    look(page, "top")
    colour = """(name) => { const found = []; window.__viserMutable.nodeRefFromName[name].traverse(
      ({material}) => material && found.push(material.color.getHexString('srgb'))); return found[0]; }"""
    assert page.evaluate(colour, "/trajectory/chunk0") == css(theme.trajectory)[1:]
    assert page.evaluate(colour, "/robot/hull") == css(theme.robot)[1:]
    expect(page, (3.0 * np.cos(-1.9), 3.0 * np.sin(-1.9)), theme.unexpected)


def test_everybody_sees_the_same(show: Show, open_page: Open) -> None:
    """A second browser, one that comes late and one that reloads have every node where the first has it."""
    first = open_page(show.url)
    show.engine.show(room_snapshot(sequence=2, x=3.0, y=1.0))
    moved = "Math.abs(window.__viserMutable.nodeRefFromName['/robot'].position.x - 3) < 1e-3"
    first.wait_for_function(moved)
    late = open_page(show.url)
    late.wait_for_function(moved)
    first.reload()
    first.wait_for_function(f"window.__viserMutable?.nodeRefFromName?.['/robot'] && {moved}")
    for page in (first, late):
        page.wait_for_function("window.__viserMutable.nodeRefFromName['/floor/fused/pose/rim']")
    assert names(first) == names(late)
    for name in ("/robot", "/floor/scan", "/floor/fused/pose", "/frames/base_link"):
        assert node(first, name) == node(late, name)


def test_the_robot_is_seen_from_far(again: Open) -> None:
    """From far away the robot is drawn larger than it is, from near as it is."""
    page = again()
    look(page, "free")
    scale = "window.__viserMutable.nodeRefFromName['/robot/hull'].scale.x"
    for distance, expected in ((400.0, f"{scale} > 5"), (4.0, f"{scale} === 1")):
        page.evaluate("(d) => window.__viserMutable.cameraControl.dollyTo(d, false)", distance)
        page.wait_for_function(expected)
