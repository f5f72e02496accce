"""How the robot turned, by its scans alone."""

import numpy as np

from hectorscope.checks.matched_scans import MatchedScans
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.measurements import LaserScan


def test_the_heading_is_known_where_no_beam_fixes_the_way_along_a_corridor() -> None:
    """The state is degraded there after a while, by the position alone."""
    matched = MatchedScans()
    drive = Simulation("corridor", SceneOptions(scan_rate=10.0, beams=541, duration=90.0))
    for item in drive.items():
        if isinstance(item, LaserScan) and len(matched.scans) < 100:
            matched.add(item)
    headings = matched.headings(matched.scans[0].stamp_ns)
    assert len(headings) == 100
    assert np.abs(headings[:, 1]).max() < 0.02
