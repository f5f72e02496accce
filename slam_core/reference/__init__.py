"""The paper in plain numpy, float64, one file a section: what a reader opens first.

Slow and short. It is what the fast core is tested against, and what shows every Gauss-Newton iteration.

    from slam_core.reference import ReferenceSlam

    slam = ReferenceSlam(SlamConfig.paper())
    for measurement in measurements:  # LaserScan and Imu, in the order of a Sequencer
        scan = slam.step(measurement)  # pose, state, and every iteration; None for an Imu

Equations are those of Kohlbrecher et al. 2011, put right where the print has slips (docs/errata.md).
"""

from slam_core.reference.scan_matching import Iteration
from slam_core.reference.slam import ReferenceScan, ReferenceSlam

__all__ = ["Iteration", "ReferenceScan", "ReferenceSlam"]
