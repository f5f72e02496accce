"""The fast core agrees with the paper in plain numpy on a real recording."""

from pathlib import Path

import numpy as np
import pytest

from hectorscope.inputs import SourceOptions
from hectorscope.sources import open_source
from slam_core.config import SlamConfig, with_value
from tests.integration.test_reference import both, check_matches

pytestmark = pytest.mark.real
# Without inertial data the reference starts each match at the last pose.
CONFIG = with_value(SlamConfig.paper(), "matcher.start_estimate", "last_pose")


def test_matches_agree_on_a_wheeled_robot(recordings: Path):
    """jackal_vicon by its laser alone: poses, covariances, keyframes, and all but one cell in a thousand."""
    path = recordings / "jackal_vicon" / "test_2026-02-17-15-54-31.bag"
    pairs, fast, reference = both(open_source(str(path), SourceOptions()).items(), CONFIG)
    check_matches(pairs)
    differ = np.abs(fast.map.levels[0].log_odds - reference.map.levels[0].log_odds) > 1e-3
    assert np.count_nonzero(differ) <= 1e-3 * np.count_nonzero(reference.map.levels[0].log_odds)
