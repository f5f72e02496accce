"""One scan with the map that it was matched to, as it was before the scan was written into it."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from hectorscope.run.pipeline import Pipeline
from slam_core import geometry
from slam_core.config import MatcherConfig, SlamConfig
from slam_core.kernels.bilinear import WHOLE
from slam_core.mapping.grid import GridLevel, probability_of
from slam_core.mapping.pyramid import Pyramid
from slam_core.mapping.tiles import common
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import Float32s, Float64s
from slam_core.reference.occupancy_grid import OccupancyGrid
from slam_core.reference.scan_matching import Iteration
from slam_core.reference.scan_matching import match as reference_match
from slam_core.results import MatchResult, PlanarGaussian, StepResult

EDGE = 2  # unknown cells around what is known: the same as the endless map for eqs. (4)-(6)


@dataclass(frozen=True, eq=False)
class MatchProblem:
    """pyramid: the map before the scan. points: (n, 2) endpoints in the stabilised frame, laser: (2,), metres;
    without those that the run left out.

    start: (3,) where the match began. match: of the run. prior: the prediction before it. config: in force.
    """

    pyramid: Pyramid
    points: Float32s
    laser: Float64s
    start: Float64s
    match: MatchResult
    prior: PlanarGaussian
    config: SlamConfig

    @cached_property
    def grids(self) -> tuple[OccupancyGrid, ...]:
        """The levels as the reference takes them, finest first."""
        return tuple(reference_grid(level) for level in self.pyramid.levels)

    @cached_property
    def matcher(self) -> MatcherConfig:
        """The run's matcher with eq. (7) alone: without prior and surfels, and to the last step.

        A direction that few beams fix is left to the prediction where the run left it to that.
        """
        config, match = self.config.matcher, self.match
        held = match.leaves_direction and match.weakest_share >= config.degeneracy_threshold
        threshold = 1.0 if held else config.degeneracy_threshold
        return replace(config, surfel_weight=0.0, prior_restart_sigmas=0.0, degeneracy_threshold=threshold)

    @cached_property
    def matched(self) -> Float64s:
        """(3,) where this matcher ends from the run's start."""
        return self.end(self.start).pose

    def end(self, start: Float64s, points: Float32s | None = None, *, trace: bool = False) -> MatchResult:
        """The match from another start (3,), or of other endpoints (n, 2)."""
        points = self.points if points is None else points
        return coarse_to_fine(self.pyramid, points, start, self.matcher, trace=trace)

    def iterations(self, start: Float64s) -> tuple[Iteration, ...]:
        """Every Gauss-Newton iteration of the reference from a start (3,), coarse to fine."""
        steps = self.config.matcher.iterations_coarse, self.config.matcher.iterations_fine
        return tuple(reference_match(self.grids, self.points.astype(np.float64), start, steps))


def problem_of(before: Pipeline, result: StepResult, config: SlamConfig) -> MatchProblem | None:
    """The scan of a result. before: the run before that scan. None for a scan that was matched to nothing."""
    if result.match is None or result.prior is None or result.sweep is None or before.slam.matched_map.empty:
        return None
    start = before.slam.start_estimate(result.prior, config)
    points = np.delete(result.points, result.match.left_out, axis=0)
    pyramid = before.slam.matched_map
    pyramid.cover(points, start)
    return MatchProblem(pyramid, points, result.sweep.laser, start, result.match, result.prior, config)


def reference_grid(level: GridLevel) -> OccupancyGrid:
    """What is known of a level, with the probabilities that the matcher reads (in parts of 2^16)."""
    row0, row1, column0, column1 = level.bounds or (0, 0, 0, 0)
    box = common((row0 - EDGE, row1 + EDGE, column0 - EDGE, column1 + EDGE), level.box)
    probability = probability_of(level.gather(box, "cells")).astype(np.float64)
    probability = np.clip(probability, 0.5 / WHOLE, 1.0 - 0.5 / WHOLE)
    return OccupancyGrid(level.resolution, np.array([box[2], box[0]]), np.log(probability / (1.0 - probability)))


def apart(a: Float64s, b: Float64s) -> tuple[float, float]:
    """Metres and radians between two poses (3,)."""
    return float(np.hypot(*(a - b)[:2])), abs(float(geometry.wrap(a[2] - b[2])))
