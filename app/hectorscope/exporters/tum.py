"""trajectory.tum: `t x y z qx qy qz qw`, one pose a line; t in seconds."""

from collections.abc import Iterator
from pathlib import Path

from hectorscope.exporters import Exporter
from hectorscope.exporters._files import exact_seconds, lines_of, write_whole
from hectorscope.run.results import Run


def tum_lines(run: Run) -> Iterator[bytes]:
    """The file, some lines at a time."""

    def line(row: list[float]) -> str:
        seconds, x, y, z, qw, qx, qy, qz = row
        pose = " ".join(f"{value:.9f}" for value in (x, y, z, qx, qy, qz, qw))
        return f"{exact_seconds(run.start_ns, seconds)} {pose}\n"

    return lines_of(run.trajectory, line)


def _write(run: Run, folder: Path) -> None:
    write_whole(folder / "trajectory.tum", tum_lines(run))


EXPORTER = Exporter("tum", ("trajectory.tum",), _write, order=20, default=True)
