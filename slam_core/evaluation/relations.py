"""The metric of relations of Kuemmerle et al. (2009): how far motions between two times are from the true ones."""

from dataclasses import dataclass

import numpy as np

from slam_core.evaluation.trajectory import Trajectory, between, interpolate
from slam_core.measurements import Float64s


@dataclass(frozen=True, slots=True, eq=False)
class Relations:
    """True motions of the base.

    times: (n, 2) seconds, from and to. motions: (n, 3) x, y, yaw of the second pose, seen from the first.
    """

    times: Float64s
    motions: Float64s

    def __len__(self) -> int:
        return len(self.times)


@dataclass(frozen=True, slots=True)
class RelationError:
    """Mean and standard deviation of the absolute errors over `used` relations: metres and radians."""

    used: int
    translation_mean: float
    translation_std: float
    rotation_mean: float
    rotation_std: float


def relation_error(estimate: Trajectory, relations: Relations) -> RelationError | None:
    """The errors of the motions of `estimate` in the plane, |trans| and |rot| of delta_ij (-) delta*_ij.

    Poses between two of the estimate are interpolated. A relation counts if the estimate covers both of its times;
    None if it covers no relation.
    """
    ends = [interpolate(estimate, relations.times[:, side]) for side in (0, 1)]
    both = ends[0][1] & ends[1][1]
    if not both.any():
        return None
    first, second = (poses.planar[both[covered]] for poses, covered in ends)
    errors = between(relations.motions[both], between(first, second))
    distances, turns = np.hypot(errors[:, 0], errors[:, 1]), np.abs(errors[:, 2])
    return RelationError(
        used=int(np.count_nonzero(both)),
        translation_mean=float(distances.mean()),
        translation_std=float(distances.std()),
        rotation_mean=float(turns.mean()),
        rotation_std=float(turns.std()),
    )
