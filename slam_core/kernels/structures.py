"""Arguments that belong together: named tuples, which compiled code passes on without a cost.

Python hands them over as plain tuples, which numba unpacks three times as fast; a kernel gives them their names.
"""

from typing import Any, NamedTuple

from slam_core.measurements import Float32s, Float64s, Int64s


class Level(NamedTuple):
    """One level as the matcher reads it.

    cells: (rows, columns) probabilities in parts of 2^16. corner: (2,) column and row of cell [0, 0] in the
    lattice. inverse: cells a metre.
    """

    cells: Any
    corner: Int64s
    inverse: float


MOST_LEVELS = 6  # of `map.levels`: kernels take so many in any case, as each number would be compiled for itself


class Levels(NamedTuple):
    """All levels of a pyramid.

    cells: a tuple of MOST_LEVELS, finest first; the coarsest stands for those that there are not. corner: (2,) and
    resolution, metres a cell: of the finest.
    """

    cells: Any
    corner: Int64s
    resolution: float


class Beams(NamedTuple):
    """xs, ys: (n,) endpoints in the stabilised frame, metres."""

    xs: Float32s
    ys: Float32s


class LatticePose(NamedTuple):
    """A pose in cells, float32: turn (cosine, sine), shift (u, v), and the box of cells with a next neighbour."""

    turn: tuple[Any, Any]
    shift: tuple[Any, Any]
    box: tuple[Any, Any, Any, Any]


class Limits(NamedTuple):
    """Of Gauss-Newton on one level: most steps, the step in metres that ends it."""

    iterations: int
    converged_step: float


class Prior(NamedTuple):
    """A predicted pose: mean (3,), covariance (3, 3), and how much it counts; 0 for none."""

    mean: Float64s
    covariance: Float64s
    weight: float


class MatchSettings(NamedTuple):
    """Of `MatcherConfig`, in its order."""

    iterations_coarse: int
    iterations_fine: int
    converged_step: float
    prior_restart_sigmas: float
    sigma: float
    surfel_weight: float
    back_face_share: float
    degeneracy_threshold: float


class MatchProblem(NamedTuple):
    """What the matches of one scan have in common.

    start: (3,) pose. term: (4, 3) and unobservable: (2,) as in `gauss_newton`. workspace: of it.
    """

    levels: Levels
    start: Float64s
    term: Float64s
    unobservable: Float64s
    settings: MatchSettings
    workspace: Any


class MatchOutput(NamedTuple):
    """Arrays that a match fills.

    found: (8, 3) the pose; the direction that the scan observes worst with the share of beams that fix it; the
    Hessian (13); the covariance (15). taken: (levels,) steps of each level. residuals: (n,). trace: (levels, k, 3)
    the first k iterates of each level.
    """

    found: Float64s
    taken: Int64s
    residuals: Float32s
    trace: Float64s


class Steps(NamedTuple):
    """Of a map update, in log-odds: free and occupied step, lower and upper cap, cap of a cell behind a hit."""

    free: float
    occupied: float
    low: float
    high: float
    behind: float


class Tiles(NamedTuple):
    """revisions: of each tile, when it changed last. shift: a tile is 2^shift cells long. revision: the next."""

    revisions: Int64s
    shift: int
    revision: int


class Clearing(NamedTuple):
    """Of dynamic-object removal: metres behind a cell at which a passing beam ends; cap and step in log-odds."""

    behind: float
    cap: float
    free: float


class BeamLimits(NamedTuple):
    """Of a sweep, metres: endpoints in [low, high); from no_return on a beam clears up to clear_range; z band."""

    low: float
    high: float
    no_return: float
    clear_range: float
    z_min: float
    z_max: float


class FusionRule(NamedTuple):
    """How a match is fused: method and omega, unobservable direction (2,), and the parts of P that are widened."""

    method: int
    omega: float
    unobservable: Float64s
    widen_vertical: bool
