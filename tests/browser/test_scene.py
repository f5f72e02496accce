"""The picture in a real browser."""

from dataclasses import replace

import numpy as np
import pytest
from playwright.sync_api import Page

from hectorscope.page.scene import Layout
from hectorscope.page.theme import DARK, LIGHT, Rgb, for_lines
from tests.browser.conftest import Open, Show
from tests.page import LEVELS, room_snapshot
from tests.scene import PROJECT, is_near, look, names, node, wait_for_pixel

pytestmark = pytest.mark.browser

TEXTURES = """Object.entries(window.__viserMutable.nodeRefFromName)
  .filter(([name]) => name.startsWith('/floor/map/')).flatMap(([, node]) => {
    const found = [];
    node.traverse((child) => child.material?.map && found.push(child.material.map));
    return found;
  })"""
CRISP = f"((textures) => textures.length === {LEVELS} && textures.every((t) => t.magFilter === {{filter}}))"
NEAREST = 1003
FREE, WALL, UNKNOWN = (4.0, -4.0), (0.0, -5.5), (5.5, 4.5)  # x, y in the room


def expect(page: Page, place: tuple[float, ...], colour: Rgb) -> None:
    """Wait for a colour: pictures are decoded and drawn after they arrive."""
    seen = wait_for_pixel(page, place, lambda seen: is_near(seen, colour))
    assert is_near(seen, colour), f"at {place}"


@pytest.mark.parametrize("level", range(LEVELS))
def test_each_level_shows_its_cells(show: Show, open_page: Open, level: int) -> None:
    """Alone and from above, every level has free, occupied and unknown cells where the map has them."""
    show.server.scene.show(layout="one", level=level)
    show.server.scene.show_layer("grid", False)
    page = open_page(show.url)
    page.wait_for_function(f"window.__viserMutable.nodeRefFromName['/floor/map/level{level}']?.visible")
    look(page, "top")
    expect(page, FREE, DARK.free)
    expect(page, WALL, DARK.occupied)
    expect(page, UNKNOWN, DARK.background)


def test_cells_are_crisp(show: Show, open_page: Open) -> None:
    """Every map texture is drawn without smoothing, also after new pictures arrived."""
    page = open_page(show.url)
    crisp = f"{CRISP.format(filter=NEAREST)}({TEXTURES})"
    page.wait_for_function(crisp)
    page.evaluate(f"window.before = {TEXTURES}.map((texture) => texture.image)")
    snapshot = room_snapshot(sequence=2)
    changed = tuple(replace(image, cells=3 - image.cells, revision=9) for image in snapshot.maps)
    show.engine.show(replace(snapshot, maps=tuple(replace(m, cells=m.cells % 3) for m in changed)))
    page.wait_for_function(f"{TEXTURES}.every((texture) => !window.before.includes(texture.image))")
    page.wait_for_function(crisp)


def test_levels_stack_without_hiding_the_finest_from_above(show: Show, open_page: Open) -> None:
    """In a stack the levels lie over each other; looked at from above, the finest one is seen."""
    show.server.scene.show(layout="stacked", gap=0.5)
    show.server.scene.show_layer("grid", False)
    page = open_page(show.url)
    heights = [node(page, f"/floor/map/level{i}")["position"][2] for i in range(LEVELS)]  # type: ignore[index]
    assert heights == pytest.approx([0.0, 6.0, 12.0])
    look(page, "top")
    expect(page, FREE, DARK.free)


@pytest.mark.parametrize("layout", ["stacked", "side"])
def test_the_first_view_fits_the_map(show: Show, open_page: Open, layout: Layout) -> None:
    """Who opens the page sees all levels inside the window, at a size that fills it."""
    show.server.scene.show(layout=layout)
    page = open_page(show.url)
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


def test_light_and_dark(show: Show, open_page: Open) -> None:
    """The theme changes the map in an open page."""
    show.server.scene.show(layout="one", dark=False)
    show.server.scene.show_layer("grid", False)
    page = open_page(show.url)
    look(page, "top")
    expect(page, FREE, LIGHT.free)
    expect(page, WALL, LIGHT.occupied)
    show.server.scene.show(dark=True)
    expect(page, WALL, DARK.occupied)


def test_layers_are_switched_off(show: Show, open_page: Open) -> None:
    """A hidden layer is gone from the picture, the others stay."""
    show.server.scene.show(layout="one")
    page = open_page(show.url)
    look(page, "top")
    show.server.scene.show_layer("map", False)
    page.wait_for_function("!window.__viserMutable.nodeRefFromName['/floor/map'].visible")
    seen = wait_for_pixel(page, WALL, lambda seen: not is_near(seen, DARK.occupied))
    assert not is_near(seen, DARK.occupied)
    assert node(page, "/floor/scan") == {"position": [0.0, 0.0, pytest.approx(0.03)], "visible": True}


@pytest.mark.parametrize("colour", [LIGHT.trajectory, DARK.truth, LIGHT.fused])
def test_lines_have_the_colours_of_the_legend(show: Show, open_page: Open, colour: Rgb) -> None:
    """The page sends lines through a film curve; what was made for that comes out as the theme says."""
    show.server.scene.show_layer("map", False)
    page = open_page(show.url)
    ends = np.array([[[-6.0, 3.0, 0.3], [6.0, 3.0, 0.3]]], np.float32)
    show.server.scene.server.scene.add_line_segments(
        "/line", ends, for_lines(colour), thickness=30.0, thickness_units="screen"
    )
    page.wait_for_function("'/line' in window.__viserMutable.nodeRefFromName")
    look(page, "top")
    expect(page, (4.0, 3.0, 0.3), colour)


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


def test_the_robot_is_seen_from_far(show: Show, open_page: Open) -> None:
    """From far away the robot is drawn larger than it is, from near as it is."""
    page = open_page(show.url)
    look(page, "free")
    scale = "window.__viserMutable.nodeRefFromName['/robot/hull'].scale.x"
    for distance, expected in ((400.0, f"{scale} > 5"), (4.0, f"{scale} === 1")):
        page.evaluate("(d) => window.__viserMutable.cameraControl.dollyTo(d, false)", distance)
        page.wait_for_function(expected)
