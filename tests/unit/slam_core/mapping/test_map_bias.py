"""A map written at the true poses must not pull the next scan to one side."""

import numpy as np
import pytest

from slam_core.config import MapConfig, MatcherConfig
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import coarse_to_fine

NONE, LASER = np.empty((0, 2), np.float32), np.zeros(2)
AHEAD, ASIDE = 4.0, 3.0  # metres to the walls


def noisy_scan(pose, rng):
    """Endpoints on a wall ahead and one on either side, none behind, with 1 cm of noise along the beams."""
    angles = np.linspace(-2.0, 2.0, 721)
    cosines, sines = np.cos(angles + pose[2]), np.sin(angles + pose[2])
    with np.errstate(divide="ignore"):
        ahead = np.where(cosines > 0, (AHEAD - pose[0]) / cosines, np.inf)
        aside = (ASIDE - pose[1] * np.sign(sines)) / np.abs(sines)
    ranges = np.minimum(ahead, aside) + rng.normal(scale=0.01, size=len(angles))
    return (ranges[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])).astype(np.float32)


def pull_ahead(config, tilt):
    """Mean error (m) ahead of matches in a map written at the true poses; walls at `tilt` to the cells."""
    rng = np.random.default_rng(1)
    pyramid, errors = Pyramid(config), []
    for k in range(60):
        pose = np.array([*rng.uniform(-0.5, 0.5, 2), 0.0])
        placed = np.array([*turned(pose[:2], tilt), tilt])
        points = noisy_scan(pose, rng)
        if k < 40:
            pyramid.update(points, NONE, LASER, placed, config)
        else:
            match = coarse_to_fine(pyramid, points, placed, MatcherConfig())
            errors.append(turned(match.pose[:2] - placed[:2], -tilt)[0])
    return np.mean(errors)


def turned(xy, angle):
    """A vector in other axes."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * xy[0] - s * xy[1], s * xy[0] + c * xy[1]])


@pytest.mark.parametrize("tilt", [0.3, 1.1])
def test_sharp_backs_of_walls_do_not_pull_the_robot_ahead(tilt):
    """Noise thickens walls to the back only; with the cells behind hits kept low the pull is a third or less."""
    paper = pull_ahead(MapConfig(size=512, factor_behind=0.5), tilt)
    sharp = pull_ahead(MapConfig(size=512), tilt)
    assert paper > 0.002
    assert abs(sharp) < paper / 3
