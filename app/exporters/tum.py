"""trajectory.tum: `t x y z qx qy qz qw`, one pose a line; t in seconds."""

from pathlib import Path

from app.exporters import Exporter, Run
from app.exporters._files import write_whole


def tum_lines(run: Run) -> str:
    """The whole file. Times are exact nanoseconds, not rounded to what a float of a date can hold."""
    lines = []
    for seconds, x, y, z, qw, qx, qy, qz in run.trajectory.tolist():
        stamp_ns = run.start_ns + round(seconds * 1e9)
        pose = " ".join(f"{value:.9f}" for value in (x, y, z, qx, qy, qz, qw))
        lines.append(f"{stamp_ns // 10**9}.{stamp_ns % 10**9:09d} {pose}\n")
    return "".join(lines)


def _write(run: Run, folder: Path) -> None:
    write_whole(folder / "trajectory.tum", tum_lines(run).encode())


EXPORTER = Exporter(("trajectory.tum",), _write)
