"""trajectory.tum: `t x y z qx qy qz qw`, one pose a line; t in seconds."""

from pathlib import Path

from hectorscope.exporters import Exporter
from hectorscope.exporters._files import exact_seconds, write_whole
from hectorscope.run.results import Run


def tum_lines(run: Run) -> str:
    """The whole file."""
    lines = []
    for seconds, x, y, z, qw, qx, qy, qz in run.trajectory.tolist():
        pose = " ".join(f"{value:.9f}" for value in (x, y, z, qx, qy, qz, qw))
        lines.append(f"{exact_seconds(run.start_ns, seconds)} {pose}\n")
    return "".join(lines)


def _write(run: Run, folder: Path) -> None:
    write_whole(folder / "trajectory.tum", tum_lines(run).encode())


EXPORTER = Exporter(("trajectory.tum",), _write, order=0)
