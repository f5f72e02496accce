"""Driving a simulated robot from the page, as a class does."""

from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Page, expect

from hectorscope.run.warmup import load_everything
from hectorscope.session.engine import Engine
from hectorscope.simulation.drive_source import DriveSource
from hectorscope.web.server import PageServer
from tests.browser.conftest import Open, Show
from tests.engines import START, until

pytestmark = pytest.mark.browser
CARD, MEASURING = ".hs-drive", ".hs-measure-hint"
PATIENCE_S = 90.0


class Drive:
    """A robot that waits to be driven, and its page."""

    def __init__(self) -> None:
        self.source = DriveSource("rooms")
        self.engine = Engine(self.source, START)
        self.server = PageServer(self.engine, port=0)
        self.server.start()
        self.engine.start()

    def x(self) -> float:
        """Metres ahead of the start, as the run has it."""
        latest = self.engine.mailbox.latest
        return float(latest.result.planar[0]) if latest and latest.result else 0.0

    def until_x(self, holds: Callable[[float], bool]) -> None:
        """Wait until the robot is there."""
        until(self.engine, lambda _: holds(self.x()), PATIENCE_S)


@pytest.fixture(scope="module")
def drive() -> Iterator[Drive]:
    load_everything()
    made = Drive()
    until(made.engine, lambda now: now.scans > 80, PATIENCE_S)
    yield made
    made.engine.stop()
    made.server.stop()


@pytest.fixture
def page(drive: Drive, kept: Open) -> Page:
    """With the faults folded away."""
    made = kept(drive.server.url)
    expect(made.locator(CARD)).to_be_visible()  # its keys are heard from then on
    made.evaluate("(card) => (document.querySelector(`${card} details`).open = false)", CARD)
    return made


def test_arrow_keys_drive_and_the_robot_stops_when_they_are_let_go(page: Page, drive: Drive):
    """Up drives on while it is held; afterwards the robot comes to rest."""
    page.mouse.click(300, 200)
    start = drive.x()
    page.keyboard.down("ArrowUp")
    drive.until_x(lambda x: x > start + 0.4)
    page.keyboard.up("ArrowUp")
    until(drive.engine, lambda now: now.result and abs(now.result.navigation.velocity[0]) < 0.05, PATIENCE_S)
    page.keyboard.down("ArrowDown")
    drive.until_x(lambda x: x < start + 0.3)
    page.keyboard.up("ArrowDown")


def test_letters_steer_only_while_the_joystick_has_the_focus(page: Page, drive: Drive):
    """D measures in the scene, as ever; with the joystick in focus it turns the robot instead."""
    page.mouse.click(600, 200)
    page.keyboard.press("d")
    expect(page.locator(MEASURING)).to_be_visible()
    page.keyboard.press("Escape")
    page.locator(".hs-pad").focus()
    latest = drive.engine.mailbox.latest
    assert latest is not None and latest.result is not None
    before = float(latest.result.planar[2])
    page.keyboard.down("d")
    until(drive.engine, lambda now: abs(float(now.result.planar[2]) - before) > 0.2, PATIENCE_S)
    page.keyboard.up("d")


def test_the_joystick_is_dragged(page: Page, drive: Drive):
    """A hand that holds it at the left turns the robot to the left."""
    box = page.locator(".hs-pad").bounding_box()
    assert box is not None
    latest = drive.engine.mailbox.latest
    assert latest is not None and latest.result is not None
    before = float(latest.result.planar[2])
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 4, box["y"] + box["height"] / 2)
    until(drive.engine, lambda now: float(now.result.planar[2]) > before + 0.2, PATIENCE_S)
    page.mouse.up()


def test_a_bias_by_the_slider_is_told_beside_what_the_filter_finds(page: Page, drive: Drive):
    """The slider reaches the robot, and the card names the estimate."""
    page.locator(f"{CARD} summary").click()
    slider = page.get_by_role("slider", name="Gyro bias, each axis")
    slider.fill("0.5")
    until(drive.engine, lambda now: now.drive and now.drive.faults["gyro_bias"] == 0.5, PATIENCE_S)
    until(drive.engine, lambda now: now.result and now.result.navigation.gyro_bias[0] > 0.006, PATIENCE_S)
    expect(page.locator("[data-fault=gyro_bias] small")).to_contain_text("the filter estimates")


def test_stabilisation_is_switched_off_for_a_swaying_robot(page: Page, drive: Drive):
    """The slider sways the robot, and the switch of the settings acts from the next scan on."""
    page.locator(f"{CARD} summary").click()
    sway = page.get_by_role("slider", name="Sway in roll and pitch")
    sway.fill("15")
    until(drive.engine, lambda now: now.drive and now.drive.faults["sway"] == 15.0, PATIENCE_S)
    page.get_by_role("tab", name="Settings").click()
    row = page.locator(".mantine-Flex-root", has=page.locator("label:text-is('Stabilise')"))
    stabilise = row.get_by_role("checkbox")
    stabilise.click()
    until(drive.engine, lambda now: not now.config.scan.stabilise, PATIENCE_S)
    expect(stabilise).not_to_be_checked()
    stabilise.click()
    until(drive.engine, lambda now: now.config.scan.stabilise, PATIENCE_S)
    sway.fill("0")
    until(drive.engine, lambda now: now.drive and now.drive.faults["sway"] == 0.0, PATIENCE_S)


def test_doors_and_boxes_are_moved_by_buttons(page: Page, drive: Drive):
    """A door closes and opens; a box stands ahead of the robot until it is taken away."""
    page.get_by_role("button", name="Close door 1").click()
    until(drive.engine, lambda now: now.drive and now.drive.doors[0] is False, PATIENCE_S)
    page.get_by_role("button", name="Open door 1").click()
    page.get_by_role("button", name="Box 1 ahead").click()
    until(drive.engine, lambda now: now.drive and now.drive.boxes[0], PATIENCE_S)
    page.get_by_role("button", name="Take away").click()
    until(drive.engine, lambda now: now.drive and now.drive.boxes == (None, None), PATIENCE_S)


def test_there_is_no_card_where_no_robot_is_driven(show: Show, open_page: Open):
    """Arrow keys then do what they did before."""
    expect(open_page(show.url).locator(CARD)).to_be_hidden()
