"""trajectory.kitti and times.txt: the upper three rows of T_map_base, one pose a line, and the seconds of each.

The axes are those of the base and the map (REP-103), not those of a camera.
"""

from pathlib import Path

from hectorscope.exporters import Exporter
from hectorscope.exporters._files import lines_of, write_whole
from hectorscope.run.results import Run


def kitti_line(row: list[float]) -> str:
    """Twelve numbers of a row of the trajectory: the rotation matrix with the position as its fourth column."""
    _, x, y, z, qw, qx, qy, qz = row
    matrix = (
        (1.0 - 2.0 * (qy * qy + qz * qz), 2.0 * (qx * qy - qw * qz), 2.0 * (qx * qz + qw * qy), x),
        (2.0 * (qx * qy + qw * qz), 1.0 - 2.0 * (qx * qx + qz * qz), 2.0 * (qy * qz - qw * qx), y),
        (2.0 * (qx * qz - qw * qy), 2.0 * (qy * qz + qw * qx), 1.0 - 2.0 * (qx * qx + qy * qy), z),
    )
    return " ".join(f"{value:.9f}" for line in matrix for value in line) + "\n"


def _write(run: Run, folder: Path) -> None:
    write_whole(folder / "trajectory.kitti", lines_of(run.trajectory, kitti_line))
    write_whole(folder / "times.txt", lines_of(run.trajectory[:, :1], lambda row: f"{row[0]:.9f}\n"))


EXPORTER = Exporter("kitti", ("trajectory.kitti", "times.txt"), _write, order=20)
