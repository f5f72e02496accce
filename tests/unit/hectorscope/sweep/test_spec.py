"""Specs and summaries as plain values."""

import pickle
from dataclasses import replace

import pytest

from hectorscope.inputs import SourceOptions
from hectorscope.run.settings import Change
from hectorscope.sweep.spec import RunSpec, RunSummary, differing
from slam_core.config import SlamConfig, with_values

SPEC = RunSpec(
    "a.bag",
    "/data/a.bag",
    {"matcher.sigma": 0.2, "fusion.method": "kalman"},
    ((5, "fusion.omega", 0.1),),
    {"laser_pose": (0.1, 0.0, 0.2, 0.0, 0.0, 0.0), "imu_topic": "none"},
    repair=True,
)
SUMMARY = RunSummary(
    "ok", figures={"consistency": 0.9, "truth.poses": None}, extent=(0.0, 1.0), path=((0.0, 1.0),)
)


def test_values_go_through_json_and_pickle():
    """They come out equal: a worker gets what was sent."""
    assert RunSpec.from_json(SPEC.as_json()) == SPEC == pickle.loads(pickle.dumps(SPEC))
    assert RunSummary.from_json(SUMMARY.as_json()) == SUMMARY == pickle.loads(pickle.dumps(SUMMARY))


def test_a_spec_makes_settings_and_options():
    """Those that were stated; the others are the defaults."""
    settings = SPEC.run_settings()
    assert settings.start == with_values(SlamConfig(), SPEC.settings)
    assert settings.changes == (Change(5, "fusion.omega", 0.1),)
    assert SPEC.source_options() == SourceOptions(imu_topic="none", laser_pose=(0.1, 0.0, 0.2, 0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    "change",
    [
        {"path": "/other.bag"},
        {"settings": {}},
        {"changes": ()},
        {"options": {}},
        {"repair": False},
        {"share": 0.5},
        {"relations": "/a"},
    ],
)
def test_another_run_has_another_key(change: dict[str, object]):
    """Whatever differs but the name, and the order in which settings were given."""
    assert replace(SPEC, **change).key != SPEC.key  # type: ignore[arg-type]
    assert replace(SPEC, recording="./a.bag").key == SPEC.key
    assert replace(SPEC, settings=dict(reversed(SPEC.settings.items()))).key == SPEC.key


def test_a_value_that_is_not_stated_is_the_default():
    """For the columns of a table."""
    assert SPEC.value("matcher.sigma") == 0.2
    assert SPEC.value("fusion.omega") == SlamConfig().fusion.omega
    assert SPEC.value("sensors.imu_topic") == "none"
    assert SPEC.value("sensors.scan_delay") is None


def test_a_configuration_is_kept_by_what_differs():
    """From the defaults."""
    assert differing(SlamConfig()) == {}
    assert differing(with_values(SlamConfig(), {"map.levels": 2})) == {"map.levels": 2}
