"""How far an estimated trajectory is from the truth: in position, in height, in attitude, over a stretch."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam_core.measurements import Float64s

MAX_GAP_S = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """Poses of the base over time.

    times: (n,) seconds, ascending. positions: (n, 3) metres. rotations: (n, 4) unit quaternions w, x, y, z.
    """

    times: Float64s
    positions: Float64s
    rotations: Float64s

    @classmethod
    def from_rows(cls, rows: Float64s) -> "Trajectory":
        """From (n, 8) rows of time, x, y, z, qw, qx, qy, qz, sorted by time, each time once."""
        _, first = np.unique(rows[:, 0], return_index=True)
        return cls(rows[first, 0], rows[first, 1:4], rows[first, 4:8])

    def __len__(self) -> int:
        return len(self.times)

    def select(self, mask: NDArray[np.bool_]) -> "Trajectory":
        """The poses where `mask` (n,) holds."""
        return Trajectory(self.times[mask], self.positions[mask], self.rotations[mask])

    @property
    def planar(self) -> Float64s:
        """(n, 3) x, y and yaw."""
        return np.column_stack([self.positions[:, :2], euler_angles(self.rotations)[:, 2]])


@dataclass(frozen=True, slots=True)
class TrajectoryError:
    """Root mean square errors over `poses` poses that the truth covers.

    raw: metres in the plane, truth's first pose put on the estimate's first. aligned: metres, after the best
    rigid motion of the plane. height: metres over the first. roll, pitch: radians. None where the
    estimate or the truth is planar.
    """

    poses: int
    raw: float
    aligned: float
    height: float | None
    roll: float | None
    pitch: float | None


def evaluate(estimate: Trajectory, truth: Trajectory) -> TrajectoryError | None:
    """All errors of `estimate` against `truth`; None when they share fewer than three instants."""
    reference, covered = interpolate(truth, estimate.times)
    ours = estimate.select(covered)
    if len(ours) < 3:
        return None
    planar, target = ours.planar, reference.planar
    raw = move(first_on_first(target, planar), target)
    best = move(align(target[:, :2], planar[:, :2]), target)
    heights = (ours.positions[:, 2] - ours.positions[0, 2]) - (
        reference.positions[:, 2] - reference.positions[0, 2]
    )
    tilt = tilt_errors(ours.rotations, reference.rotations)
    level = any(not np.ptp(euler_angles(each.rotations)[:, :2]) for each in (ours, truth))
    flat = any(not np.ptp(each.positions[:, 2]) for each in (ours, truth))
    return TrajectoryError(
        poses=len(ours),
        raw=rms(np.hypot(*(planar - raw)[:, :2].T)),
        aligned=rms(np.hypot(*(planar - best)[:, :2].T)),
        height=None if flat else rms(heights),
        roll=None if level else rms(tilt[:, 0]),
        pitch=None if level else rms(tilt[:, 1]),
    )


def interpolate(
    truth: Trajectory, times: Float64s, max_gap: float = MAX_GAP_S
) -> tuple[Trajectory, NDArray[np.bool_]]:
    """Truth at those of `times` (n,) that lie within it and not inside a gap longer than `max_gap` seconds.

    Positions by straight lines, rotations along the great arc. Returns the poses and the mask (n,) of times used.
    """
    if len(truth) < 2:
        return truth.select(np.zeros(len(truth), bool)), np.zeros(len(times), bool)
    after = np.clip(np.searchsorted(truth.times, times), 1, len(truth) - 1)
    start, gap = truth.times[after - 1], truth.times[after] - truth.times[after - 1]
    known = (gap <= max_gap) | (times == truth.times[after]) | (times == start)
    covered = (times >= truth.times[0]) & (times <= truth.times[-1]) & known
    after = after[covered]
    share = ((times - start) / gap)[covered, None]
    positions = (1 - share) * truth.positions[after - 1] + share * truth.positions[after]
    rotations = slerp(truth.rotations[after - 1], truth.rotations[after], share)
    return Trajectory(times[covered], positions, rotations), covered


def slerp(a: Float64s, b: Float64s, share: Float64s) -> Float64s:
    """Unit quaternions (n, 4) on the shorter arc from `a` (share 0) to `b` (share 1); share: (n, 1)."""
    cosine = np.sum(a * b, axis=1, keepdims=True)
    b = np.where(cosine < 0, -b, b)
    angle = np.arccos(np.clip(np.abs(cosine), 0.0, 1.0))
    # sin(share * angle) / sin(angle), which tends to the share itself for equal rotations
    small = angle < 1e-6
    sine = np.where(small, 1.0, np.sin(angle))
    from_a = np.where(small, 1 - share, np.sin((1 - share) * angle) / sine)
    from_b = np.where(small, share, np.sin(share * angle) / sine)
    mixed = from_a * a + from_b * b
    norm: Float64s = np.linalg.norm(mixed, axis=1, keepdims=True)
    return mixed / norm


def align(source: Float64s, target: Float64s) -> Float64s:
    """The rigid motion (3,) x, y, yaw of least squares that carries points `source` (n, 2) onto `target` (n, 2).

    Closed form of Umeyama without scale: in the plane the best angle is that of the summed cross and dot products.
    """
    source_mean, target_mean = source.mean(axis=0), target.mean(axis=0)
    a, b = source - source_mean, target - target_mean
    yaw = np.arctan2(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]), np.sum(a * b))
    x, y = target_mean - _rotation(yaw) @ source_mean
    return np.array([x, y, yaw])


def first_on_first(source: Float64s, target: Float64s) -> Float64s:
    """The rigid motion (3,) that carries the first of the planar poses `source` (n, 3) onto that of `target`."""
    yaw = float(target[0, 2] - source[0, 2])
    x, y = target[0, :2] - _rotation(yaw) @ source[0, :2]
    return np.array([x, y, yaw])


def move(motion: Float64s, poses: Float64s) -> Float64s:
    """Planar poses (n, 3) after the rigid motion (3,) x, y, yaw."""
    xy = poses[:, :2] @ _rotation(motion[2]).T + motion[:2]
    return np.column_stack([xy, wrap(poses[:, 2] + motion[2])])


def relative_errors(estimate: Float64s, truth: Float64s, along: Float64s, step: float) -> Float64s:
    """Error of the motion over every stretch of length `step`: (m, 3) x, y, yaw in the frame of its beginning.

    estimate, truth: (n, 3) planar poses at the same instants. along: (n,) ascending, what a stretch is measured
    by: seconds, or metres of path (`path_length`).
    """
    end = np.searchsorted(along, along + step)
    begin = np.flatnonzero(end < len(along))
    end = end[begin]
    return between(between(truth[begin], truth[end]), between(estimate[begin], estimate[end]))


def path_length(positions: Float64s) -> Float64s:
    """(n,) metres travelled up to each of the positions (n, 2) or (n, 3)."""
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def tilt_errors(estimate: Float64s, truth: Float64s) -> Float64s:
    """(n, 2) differences of roll and pitch, radians, of unit quaternions (n, 4); independent of the heading."""
    return wrap(euler_angles(estimate) - euler_angles(truth))[:, :2]


def euler_angles(rotations: Float64s) -> Float64s:
    """(n, 3) roll, pitch, yaw (turned about z, then y, then x) of unit quaternions (n, 4) w, x, y, z."""
    w, x, y, z = rotations.T
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return np.column_stack([roll, pitch, yaw])


def wrap(angles: Float64s) -> Float64s:
    """Angles brought into [-pi, pi)."""
    return (angles + np.pi) % (2 * np.pi) - np.pi


def rms(errors: Float64s) -> float:
    """Root of the mean square of `errors` (n,)."""
    return float(np.sqrt(np.mean(np.square(errors))))


def _rotation(yaw: float) -> Float64s:
    return np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])


def between(a: Float64s, b: Float64s) -> Float64s:
    """Planar poses `b` seen from `a`, both (n, 3)."""
    cosine, sine = np.cos(a[:, 2]), np.sin(a[:, 2])
    dx, dy = (b - a)[:, :2].T
    return np.column_stack([cosine * dx + sine * dy, cosine * dy - sine * dx, wrap(b[:, 2] - a[:, 2])])
