"""Each person's own camera."""

import pytest
from playwright.sync_api import Page

from tests.browser.conftest import Open, Show
from tests.page import room_snapshot
from tests.scene import PROJECT, RESTS, look, node

pytestmark = pytest.mark.browser

CAMERA = """() => {
  const controls = window.__viserMutable.cameraControl, at = controls.getTarget();
  const [distance, polar, azimuth] = [controls.distance, controls.polarAngle, controls.azimuthAngle];
  return {distance, polar, azimuth, at: [at.x, at.y, at.z]};
}"""
ROBOT = "window.__viserMutable.nodeRefFromName['/robot'].matrixWorld.elements.slice(12, 15)"


# How many angles the camera takes on its way to the vertical.
WAY_UP = """() => new Promise((there) => {
  const angles = new Set(), state = window.hectorscope.cameraState;
  const look = () => {
    angles.add(window.__viserMutable.cameraControl.polarAngle);
    state().goal === null ? there(angles.size) : requestAnimationFrame(look);
  };
  window.hectorscope.camera("top");
  requestAnimationFrame(look);
})"""


MIDDLE = """() => {
  const box = window.__viserMutable.canvas.getBoundingClientRect();
  return [box.left + box.width / 2, box.top + box.height / 2];
}"""


def middle(page: Page) -> tuple[float, float]:
    x, y = page.evaluate(MIDDLE)
    return x, y


def zoom(page: Page, ticks: int) -> float:
    """Turn the wheel over the scene; the distance afterwards."""
    page.mouse.move(*middle(page))
    before = page.evaluate(CAMERA)["distance"]
    page.mouse.wheel(0, 120 * ticks)
    page.wait_for_function(f"Math.abs(window.__viserMutable.cameraControl.distance / {before} - 1) > 0.02")
    page.wait_for_function(RESTS)
    distance: float = page.evaluate(CAMERA)["distance"]
    return distance


def test_following_keeps_the_robot_in_the_middle(show: Show, again: Open) -> None:
    """The camera's target goes where the robot goes."""
    page = again()
    look(page, "follow")
    show.engine.show(room_snapshot(sequence=2, x=5.0, y=2.0))
    page.wait_for_function("Math.abs(window.__viserMutable.nodeRefFromName['/robot'].position.x - 5) < 1e-3")
    page.wait_for_function(f"""() => {{
      const at = window.__viserMutable.cameraControl.getTarget().toArray(), robot = {ROBOT};
      return robot.every((value, k) => Math.abs(value - at[k]) < 0.05);
    }}""")


def test_following_leaves_zoom_to_the_person(show: Show, again: Open) -> None:
    """A distance chosen by the wheel stays while the robot moves on."""
    page = again()
    look(page, "follow")
    chosen = zoom(page, -3)
    show.engine.show(room_snapshot(sequence=2, x=-4.0, y=-2.0))
    page.wait_for_function("Math.abs(window.__viserMutable.nodeRefFromName['/robot'].position.x + 4) < 1e-3")
    page.wait_for_function(RESTS)
    assert page.evaluate(CAMERA)["distance"] == pytest.approx(chosen, rel=0.01)


def test_the_fitted_view_ends_where_the_person_takes_over(show: Show, again: Open) -> None:
    """After the wheel was turned, the view stays as the person left it."""
    page = again()
    look(page, "fit")
    before = page.evaluate(CAMERA)["distance"]
    chosen = zoom(page, -4)
    assert chosen < 0.97 * before
    show.engine.show(room_snapshot(sequence=2, x=-4.0, y=-2.0))
    page.wait_for_function("Math.abs(window.__viserMutable.nodeRefFromName['/robot'].position.x + 4) < 1e-3")
    page.wait_for_function(RESTS)
    assert page.evaluate(CAMERA)["distance"] == pytest.approx(chosen, rel=0.01)


def test_from_above_north_is_up(again: Open) -> None:
    """Top-down, the map's x axis points right and its y axis up."""
    page = again()
    look(page, "top")
    (x0, y0), (x1, _), (_, y2) = (page.evaluate(PROJECT, list(p)) for p in ((0, 0, 0), (2, 0, 0), (0, 2, 0)))
    assert x1 > x0 + 10
    assert y2 < y0 - 10
    assert page.evaluate(CAMERA)["polar"] == pytest.approx(0.0, abs=0.02)


def test_free_leaves_the_vertical(again: Open) -> None:
    """From above to free, the view is tilted again, and dragging turns it."""
    page = again()
    look(page, "top")
    look(page, "free")
    tilted = page.evaluate(CAMERA)
    assert tilted["polar"] > 0.5
    page.mouse.move(*middle(page))
    page.mouse.down()
    page.mouse.move(middle(page)[0] + 80, middle(page)[1], steps=5)
    page.mouse.up()
    turned = f"Math.abs(window.__viserMutable.cameraControl.azimuthAngle - {tilted['azimuth']}) > 0.05"
    page.wait_for_function(turned)


@pytest.mark.parametrize(("motion", "least", "most"), [("no-preference", 4, 1000), ("reduce", 1, 3)])
def test_the_camera_glides_unless_less_motion_is_wanted(
    show: Show, open_page: Open, motion: str, least: int, most: int
) -> None:
    """As the operating system of this person says (prefers-reduced-motion)."""
    page = open_page(show.url, motion=motion)
    assert least <= page.evaluate(WAY_UP) <= most


@pytest.mark.slow
def test_each_person_has_a_view_of_their_own(show: Show, open_page: Open) -> None:
    """Pointing one browser's camera by the server leaves the other's alone."""
    one, other = open_page(show.url), open_page(show.url)
    look(one, "fit")
    look(other, "fit")
    before = other.evaluate(CAMERA)
    first = sorted(show.server.scene.server.get_clients().items())[-2][1]
    show.server.scene.camera("top", first)
    one.wait_for_function("window.__viserMutable.cameraControl.polarAngle < 0.05")
    assert other.evaluate(CAMERA)["polar"] == pytest.approx(before["polar"], abs=0.01)
    assert node(one, "/robot") == node(other, "/robot")
