"""Localising in the map of a recording's own first run."""

from pathlib import Path

import numpy as np
import pytest

from hectorscope.exporters import export
from hectorscope.inputs import SourceOptions
from hectorscope.maps.saved_map import load_map
from hectorscope.run.headless import run_headless
from hectorscope.run.metrics import truth_errors
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.sources import open_source
from slam_core.config import SlamConfig
from slam_core.localization.prior_map import PriorMap

pytestmark = pytest.mark.real

JACKAL = "jackal_vicon/test_2026-02-17-15-54-31"


def run(path: Path, given: PriorMap | None = None) -> Pipeline:
    """The whole recording, in a given map or with a new one."""
    return run_headless(open_source(str(path), SourceOptions()), Settings(), prior_map=given)[0]


@pytest.mark.parametrize("start", [None, (0.0, 0.0, 0.0), (2.0, -1.5, -2.5)])
@pytest.mark.parametrize("name", ["map.npz", "map.yaml"])
def test_jackal_is_localised_from_anywhere_in_its_own_map(
    recordings: Path, tmp_path: Path, name: str, start: tuple[float, float, float] | None
):
    """By search, from the origin and from a wrong pose, in the exact map and in its image, from two containers.

    At most 0.016 m from motion capture after alignment, every scan tracked, and the same bytes from both.
    """
    export(run(recordings / f"{JACKAL}.bag"), {}, tmp_path)
    told = None if start is None else np.array(start)
    given = load_map(tmp_path / name, SlamConfig().map, start=told)
    first, other = (run(recordings / f"{JACKAL}{suffix}", given) for suffix in (".bag", "_mcap"))
    errors = truth_errors(first.trajectory, first.truth)
    assert errors is not None
    assert errors["aligned_rmse_m"] < 0.016
    assert set(first.states) == {"tracking"}
    assert first.scans == 414
    assert first.trajectory.tobytes() == other.trajectory.tobytes()
    assert np.hypot(*first.trajectory[0, 1:3]) < 0.03
