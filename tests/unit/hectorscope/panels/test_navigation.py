"""The read-outs of the navigation filter."""

import math
import re

import numpy as np
import pytest

from hectorscope.panels._ellipses import SIGMAS, ellipses_svg
from hectorscope.panels.navigation import (
    biases_html,
    faults_html,
    fusion_html,
    sources_html,
    standing,
    unused_html,
)
from slam_core.config import AidingConfig, NavigationConfig
from slam_core.results import AidingStatus, NavigationState, PlanarGaussian, StepResult
from tests.page import AIDING, planar_gaussian, step_result

ON = AidingConfig()
S = 1_000_000_000


def with_filter() -> tuple[StepResult, NavigationState]:
    result = step_result()
    assert result.navigation is not None
    return result, result.navigation


@pytest.mark.parametrize(
    ("status", "word", "share"),
    [
        (AidingStatus("gps", used=3, stamp_ns=9 * S, nis=4.0, bound=16.0), "live", 0.5),
        (AidingStatus("gps", used=3, stamp_ns=9 * S, nis=4.0), "live", None),
        (AidingStatus("gps", used=3, streak=2, stamp_ns=9 * S, nis=64.0, bound=16.0), "rejected", 2.0),
        (AidingStatus("gps", used=3, stamp_ns=7 * S, nis=4.0, bound=16.0), "silent", None),
        (AidingStatus("height", used=3, stamp_ns=9 * S, frozen=True), "frozen", None),
        (AidingStatus("height", used=3, stamp_ns=10 * S, nis=math.nan, bound=16.0), "live", None),
    ],
)
def test_a_source_is_live_rejected_frozen_or_silent(status: AidingStatus, word: str, share: float | None) -> None:
    """By its last measurement at 10 s; the innovation is a share of its gate, if it has one."""
    found = standing(status, 10 * S, ON)
    assert (found.word, found.share) == (word, share)


@pytest.mark.parametrize(
    "source", ["gps", "gps velocity", "compass", "ground", "attitude", "standstill", "gravity", "zero rate"]
)
def test_a_source_that_is_switched_off_says_so(source: str) -> None:
    """Whatever it said last."""
    off = AidingConfig(gps=False, compass=False, ground=False, attitude=False, standstill=False)
    status = AidingStatus(source, used=3, stamp_ns=10 * S)
    assert standing(status, 10 * S, off).word == "off"
    assert standing(status, 10 * S, ON).word == "live"


def test_every_source_has_a_row_with_its_counters() -> None:
    """State, bar, used, rejected, dropped; reasons come from outside and are escaped."""
    html = sources_html(step_result(), ON)
    rows = re.findall(r"<tr class=.*?</tr>", html)
    assert len(rows) == len(AIDING)
    assert all(part in rows[0] for part in ("hs-is-live", "height", "width:10%", ">100</td>", "0.1 ± 0.2"))
    assert "1 × correction older than the history" in rows[1]
    assert all(part in rows[2] for part in ("hs-is-rejected", "width:100%", ">60</td>", ">7</td>"))
    assert "hs-is-silent" in rows[3]
    assert "4 × &lt;metal&gt;" in rows[3] and "<metal>" not in html


def test_a_bias_stands_between_its_bounds() -> None:
    """In degrees a second, with three sigma, on a track that ends at three sigma of the start."""
    _, state = with_filter()
    covariance = np.diag(np.full(15, math.radians(0.05) ** 2))
    state = state._replace(
        x=np.concatenate([state.x[:10], np.radians([0.5, 0.0, -9.0]), state.x[13:]]), covariance=covariance
    )
    html = biases_html(state, NavigationConfig(gyro_bias_sigma=math.radians(1.0 / 3.0)))
    assert "0.50 <small>± 0.15</small>" in html
    assert 'left:68%;width:15%"></i><b style="left:75%"' in html
    assert 'left:0%;width:0%"></i><b style="left:0%"' in html


def test_the_fusion_shows_what_is_known_of_the_rest() -> None:
    """Three sigma of tilt, heading and height, the speed, and the map's turn once there are satellites."""
    result, state = with_filter()
    html = fusion_html(result, state._replace(x=np.concatenate([state.x[:7], [0.3, 0.4, 0.0], state.x[10:]])))
    assert "0.50 ± 0.03" in html and f"tilt 3σ</small>{math.degrees(0.03):.2f}°" in html
    assert "from east" not in html
    world = PlanarGaussian(np.array([1.0, 2.0, math.pi / 2]), np.diag([1.0, 1.0, math.radians(2.0) ** 2]))
    assert "90° ± 6°" in fusion_html(result._replace(world=world), state)


def test_ellipses_share_a_scale_with_a_round_bar() -> None:
    """The largest fills the drawing, the others keep their ratio and place, and the bar says how long it is."""
    layers = {"prior": planar_gaussian(0.0, 0.0, 0.02, 0.01), "fused": planar_gaussian(0.01, 0.0, 0.004, 0.004)}
    svg = ellipses_svg(layers, layers["prior"])
    radii = [(float(rx), float(ry)) for rx, ry in re.findall(r'rx="([\d.]+)" ry="([\d.]+)"', svg)]
    assert radii[0] == pytest.approx((46.0, 23.0), abs=0.1)
    assert radii[1] == pytest.approx((9.2, 9.2), abs=0.1)
    assert "translate(11.5 -0.0)" in svg or "translate(11.5 0.0)" in svg
    assert "20 mm" in svg
    assert SIGMAS == 2.0


def test_nothing_is_drawn_of_what_is_no_covariance() -> None:
    """Zero, infinite or missing covariances leave the drawing out."""
    for sigma in (0.0, math.inf, math.nan):
        layer = planar_gaussian(0.0, 0.0, sigma, sigma)
        assert ellipses_svg({"fused": layer}, layer) == ""
    assert ellipses_svg({}, planar_gaussian(0.0, 0.0, 1.0, 1.0)) == ""


def test_faults_and_what_was_not_used_are_named() -> None:
    """A line for each, escaped; nothing at all while there is none."""
    assert faults_html(()) == unused_html({}) == ""
    assert faults_html(("the gyro was clipped", "<b>")).count("<p") == 2
    assert "3 × gap in the inertial data" in unused_html({"gap in the inertial data": 3})
    assert all("<b>" not in html for html in (faults_html(("<b>",)), unused_html({"<b>": 1})))
