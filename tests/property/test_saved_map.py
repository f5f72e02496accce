"""A map that is saved and loaded is the same map."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hectorscope.maps.saved_map import load_map, to_npz
from slam_core.config import MapConfig
from slam_core.localization.prior_map import saved_levels
from slam_core.mapping.pyramid import Pyramid
from tests.worlds import same_map


@settings(max_examples=30)
@given(st.integers(0, 10**6), st.integers(1, 4), st.sampled_from([64, 200, 512]), st.integers(1, 25))
def test_loading_undoes_saving(
    tmp_path_factory: pytest.TempPathFactory, seed: int, levels: int, size: int, scans: int
):
    """Every cell of every level, what the matcher reads, and what a further scan makes of it, to the last bit."""
    rng, config = np.random.default_rng(seed), MapConfig(levels=levels, size=128)
    pyramid = Pyramid(config)
    for _ in range(scans):
        _write(pyramid, rng, config)
    file = tmp_path_factory.mktemp("maps") / "map.npz"
    file.write_bytes(to_npz(saved_levels(pyramid)))
    given = load_map(file, config)
    assert to_npz(given.levels) == file.read_bytes()
    again = given.pyramid(MapConfig(levels=levels, size=size))
    assert same_map(pyramid, again)
    assert to_npz(saved_levels(again)) == file.read_bytes()
    state = rng.bit_generator.state
    for each in (pyramid, again):
        rng.bit_generator.state = state
        _write(each, rng, config)
    assert same_map(pyramid, again)


def test_a_map_of_kilometres_is_saved_in_parts(tmp_path: Path):
    """What was seen, and not the box around it; loading gives every cell back."""
    rng, config = np.random.default_rng(4), MapConfig(size=128)
    pyramid = Pyramid(config)
    for x, y in ((0.0, 0.0), (900.0, 20.0), (900.0, 800.0)):
        _write(pyramid, rng, config, np.array([x, y]))
    levels = saved_levels(pyramid)
    assert len(levels) > 6
    assert sum(level.log_odds.size for level in levels) < 0.01 * np.prod(np.diff(pyramid.bounds())[::2])
    (tmp_path / "map.npz").write_bytes(to_npz(levels))
    again = load_map(tmp_path, config).pyramid(config)
    assert again.bounds() != pyramid.bounds()  # of whole tiles
    for level in range(3):
        for box, log_odds in pyramid.pieces(level):
            assert again.gather(level, box).tobytes() == log_odds.tobytes()
    assert set(again.changed_since(0)) == set(pyramid.changed_since(0))


def _write(pyramid: Pyramid, rng: np.random.Generator, config: MapConfig, place: np.ndarray | None = None) -> None:
    """One scan of noise and of a wall, somewhere, or at a place (2,)."""
    points, cleared = (rng.uniform(-6, 6, (n, 2)).astype(np.float32) for n in (40, 5))
    wall = np.linspace(rng.uniform(-6, 6, 2), rng.uniform(-6, 6, 2), 60, dtype=np.float32)
    points = np.concatenate([points, wall])
    pose = rng.uniform([-15, -15, -3], [15, 15, 3])
    if place is not None:
        pose[:2] = place
    pyramid.update(points, cleared, rng.uniform(-0.2, 0.2, 2), pose, config)
