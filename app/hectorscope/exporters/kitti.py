"""trajectory.kitti and times.txt: the upper three rows of T_map_base, one pose a line, and the seconds of each.

The axes are those of the base and the map (REP-103), not those of a camera.
"""

from collections.abc import Callable
from pathlib import Path

from hectorscope.common.paths import write_whole
from hectorscope.exporters import Exporter
from hectorscope.exporters._files import lines_of
from hectorscope.exporters._lines import Draft
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
    for name, line in LINES.items():
        write_whole(folder / name, lines_of(run.trajectory, line))


def _drafts(folder: Path) -> tuple[Draft, ...]:
    def draft(name: str, line: Callable[[list[float]], str]) -> Draft:
        return Draft(folder / name, lambda pipeline, first: lines_of(pipeline.trajectory[first:], line))

    return tuple(draft(name, line) for name, line in LINES.items())


LINES = {"trajectory.kitti": kitti_line, "times.txt": lambda row: f"{row[0]:.9f}\n"}
EXPORTER = Exporter("kitti", tuple(LINES), _write, order=20, drafts=_drafts)
