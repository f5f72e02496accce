"""Relations of Kuemmerle et al. in a file: a line each, `time1 time2 x y z roll pitch yaw`."""

import math
from pathlib import Path

import numpy as np

from hectorscope.inputs import SourceError
from slam_core.evaluation.relations import Relations, relation_error
from slam_core.evaluation.trajectory import Trajectory
from slam_core.measurements import Float64s

COLUMNS = 8


def read_relations(path: Path) -> Relations:
    """Of a file, with times in seconds as the recording has them; SourceError names a bad line.

    The motion is taken in the plane: z, roll and pitch are passed over, as are empty lines and those with a #.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        raise SourceError(f"--relations {path} cannot be read ({reason}): give a file of relations") from error
    rows = [_row(path, number, line) for number, line in enumerate(lines, 1) if line.partition("#")[0].strip()]
    if not rows:
        raise SourceError(f"--relations {path} holds no relation: give lines of time1 time2 x y z roll pitch yaw")
    table = np.array(rows)
    return Relations(table[:, :2], table[:, [2, 3, 7]])


def _row(path: Path, number: int, line: str) -> list[float]:
    words = line.partition("#")[0].split()
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = []
    if len(values) != COLUMNS or not all(map(math.isfinite, values)):
        raise SourceError(
            f"--relations {path}, line {number} is {line[:60]!r}: write time1 time2 x y z roll pitch yaw"
        )
    return values


def relation_figures(trajectory: Float64s, start_ns: int, relations: Relations) -> dict[str, float]:
    """`relation_error` of a trajectory (n, 8), whose seconds count from `start_ns`, in metres and degrees.

    `given` and `used` are numbers of relations; the errors are missing if the trajectory covers none.
    """
    counted = Relations(relations.times - start_ns / 1e9, relations.motions)
    error = relation_error(Trajectory.from_rows(trajectory), counted)
    if error is None:
        return {"given": len(relations), "used": 0}
    figures = {
        "translation_mean_m": error.translation_mean,
        "translation_std_m": error.translation_std,
        "rotation_mean_deg": math.degrees(error.rotation_mean),
        "rotation_std_deg": math.degrees(error.rotation_std),
    }
    return {"given": len(relations), "used": error.used, **{name: round(v, 6) for name, v in figures.items()}}
