"""What a scan changes in the map: written by the keyframe policy, and cleared of dynamic objects."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from slam_core.config import MapConfig
from slam_core.mapping.drift import MapDrift
from slam_core.mapping.dynamic_objects import DynamicObjectRemoval
from slam_core.mapping.keyframes import KeyframePolicy
from slam_core.mapping.newcomers import Newcomers
from slam_core.mapping.pyramid import Pyramid
from slam_core.measurements import Float64s
from slam_core.results import NOWHERE, MatchResult, PlanarGaussian, Verdict
from slam_core.scan.stabilise import StabilisedScan


class MapUpdate(NamedTuple):
    """unexpected: (n,) which endpoints lay in free space until now. written: whether the scan is a keyframe."""

    unexpected: NDArray[np.bool_]
    written: bool


class Mapper:
    """Writes one map, unless it is a prior map that stays as it is."""

    def __init__(self, pyramid: Pyramid, *, writes: bool) -> None:
        self._pyramid = pyramid
        self._writes = writes
        self._keyframes = KeyframePolicy()
        self._newcomers = Newcomers()
        self._dynamic_objects = DynamicObjectRemoval()
        self._drift = MapDrift()

    def update(
        self,
        scan: StabilisedScan,
        pose: Float64s,
        match: MatchResult | None,
        verdict: Verdict,
        time_ns: int,
        config: MapConfig,
        *,
        unaided: bool,
    ) -> MapUpdate:
        """Sections IV-A and IV-C with a scan at `pose` (3,); match: None for the first scan.

        unaided: only matches observe the motion, so that scans which fit worse than usual may be distorted.
        """
        self._pyramid.cover(scan.points, pose)
        unexpected = self._pyramid.unexpected(scan.points, pose)
        if not (self._writes and config.update and verdict.accepted and verdict.confirmed):
            return MapUpdate(unexpected, False)
        if verdict.recovery == "continued":
            self._keyframes.restart()
        residuals = match.residuals if match and unaided else None
        written = self._keyframes.selects(pose, time_ns, residuals, config, scan.facing)
        if written:
            late = self._newcomers.too_new(scan.points, pose, unexpected, time_ns, config.appearance_delay)
            points, cleared = scan.points, scan.cleared
            if late.any():
                points, cleared = points[~late], np.concatenate([cleared, points[late]])
            self._pyramid.update(points, cleared, scan.laser, pose, config)
        if match:
            self._dynamic_objects.clear(self._pyramid, scan, pose, time_ns, config)
        return MapUpdate(unexpected, written)

    def add(self, scan: StabilisedScan, pose: Float64s, config: MapConfig) -> None:
        """Write a scan that was made earlier at `pose` (3,) in the map."""
        if self._writes and config.update:
            self._pyramid.cover(scan.points, pose)
            self._pyramid.update(scan.points, scan.cleared, scan.laser, pose, config)

    def with_drift(
        self, fused: PlanarGaussian, match: MatchResult | None, verdict: Verdict, prior: PlanarGaussian
    ) -> PlanarGaussian:
        """A fused pose whose covariance contains the drift of the map that this run has written."""
        if not self._writes:
            return fused
        if verdict.recovery == "continued":
            self._drift.continue_from(prior)
        return self._drift.added_to(fused, match.unobservable if match else NOWHERE)
