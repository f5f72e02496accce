"""The demo recordings in the repository are what the simulator makes today."""

from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

from hectorscope.simulation import ScenarioName, Simulation
from slam_core.measurements import LaserScan, TruthPose

FOLDER = Path(__file__).resolve().parents[2] / "demo_bags"
RECORDINGS: list[tuple[ScenarioName, str]] = [
    ("arena", "arena.bag"),
    ("littoral", "littoral.mcap"),
    ("handheld", "handheld"),
]


def messages(name: str, topic: str, count: int) -> list[Any]:
    with AnyReader([FOLDER / name]) as reader:
        wanted = [c for c in reader.connections if c.topic == topic]
        return [reader.deserialize(raw, c.msgtype) for c, _, raw in islice(reader.messages(wanted), count)]


@pytest.mark.parametrize(("scenario", "name"), RECORDINGS)
def test_the_simulator_still_makes_them(scenario: ScenarioName, name: str) -> None:
    """The first 10 s of truth and of scans agree, up to the rounding of another machine."""
    items = list(islice(Simulation(scenario).items(), 2500))
    poses = [item.T_map_base.translation for item in items if isinstance(item, TruthPose)]
    recorded = [m.pose.position for m in messages(name, "/ground_truth", len(poses))]
    np.testing.assert_allclose([(p.x, p.y, p.z) for p in recorded], poses, atol=1e-6)
    scans = np.array([item.ranges for item in items if isinstance(item, LaserScan)])
    ranges = np.array([m.ranges for m in messages(name, "/scan", len(scans))])
    assert len(scans) > 300
    assert np.mean(np.isclose(ranges, scans, atol=1.1e-3, rtol=0.0)) > 0.9999


@pytest.mark.parametrize(("scenario", "name"), RECORDINGS)
def test_length_and_size(scenario: ScenarioName, name: str) -> None:
    """45 to 60 s in at most 8 MB a file."""
    path = FOLDER / name
    files = list(path.iterdir()) if path.is_dir() else [path]
    assert max(file.stat().st_size for file in files) <= 8_000_000
    with AnyReader([path]) as reader:
        seconds = reader.duration * 1e-9
    assert 45.0 <= seconds <= 60.1
    assert seconds == pytest.approx(Simulation(scenario).duration, abs=0.1)


def test_the_readme_names_each_command() -> None:
    """Whoever wants to make them again finds how."""
    text = (FOLDER / "README.md").read_text(encoding="utf-8")
    for scenario, name in RECORDINGS:
        assert f"hectorscope simulate --scenario {scenario} --out demo_bags/{name}\n" in text
