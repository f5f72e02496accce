"""What a run leaves behind: rows that are there when somebody asks, however often that is."""

import numpy as np

from hectorscope.run.pipeline import TOGETHER, Pipeline
from hectorscope.run.series import SERIES_FIELDS
from hectorscope.run.settings import Settings
from hectorscope.simulation import SceneOptions, Simulation

ITEMS = list(Simulation("rooms", SceneOptions(duration=4.0, beams=181)).items())
MEASURED = [k for k, name in enumerate(SERIES_FIELDS) if not name.endswith("_ms")]  # all but the time it took


def test_rows_do_not_depend_on_who_asked_for_them_when() -> None:
    """One run is asked for its rows after every scan, the other at its end: they are the same, and stay so."""
    asked, left = Pipeline(Settings(), 0), Pipeline(Settings(), 0)
    seen = []
    for item in ITEMS:
        for pipeline in (asked, left):
            for measurement in pipeline.admit(item):
                pipeline.step(measurement)
        assert len(asked.trajectory) == len(asked.series) == asked.scans == left.scans
        seen.append((asked.trajectory, asked.trajectory.copy()))
    assert left.scans > 2 * TOGETHER and left.scans % TOGETHER
    assert np.array_equal(asked.trajectory, left.trajectory)
    assert np.array_equal(asked.series[:, MEASURED], left.series[:, MEASURED], equal_nan=True)
    assert all(np.array_equal(view, rows) for view, rows in seen)
