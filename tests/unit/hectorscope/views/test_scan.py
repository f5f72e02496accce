"""The scan as it is sent: where its points lie in the map, whatever the browser has drawn of it by then."""

from dataclasses import replace

import numpy as np

from hectorscope.page.scene import Scene
from hectorscope.views.scan import LIFT, ScanView
from slam_core.geometry import transform_points
from tests.page import room_snapshot


def test_points_are_turned_into_the_map(scene: Scene) -> None:
    """The node takes the place alone: one that turns before its points are drawn shows them beside their walls."""
    view, snapshot = ScanView(scene), room_snapshot()
    result = snapshot.result
    assert result is not None
    planar = np.array([1.5, -2.0, 0.7])
    view.draw(replace(snapshot, result=result._replace(planar=planar)))
    ends = np.asarray(view._cloud.points, np.float64) + view._frame.position
    assert np.allclose(ends[:, :2], transform_points(planar, result.points), atol=2e-3)
    assert np.allclose(ends[:, 2], LIFT, atol=1e-3)
    assert view._frame.wxyz.tolist() == [1.0, 0.0, 0.0, 0.0]
