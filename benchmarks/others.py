"""Side by side with others: kiss-icp on the same scans, and every trajectory judged by evo.

kiss-icp gets each scan as a flat cloud in the frame of the base, with the time of each beam in the revolution, so
that it takes the motion during the sweep out itself; it has neither inertial data nor wheels. Both libraries are
in the `bench` extra; without them nothing is compared.
"""

import time
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.accuracy import process
from benchmarks.cases import Recording
from hectorscope.run.metrics import PARTS
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.sources import open_source
from slam_core.config import SlamConfig
from slam_core.evaluation.trajectory import Trajectory, evaluate
from slam_core.geometry import rotation_matrix
from slam_core.measurements import Float64s, Imu, LaserScan

if TYPE_CHECKING:
    from evo.core.trajectory import PoseTrajectory3D

INSTALLED = all(find_spec(name) for name in ("kiss_icp", "evo"))
OURS, SCANS_ALONE, KISS = "Hectorscope", "Hectorscope, without IMU", "kiss-icp"

# Its authors advise ranges as of the sensor's data sheet and, indoors, voxels smaller than its rule gives (a
# hundredth of the range). Of 0.05, 0.1, 0.15, 0.2, 0.3 and 0.5 m, one thinning or two, and 50 or 500 iterations,
# these came out best on the recordings that are compared here.
VOXEL = 0.05  # m
RANGES = (0.1, 30.0)  # m
ITERATIONS = 50
SETTINGS = f"ranges up to {RANGES[1]:g} m, voxels of {VOXEL:g} m, {ITERATIONS} iterations at most, one thread"

STRETCH = 1.0  # m of the true path over which the relative error is taken
MAX_GAP = 1.0  # s between poses of the truth, as for our own errors


@dataclass(frozen=True, slots=True)
class Judged:
    """Root mean squares in the plane, metres, None without a truth.

    ape, rpe: evo's absolute error, aligned, and its relative one over STRETCH. own: our own aligned error.
    start_to_end: metres. ms: median for one scan.
    """

    ape: float | None
    rpe: float | None
    own: float | None
    start_to_end: float
    ms: float


def compare(recording: Recording) -> dict[str, Judged]:
    """One recording by our defaults, by them without inertial data if it has any, and by kiss-icp."""
    items = list(open_source(str(recording.path), recording.options).items())
    bare = [item for item in items if not isinstance(item, Imu)]
    full = process(items, SlamConfig())
    results = {OURS: _ours(full)}
    if len(bare) < len(items):
        results[SCANS_ALONE] = _ours(process(bare, SlamConfig()))
    rows, ms = kiss_icp([item for item in items if isinstance(item, LaserScan)], full.start_ns or 0)
    results[KISS] = judge(rows, full.truth, ms)
    return results


def _ours(pipeline: Pipeline) -> Judged:
    series = pipeline.series.view(SERIES_DTYPE).reshape(-1)
    ms = float(np.median(sum(series[f"{part}_ms"] for part in PARTS)))
    return judge(pipeline.trajectory, pipeline.truth, ms)


def judge(rows: Float64s, truth: Float64s, ms: float) -> Judged:
    """Poses (n, 8) against the truth (m, 8), both as in a trajectory's rows."""
    way = float(np.hypot(*(rows[-1, 1:3] - rows[0, 1:3])))
    if not len(truth):
        return Judged(None, None, None, way, ms)
    error = evaluate(Trajectory.from_rows(rows), Trajectory.from_rows(truth))
    assert error is not None
    return Judged(*evo_errors(rows, truth), error.aligned, way, ms)


def evo_errors(rows: Float64s, truth: Float64s) -> tuple[float, float]:
    """Evo's root mean square errors of poses (n, 8) in the plane: absolute after its alignment, and relative."""
    from evo.core import metrics, sync  # noqa: PLC0415

    pair = sync.associate_trajectories(
        _flat(truth), _flat(rows), sync_method=sync.SyncMethod.interpolation, max_diff=MAX_GAP
    )
    pair[1].align(pair[0])
    part, rmse = metrics.PoseRelation.translation_part, metrics.StatisticsType.rmse
    absolute = metrics.APE(part)
    relative = metrics.RPE(part, STRETCH, metrics.Unit.meters, all_pairs=True, pairs_from_reference=True)
    for metric in (absolute, relative):
        metric.process_data(pair)
    return absolute.get_statistic(rmse), relative.get_statistic(rmse)


def _flat(rows: Float64s) -> "PoseTrajectory3D":
    from evo.core.trajectory import Plane, PoseTrajectory3D  # noqa: PLC0415

    once = rows[np.unique(rows[:, 0], return_index=True)[1]]
    trajectory = PoseTrajectory3D(once[:, 1:4], once[:, 4:8], once[:, 0])
    trajectory.project(Plane.XY)
    return trajectory


def kiss_icp(scans: list[LaserScan], start_ns: int) -> tuple[Float64s, float]:
    """(n, 8) poses by kiss-icp, each at the time that it means, and its median milliseconds a scan."""
    from kiss_icp.config import KISSConfig  # noqa: PLC0415
    from kiss_icp.kiss_icp import KissICP  # noqa: PLC0415

    config = KISSConfig()
    config.mapping.voxel_size = VOXEL
    config.data.max_range = RANGES[1]
    config.data.deskew = scans[0].time_increment > 0.0
    config.registration.max_num_iterations = ITERATIONS
    config.registration.max_num_threads = 1
    odometry = KissICP(config)
    revolution_ns = float(np.median([after.stamp_ns - before.stamp_ns for before, after in pairwise(scans)]))
    # It brings the points of a sweep to where the sensor was at its end.
    end_ns = revolution_ns if config.data.deskew else 0.0
    rows, spent = np.zeros((len(scans), 8)), np.empty(len(scans))
    for k, scan in enumerate(scans):
        cloud, times = flat_cloud(scan, revolution_ns * 1e-9)
        begin = time.perf_counter()
        odometry.register_frame(cloud, times)
        spent[k] = time.perf_counter() - begin
        pose = odometry.last_pose
        half = np.arctan2(pose[1, 0], pose[0, 0]) / 2
        rows[k] = (scan.stamp_ns + end_ns - start_ns) * 1e-9, *pose[:3, 3], np.cos(half), 0.0, 0.0, np.sin(half)
    return rows, 1e3 * float(np.median(spent))


def flat_cloud(scan: LaserScan, revolution: float) -> tuple[Float64s, Float64s]:
    """(n, 3) endpoints in the frame of the base and (n,) seconds of their beams, from the stamp on.

    The first and the last are out of range and stand for the `revolution`, seconds: kiss-icp takes times for
    shares of what it gets, and a sweep of 270 degrees ends a quarter of a turn before the next begins.
    """
    n = len(scan.ranges)
    ranges = scan.ranges.astype(np.float64)
    kept = np.flatnonzero((ranges > max(scan.range_min, RANGES[0])) & (ranges < min(scan.range_max, RANGES[1])))
    angles = scan.angle_min + scan.angle_increment * np.arange(n)
    mount = scan.T_base_laser
    beams = (
        np.column_stack((np.cos(angles), np.sin(angles), np.zeros(n)))[kept] @ rotation_matrix(mount.rotation).T
    )
    placed = ranges[kept, None] * beams + mount.translation
    beyond = np.full((1, 3), 10.0 * RANGES[1])
    times = np.concatenate(([0.0], scan.time_increment * kept, [revolution]))
    return np.concatenate((beyond, placed, beyond)), times
