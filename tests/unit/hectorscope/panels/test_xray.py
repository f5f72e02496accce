"""The X-ray of a scan: what a browser may ask for, and what it is shown."""

import math
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest

from hectorscope.panels._request import FARTHEST, MOST_LEVELS, BadRequest
from hectorscope.panels._xray_scene import surface
from hectorscope.panels._xray_shown import ellipse
from hectorscope.panels._xray_wanted import MOST_STEPS, OMEGA, SPAN, YAW, Wanted, wanted_of
from hectorscope.panels._xray_work import OpenScan
from hectorscope.run.xray.attitude import passage
from hectorscope.run.xray.landscape import SIDE
from tests.xray import problem

ASKED: dict[str, Any] = {
    "lab": "steps", "step": 0, "level": 0, "plane": "xy", "span": 1.0, "yaw": 0.0, "show": "heat", "at": None,
    "omega": 0.5, "noise": 0.02, "of": "scan", "pitch": 0.0,
}  # fmt: skip


@pytest.fixture(scope="module")
def opened() -> OpenScan:
    return OpenScan(problem())


def test_requests_are_brought_into_their_ranges():
    """Whatever the numbers are."""
    wild = {"step": -5, "level": 99, "span": 1e9, "yaw": -9.0, "at": [77, 1e12, 0.0], "omega": 2, "noise": -1.0}
    found = wanted_of(ASKED | wild)
    assert (found.step, found.level, found.span, found.yaw) == (0, MOST_LEVELS - 1, SPAN[1], -YAW)
    assert found.at == (MOST_LEVELS - 1, FARTHEST, 0.0)
    assert found.omega == OMEGA[1]
    assert wanted_of(ASKED | {"step": 10**9}).step == MOST_STEPS


@pytest.mark.parametrize(
    "wrong",
    [
        {"lab": "kitchen"}, {"plane": 3}, {"show": None}, {"show": []}, {"step": 1.5}, {"span": math.nan},
        {"at": [0, 1.0]}, {"at": {"x": 1}}, {"at": [0, "1", 2]}, {"omega": None}, {"noise": True},
        {"of": "moon"}, {"pitch": "up"},
    ],
)  # fmt: skip
def test_what_no_script_of_ours_sends_is_refused(wrong: dict[str, Any]):
    """Unknown words, wrong types, numbers that are none."""
    with pytest.raises(BadRequest):
        wanted_of(ASKED | wrong)


def test_steps_show_beams_where_the_iteration_places_them(opened: OpenScan):
    """Each endpoint at S_i(xi) with its gradient as a line; the numbers of the equations are those of the core."""
    steps = problem().iterations(problem().start)
    (shown,) = opened.shown(Wanted(step=3), None)
    assert shown.steps == len(steps)
    assert shown.dots is not None and shown.dots.level == steps[3].level
    lines, resolution = shown.dots.lines, problem().grids[steps[3].level].resolution
    np.testing.assert_allclose((lines[:, 1] - lines[:, 0]) / (2 * resolution**2), steps[3].gradients, atol=1e-9)
    assert f"{steps[3].cost:.3f}" in shown.words
    assert f"{steps[4].cost:.3f} after the step" not in shown.words or steps[4].level == steps[3].level


def test_beams_that_are_left_out_are_told(opened: OpenScan):
    """One or more of them, as the match of the run did without them; else there is no word of it."""
    (shown,) = opened.shown(Wanted(), None)
    assert "left out" not in shown.words
    for beams, words in ((1, "1 beam on an object"), (3, "3 beams on objects")):
        match = problem().match._replace(left_out=np.arange(beams))
        (shown,) = OpenScan(replace(problem(), match=match)).shown(Wanted(), None)
        assert words in shown.words


def test_arrows_at_the_robot_are_eigenvectors_of_h(opened: OpenScan):
    """Both axes through the pose, across each other, as long as the square roots of the eigenvalues."""
    now = problem().iterations(problem().start)[-1]
    (shown,) = opened.shown(Wanted(step=10**4), None)
    axes = [np.array(mark["at"])[:, 1:] for mark in shown.marks if mark["kind"] == "axis"]
    arms = [ends[1] - ends[0] for ends in axes]
    values = np.linalg.eigvalsh(now.H[:2, :2])
    for arm, value, ends in zip(arms, values, axes, strict=True):
        np.testing.assert_allclose(now.H[:2, :2] @ arm, value * arm, rtol=1e-3, atol=1e-3 * values[1])
        np.testing.assert_allclose(ends.mean(axis=0), now.pose[:2], atol=1e-4)
    lengths = [float(np.hypot(*arm)) for arm in arms]
    assert lengths[0] / lengths[1] == pytest.approx(math.sqrt(values[0] / values[1]), rel=1e-3)


