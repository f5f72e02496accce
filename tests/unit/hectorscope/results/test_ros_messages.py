"""What the diagnostics and the covariance of the result MCAP say."""

import numpy as np
import pytest

from hectorscope.results.ros_messages import ERROR, OK, WARN, covariance, diagnostics
from slam_core.results import Rejection, Tracking, Verdict
from tests.page import step_result


@pytest.mark.parametrize(
    ("state", "level"), [("tracking", OK), ("recovered", OK), ("degraded", WARN), ("lost", ERROR)]
)
def test_the_level_follows_the_tracking(state: Tracking, level: int):
    """The reason of a rejected match is its message; each warning is a status of its own."""
    rejection = Rejection("overlap", 0.2, 0.5) if level else None
    result = step_result()._replace(verdict=Verdict(state, rejection))
    told, warning = diagnostics(result, {"residual": 0.25}, ["the gyro was clipped"]).status
    assert told.level == level
    assert told.message == ("only 20% of the scan lie where the map is known; 50% are needed" if level else state)
    assert [(pair.key, pair.value) for pair in told.values] == [("residual", "0.25")]
    assert (warning.level, warning.message) == (WARN, "the gyro was clipped")


def test_without_a_filter_the_pose_in_the_plane_alone_is_uncertain():
    """Height, roll and pitch are given, so their variances are 0."""
    result = step_result()._replace(navigation=None)
    P = covariance(result)
    np.testing.assert_array_equal(P[np.ix_([0, 1, 5], [0, 1, 5])], result.fused.covariance)
    assert not P[2:5].any()
    assert not P[:, 2:5].any()
