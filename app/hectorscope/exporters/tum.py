"""trajectory.tum: `t x y z qx qy qz qw`, one pose a line; t in seconds."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hectorscope.common.paths import write_whole
from hectorscope.exporters import Exporter
from hectorscope.exporters._files import exact_seconds, lines_of
from hectorscope.exporters._lines import Draft
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.results import Run

NAME = "trajectory.tum"


def tum_lines(start_ns: int, trajectory: NDArray[np.float64]) -> Iterator[bytes]:
    """The file, some lines at a time."""

    def line(row: list[float]) -> str:
        seconds, x, y, z, qw, qx, qy, qz = row
        pose = " ".join(f"{value:.9f}" for value in (x, y, z, qx, qy, qz, qw))
        return f"{exact_seconds(start_ns, seconds)} {pose}\n"

    return lines_of(trajectory, line)


def _write(run: Run, folder: Path) -> None:
    write_whole(folder / NAME, tum_lines(run.start_ns, run.trajectory))


def _drafts(folder: Path) -> tuple[Draft]:
    def lines(pipeline: Pipeline, first: int) -> Iterator[bytes]:
        return tum_lines(pipeline.start_ns or 0, pipeline.trajectory[first:])

    return (Draft(folder / NAME, lines),)


EXPORTER = Exporter("tum", (NAME,), _write, order=20, default=True, drafts=_drafts)