def test_another_start_is_followed_to_its_end(opened: OpenScan):
    """The words say whether that is the matched pose; the robot is marked where the matcher ends."""
    near = problem().matched + np.array([0.1, -0.05, 0.02])
    for start, kind in ((near, "same"), (problem().matched + np.array([4.0, 3.0, 1.0]), "elsewhere")):
        shown = next(iter(opened.shown(Wanted(lab="landscape"), start)))
        (end,) = [mark for mark in shown.marks if mark["kind"] in {"same", "elsewhere"}]
        assert end["kind"] == kind
        tip = problem().end(start).pose
        expected = tip[:2] + 0.3 * np.array([math.cos(tip[2]), math.sin(tip[2])])
        np.testing.assert_allclose(end["at"][0][1:], expected, atol=1e-4)


def test_a_basin_comes_in_pictures_that_grow(opened: OpenScan):
    """The first at once, each with more starts, the last with all of them."""
    pictures = list(opened.shown(Wanted(lab="landscape", show="basin", span=1.3), None))
    assert len(pictures) > 2
    assert "0 of 3721" in pictures[0].words
    assert "3721 of 3721" in pictures[-1].words


def test_the_heat_map_is_brightest_at_the_lowest_cost(opened: OpenScan):
    """A pixel for each pose, centred on the matched pose; the surface is lowest there."""
    (shown,) = opened.shown(Wanted(lab="landscape", show="surface", span=0.3), None)
    assert shown.heat is not None and shown.heat.heights is not None
    assert shown.heat.picture.shape == (SIDE, SIDE, 4)
    bright = shown.heat.picture[..., :3].astype(int).sum(axis=-1)
    low = np.unravel_index(np.argmin(shown.heat.heights), (SIDE, SIDE))
    assert bright[low] == bright.max()
    np.testing.assert_allclose(shown.heat.centre, problem().matched[:2])
    lines, _ = surface(shown.heat)
    assert lines[..., 2].min() == pytest.approx(0.05, abs=1e-6)
    middle = lines[..., :2].reshape(-1, 2)
    np.testing.assert_allclose((middle.min(axis=0) + middle.max(axis=0)) / 2, shown.heat.centre, atol=1e-5)


def test_ellipses_have_the_axes_of_their_covariance():
    """The longest and the shortest radius are the square roots of the eigenvalues, times the sigmas."""
    covariance = np.array([[0.04, 0.01, 0.0], [0.01, 0.02, 0.0], [0.0, 0.0, 1.0]])
    points = np.array(ellipse("match", 0, np.array([1.0, 2.0, 0.0]), covariance, 3.0)["at"])[:, 1:] - [1.0, 2.0]
    radii = np.hypot(*points.T)
    low, high = np.sqrt(np.linalg.eigvalsh(covariance[:2, :2]))
    assert radii.max() == pytest.approx(3.0 * high, rel=1e-3)
    assert radii.min() == pytest.approx(3.0 * low, rel=1e-3)


def test_the_lens_asks_for_a_click_and_marks_four_cells(opened: OpenScan):
    """Each cell with its probability."""
    (empty,) = opened.shown(Wanted(lab="lens"), None)
    assert "Click" in empty.words
    x, y = problem().matched[:2] + np.array([0.4, 0.0])
    (shown,) = opened.shown(Wanted(lab="lens", at=(0, float(x), float(y))), None)
    assert sum(mark["kind"] == "cell" for mark in shown.marks) == 4


def test_covariances_come_with_a_growing_cloud(opened: OpenScan):
    """The first picture has no cloud; the omega of the slider is in the words."""
    wanted = Wanted(lab="covariance", omega=0.123, noise=0.03)
    first, second = islice(opened.shown(wanted, None), 2)
    assert "ω 0.123" in first.words
    assert first.dots is not None and second.dots is not None
    assert len(first.dots.points) == 0 < len(second.dots.points)
    again = next(iter(opened.shown(replace(wanted, omega=0.2), None)))
    assert again.dots is not None and len(again.dots.points) >= len(second.dots.points)  # it is kept


def test_room_corridor_and_water_are_compared(opened: OpenScan):
    """One after another, each with its table once the cloud begins, until every cloud is whole."""
    pictures = [shown.words for shown in opened.shown(Wanted(lab="covariance", of="places"), None)]
    assert pictures[0].count("<svg") == 0
    last = pictures[-1]
    assert [last.count(each) for each in ("<svg", "cloud of 400", "Share of")] == [3, 3, 1]
    for title in ("Room", "Corridor", "Open water"):
        assert f"<h3>{title}" in last


def test_the_equation_of_the_attitude_has_its_numbers(opened: OpenScan):
    """The secant of the pitch, and both errors; at 90 degrees a number of no use."""
    (shown,) = opened.shown(Wanted(lab="attitude", pitch=math.radians(60.0)), None)
    assert "<td>2</td>" in shown.words
    found = passage(math.radians(60.0))
    for error in (found.by_angles, found.by_quaternion):
        assert f"<td>{math.degrees(error):.3f}</td>" in shown.words
    (pole,) = opened.shown(Wanted(lab="attitude", pitch=math.pi / 2), None)
    assert "10¹⁶" in pole.words
