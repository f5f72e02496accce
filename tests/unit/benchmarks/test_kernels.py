"""What the benchmark of the kernels counts."""

from benchmarks.kernels import cells, memory
from slam_core.config import MapConfig
from slam_core.pyramid import Pyramid


def test_a_cell_takes_twelve_bytes_at_most() -> None:
    """All arrays of all levels, what pads them included."""
    for levels in (1, 3, 6):
        pyramid = Pyramid(MapConfig(levels=levels))
        assert cells(pyramid) == sum((1024 >> i) ** 2 for i in range(levels))
        assert 6.0 < memory(pyramid) / cells(pyramid) <= 12.0
