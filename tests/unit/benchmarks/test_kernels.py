"""What the benchmark of the kernels counts."""

import numpy as np

from benchmarks.kernels import Run, cells, measurements, memory, rates, run
from hectorscope.simulation import SceneOptions
from slam_core.config import MapConfig, SlamConfig
from slam_core.mapping.pyramid import Pyramid
from slam_core.slam import HectorSlam


def test_a_cell_takes_twelve_bytes_at_most() -> None:
    """All arrays of all levels, what pads them included."""
    for levels in (1, 3, 6):
        pyramid = Pyramid(MapConfig(levels=levels, size=2048))
        assert cells(pyramid) == sum((2048 >> i) ** 2 for i in range(levels))
        assert 6.0 < memory(pyramid) / cells(pyramid) <= 12.0


def test_whole_steps_by_the_median_the_best_and_undisturbed() -> None:
    """Three runs of two measurements, one of them a scan: each was the fastest at something."""
    recording = list(measurements(SceneOptions(duration=3.0, beams=61)))
    done = run(HectorSlam(SlamConfig()), recording)
    assert len(done.spent) == len(recording) > len(done.durations) == len(done.written) > 0
    once = done._replace(durations=done.durations[:1])
    runs: list[Run] = [once._replace(spent=np.array(spent) * 1000) for spent in ([4, 6], [8, 2], [3, 11])]
    assert rates(runs) == (100_000.0, 100_000.0, 200_000.0)
