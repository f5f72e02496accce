"""How large ellipses are drawn."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.page.ellipse_scale import LARGEST, SHARE, SMALLEST, fitted, map_side
from hectorscope.page.scene import ELLIPSE_SCALE_RANGE, Scene
from hectorscope.panels.display import DisplayPanel
from hectorscope.session.snapshot import Snapshot
from tests.page import room_snapshot


def with_sigma(sigma: float) -> Snapshot:
    """The room with this standard deviation of the prior along x, metres; the other ones are small."""
    snapshot = room_snapshot()
    series = snapshot.series.copy()
    series["prior_sigma_x"], series["match_sigma_x"] = sigma, 0.1 * sigma
    return replace(snapshot, series=series)


@given(st.floats(1e-3, 0.5), st.floats(*ELLIPSE_SCALE_RANGE))
def test_the_largest_ellipse_is_well_seen_in_the_map(sigma: float, now: float) -> None:
    """Neither a point nor half of the map; where the present number suits, it stays."""
    snapshot = with_sigma(sigma)
    scale, side = fitted(snapshot, now), map_side(snapshot)
    if SMALLEST <= now * sigma / side <= LARGEST:
        assert scale == now
    else:
        assert SHARE / 2.5 < scale * sigma / side <= SHARE * 1.001 or scale in ELLIPSE_SCALE_RANGE


@pytest.mark.parametrize("snapshot", [Snapshot(), room_snapshot()], ids=["nothing", "no covariance"])
def test_without_a_covariance_the_scale_stays(snapshot: Snapshot) -> None:
    """Before the first match, for one."""
    assert fitted(snapshot, 200.0) == 200.0


def test_a_scale_that_was_chosen_by_hand_is_held(scene: Scene) -> None:
    """It follows the covariances until then, and again once it is asked to."""
    panel = DisplayPanel(scene)
    panel.draw(with_sigma(0.5))
    fitting = scene.display.ellipse_scale
    assert fitting < 200.0
    scene.show(ellipse_scale=123.0, ellipse_fit=False)
    panel.draw(with_sigma(0.5))
    assert scene.display.ellipse_scale == 123.0
    scene.show(ellipse_fit=True)
    panel.draw(with_sigma(0.5))
    assert scene.display.ellipse_scale == fitting
