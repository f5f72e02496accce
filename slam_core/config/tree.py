"""One tree of frozen dataclasses: it makes the command line, the sliders, the TOML file and the checks."""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from slam_core.config.leaves import Param, leaves

StartEstimate = Literal["filter", "velocity", "last_pose"]
CovarianceMethod = Literal["hessian", "sampled"]
FusionMethod = Literal["fixed", "trace", "determinant", "kalman"]


@dataclass(frozen=True, slots=True)
class ScanConfig:
    """Section IV: from a sweep to endpoints in the stabilised frame."""

    range_min: Annotated[float, Param("Beams shorter than this are dropped.", "m", 0.0, 10.0)] = 0.4
    range_max: Annotated[float, Param("Beams longer than this are dropped.", "m", 1.0, 250.0)] = 30.0
    z_min: Annotated[float, Param("Lowest endpoint kept, over the laser.", "m", -10.0, 0.0)] = -1.0
    z_max: Annotated[float, Param("Highest endpoint kept, over the laser.", "m", 0.0, 10.0)] = 1.0
    stabilise: Annotated[bool, Param("Turn the scan level with the estimated roll and pitch.")] = True
    deskew: Annotated[bool, Param("Place each beam by the motion during the sweep.")] = True
    clear_range: Annotated[
        float, Param("Beams without a return clear the map up to this range (0: not).", "m", 0.0, 30.0)
    ] = 0.0


@dataclass(frozen=True, slots=True)
class MapConfig:
    """Sections IV-A and IV-C: the pyramid of occupancy grids."""

    resolution: Annotated[float, Param("Cell length of the finest level.", "m", 0.01, 1.0, restart=True)] = 0.05
    size: Annotated[
        int, Param("Cells on a side of the first map, finest level.", "cells", 64, 8192, restart=True)
    ] = 1024
    grow: Annotated[bool, Param("The map grows when beams reach its edge (off: they are cut there).")] = True
    limit: Annotated[
        float,
        Param("Memory that all levels may take; beyond it the map stops growing.", "MB", 1.0, 14336.0, log=True),
    ] = 1024.0
    levels: Annotated[int, Param("Levels, each half the resolution of the one below.", "", 1, 6, restart=True)] = 3
    start_x: Annotated[float, Param("Start, as a fraction of the map's width.", "", 0.0, 1.0, restart=True)] = 0.5
    start_y: Annotated[float, Param("Start, as a fraction of the map's height.", "", 0.0, 1.0, restart=True)] = 0.5
    factor_free: Annotated[float, Param("Probability set on a cell that a beam crossed.", "", 0.05, 0.49)] = 0.4
    factor_occupied: Annotated[float, Param("Probability set on a cell that a beam ended in.", "", 0.51, 0.99)] = (
        0.9
    )
    factor_behind: Annotated[
        float,
        Param(
            "Probability to which the cell behind a hit sinks, finest level: walls keep a back as sharp as their"
            " front (0.5: left alone, the paper).",
            "",
            0.01,
            0.5,
        ),
    ] = 0.15
    log_odds_min: Annotated[
        float, Param("Lower cap of a cell: how sure free space may get.", "", -50.0, -0.5)
    ] = -50.0
    log_odds_max: Annotated[float, Param("Upper cap of a cell: how sure a wall may get.", "", 0.5, 50.0)] = 50.0
    update_distance: Annotated[float, Param("The map is updated after moving this far.", "m", 0.0, 5.0)] = 0.4
    update_angle: Annotated[float, Param("The map is updated after turning this far.", "rad", 0.0, 3.14)] = 0.06
    keyframe_max_delay: Annotated[
        float,
        Param(
            "How long a scan that fits worse than usual waits for a better one to be written in its place, where"
            " nothing but matches tells how the laser moves (0: never, the paper).",
            "s",
            0.0,
            10.0,
        ),
    ] = 0.5
    clear_interval: Annotated[
        float,
        Param("How often occupied cells that beams pass are doubted, at rest too (0: never).", "s", 0.0, 60.0),
    ] = 0.25


@dataclass(frozen=True, slots=True)
class MatcherConfig:
    """Section IV-B: Gauss-Newton scan matching and its covariance."""

    iterations_coarse: Annotated[int, Param("Gauss-Newton steps on each coarser level.", "", 1, 30)] = 4
    iterations_fine: Annotated[int, Param("Gauss-Newton steps on the finest level.", "", 1, 60)] = 6
    converged_step: Annotated[
        float,
        Param(
            "A level ends when its step is shorter than this, a coarser one also when it is shorter than a"
            " twentieth of its cells (0: never).",
            "m",
            0.0,
            0.05,
        ),
    ] = 0.0005
    max_yaw_step: Annotated[float, Param("A single step never turns further than this.", "rad", 0.01, 1.0)] = 0.2
    coarse_beams: Annotated[
        int,
        Param(
            "Each coarser level takes half of the beams that the finer ones left, if these are so many or more (0:"
            " all beams, the paper's match).",
            "",
            0,
            2000,
        ),
    ] = 360
    prior_restart_sigmas: Annotated[
        float,
        Param(
            "A match further than this from the prediction is compared with one whose finest level begins there,"
            " and the better one counts (0: never, the paper's match).",
            "σ",
            0.0,
            100.0,
        ),
    ] = 3.0
    sigma: Annotated[float, Param("Scale of the match covariance, eq. (15).", "", 0.001, 10.0, log=True)] = 0.2
    covariance: Annotated[CovarianceMethod, Param("From the Hessian, eq. (15), or sampled around the match.")] = (
        "hessian"
    )
    surfel_weight: Annotated[
        float,
        Param(
            "How much it counts where in its cells a surface lies, which the finest level keeps besides (0: cells"
            " alone, the paper's match).",
            "",
            0.0,
            20.0,
        ),
    ] = 5.0
    weak_observability_threshold: Annotated[
        float,
        Param(
            "Where the shape of a scan fixes some direction by less than this share of its beams, only the map's"
            " gradient across the surfaces counts (0: always all of it, the paper's match).",
            "",
            0.0,
            1.0,
        ),
    ] = 0.02
    degeneracy_threshold: Annotated[
        float,
        Param(
            "A direction that less than this share of the beams fixes, as along a bare corridor, is left to the"
            " prediction (0: never).",
            "",
            0.0,
            0.2,
        ),
    ] = 0.005
    prior_weight: Annotated[
        float,
        Param("How much the predicted pose counts in the match (0: the paper's plain match).", "", 0.0, 10.0),
    ] = 1.0
    start_estimate: Annotated[
        StartEstimate,
        Param("Where the search starts: projected filter, integrated velocities, or last pose."),
    ] = "filter"


@dataclass(frozen=True, slots=True)
class NavigationConfig:
    """Section V-A: the strapdown filter, its noise and what keeps it bounded."""

    gravity: Annotated[float, Param("Magnitude of gravity.", "m/s²", 1.0, 12.0)] = 9.80665
    gyro_noise: Annotated[float, Param("White noise of the gyros.", "rad/s/√Hz", 1e-5, 0.1, log=True)] = 2e-3
    accel_noise: Annotated[float, Param("White noise of the accelerometers.", "m/s²/√Hz", 1e-4, 1.0, log=True)] = (
        2e-2
    )
    gyro_bias_walk: Annotated[
        float, Param("Random walk of the gyro biases.", "rad/s²/√Hz", 1e-7, 0.01, log=True)
    ] = 2e-5
    accel_bias_walk: Annotated[
        float, Param("Random walk of the accelerometer biases.", "m/s³/√Hz", 1e-6, 0.1, log=True)
    ] = 2e-4
    gyro_bias_sigma: Annotated[
        float, Param("How large a gyro bias can be at the start.", "rad/s", 1e-4, 0.2, log=True)
    ] = 0.02
    accel_bias_sigma: Annotated[
        float, Param("How large an accelerometer bias can be.", "m/s²", 1e-3, 2.0, log=True)
    ] = 0.1
    gyro_range: Annotated[
        float, Param("Rate at which the gyros are clipped (0: found from repeated extremes).", "rad/s", 0.0, 100.0)
    ] = 0.0
    height_sigma: Annotated[float, Param("Noise of one height measurement.", "m", 0.001, 20.0, log=True)] = 0.2
    height_gate: Annotated[
        float, Param("A height further from the prediction than this is rejected (0: none).", "σ", 0.0, 100.0)
    ] = 5.0
    gate_reset_time: Annotated[
        float,
        Param(
            "A source that was rejected for this long, consistently, while no other measured the same, is believed"
            " again.",
            "s",
            0.1,
            60.0,
        ),
    ] = 5.0
    zero_velocity_threshold: Annotated[
        float, Param("A velocity less certain than this is pulled to zero.", "m/s", 0.1, 20.0, log=True)
    ] = 2.0
    zero_velocity_sigma: Annotated[
        float, Param("Noise of the pseudo measurement of no velocity.", "m/s", 0.05, 20.0, log=True)
    ] = 1.0
    tilt_threshold: Annotated[
        float,
        Param("A tilt less certain than this is levelled by the accelerometers.", "rad", 0.001, 1.0, log=True),
    ] = 0.02
    gravity_sigma: Annotated[
        float, Param("Noise of levelling: accelerations that pass for gravity.", "m/s²", 0.01, 10.0, log=True)
    ] = 1.0
    height_threshold: Annotated[
        float, Param("A height less certain than this is pulled to that of the start.", "m", 0.1, 100.0, log=True)
    ] = 1.0
    history: Annotated[float, Param("A measurement may come late by this much at least.", "s", 0.1, 10.0)] = 1.5
    level_time: Annotated[
        float, Param("The attitude at the start is the mean over this.", "s", 0.1, 5.0, restart=True)
    ] = 0.5


@dataclass(frozen=True, slots=True)
class AidingConfig:
    """Section V: other sensors that aid; without an IMU those that tell place, velocity and heading do."""

    gate: Annotated[
        float, Param("An aid further from the prediction than this is rejected (0: none).", "σ", 0.0, 100.0)
    ] = 5.0
    gps: Annotated[bool, Param("Use satellites, once it is known where the map lies.")] = True
    gps_sigma: Annotated[
        float, Param("Noise of a satellite fix whose receiver does not tell.", "m", 0.01, 100.0, log=True)
    ] = 2.5
    gps_velocity_sigma: Annotated[
        float, Param("Noise of a velocity by satellites.", "m/s", 0.01, 10.0, log=True)
    ] = 0.2
    compass: Annotated[bool, Param("Hold the heading by the magnetic field.")] = True
    compass_sigma: Annotated[float, Param("Error of a magnetic heading.", "rad", 0.01, 1.0, log=True)] = 0.1
    compass_tolerance: Annotated[
        float,
        Param(
            "A field further from the usual one, in size (share) or dip (rad), is disturbed.",
            "",
            0.01,
            1.0,
        ),
    ] = 0.15
    declination: Annotated[float, Param("How far magnetic north lies east of true north.", "rad", -3.14, 3.14)] = (
        0.0
    )
    ground: Annotated[bool, Param("Hold the height by the distance to the ground.")] = True
    ground_sigma: Annotated[float, Param("Noise of the distance to the ground.", "m", 0.001, 5.0, log=True)] = 0.05
    attitude: Annotated[bool, Param("Level the filter by an attitude that somebody else estimated.")] = True
    attitude_sigma: Annotated[
        float, Param("Error of the tilt in such an attitude.", "rad", 0.001, 1.0, log=True)
    ] = 0.03
    standstill: Annotated[
        bool, Param("A base that stands still has no velocity, and its gyros read their bias.")
    ] = True


@dataclass(frozen=True, slots=True)
class PlatformConfig:
    """Section III: what the platform cannot do is taken out of the state."""

    planar: Annotated[
        bool, Param("The platform stays in a plane: no roll, pitch, height or vertical velocity (with an IMU).")
    ] = False
    no_slip: Annotated[bool, Param("The platform never moves sideways, as on wheels that do not slip.")] = False


@dataclass(frozen=True, slots=True)
class MotionConfig:
    """The planar motion that is assumed when there is no IMU: nearly constant velocity."""

    acceleration: Annotated[
        float, Param("White noise on the velocity, forward and left.", "m/s²/√Hz", 0.01, 20.0, log=True)
    ] = 1.0
    yaw_acceleration: Annotated[
        float, Param("White noise on the yaw rate.", "rad/s²/√Hz", 0.01, 50.0, log=True)
    ] = 3.0
    deskew_refinements: Annotated[
        int,
        Param("How often a sweep may be placed and matched anew by the motion that its match shows.", "", 0, 5),
    ] = 3
    odometry_sigma: Annotated[float, Param("Noise of a wheel velocity.", "m/s", 0.001, 2.0, log=True)] = 0.05
    odometry_slip: Annotated[
        float, Param("Noise of a wheel velocity as a share of it: wheels slip, most in turns.", "", 0.0, 2.0)
    ] = 0.2
    odometry_gate: Annotated[
        float,
        Param(
            "With an IMU, a wheel velocity further from the prediction than this is rejected (0: none).",
            "σ",
            0.0,
            100.0,
        ),
    ] = 5.0
    observed_only: Annotated[
        bool, Param("A match widens only what hangs on the pose (off: the velocities too, as in the paper).")
    ] = True


@dataclass(frozen=True, slots=True)
class FusionConfig:
    """Section V-B: covariance intersection of the filter with the match."""

    method: Annotated[
        FusionMethod,
        Param(
            "Intersection with the fixed omega, with that of the least trace or determinant, or a Kalman update,"
            " which takes the errors for independent."
        ),
    ] = "fixed"
    omega: Annotated[
        float, Param("Fixed weight of the match in the intersection, eqs. (16)-(20).", "", 0.001, 0.999)
    ] = 0.02
    widen_vertical: Annotated[
        bool,
        Param(
            "A match widens height, vertical velocity and bias too, though it says nothing of them (the paper)."
        ),
    ] = False
    gate: Annotated[
        float,
        Param(
            "With an IMU, a match further from the prediction than this is not fused (0: none).", "σ", 0.0, 100.0
        ),
    ] = 0.0


@dataclass(frozen=True, slots=True)
class TrackingConfig:
    """Matches that cannot be believed: noticed, kept out of the map, and recovered from by a wider search."""

    check: Annotated[bool, Param("Judge every match and search further after a bad one (off: the paper).")] = True
    min_inlier_ratio: Annotated[
        float, Param("Share of the usual hits on walls below which a match is not believed.", "", 0.0, 1.0)
    ] = 0.65
    min_overlap: Annotated[float, Param("Share of the endpoints that must lie on known map.", "", 0.0, 1.0)] = 0.3
    mahalanobis_limit: Annotated[
        float, Param("A match further from the prediction than this is searched for again.", "σ", 1.0, 1000.0)
    ] = 100.0
    unaided_mahalanobis_limit: Annotated[
        float,
        Param(
            "Of a slow laser with neither IMU nor wheels, a match further than this from the prediction has to"
            " stand against what a search finds.",
            "σ",
            1.0,
            1000.0,
        ),
    ] = 2.5
    search_distance: Annotated[float, Param("The search goes this far at most.", "m", 0.1, 5.0)] = 2.0
    search_angle: Annotated[float, Param("The search turns this far at most.", "rad", 0.05, 3.14)] = 3.14
    lost_after: Annotated[
        int, Param("Scans in a row without a match that is believed until the pose is lost.", "", 1, 1000)
    ] = 10
    relocalise: Annotated[bool, Param("Search the whole map while the pose is lost.")] = True
    relocalise_interval: Annotated[
        float, Param("Time from one search of the whole map to the next.", "s", 0.0, 60.0)
    ] = 1.0
    relocalise_min_inlier_ratio: Annotated[
        float,
        Param("Share of a scan that the map must explain at a place found by that search.", "", 0.3, 1.0),
    ] = 0.85
    continue_from_prediction: Annotated[
        bool, Param("A robot that got lost where there is no map yet goes on with it from the prediction.")
    ] = True


@dataclass(frozen=True, slots=True)
class SlamConfig:
    """All settings of the pipeline."""

    scan: ScanConfig = field(default_factory=ScanConfig)
    map: MapConfig = field(default_factory=MapConfig)
    matcher: MatcherConfig = field(default_factory=MatcherConfig)
    navigation: NavigationConfig = field(default_factory=NavigationConfig)
    aiding: AidingConfig = field(default_factory=AidingConfig)
    platform: PlatformConfig = field(default_factory=PlatformConfig)
    motion: MotionConfig = field(default_factory=MotionConfig)
    fusion: FusionConfig = field(default_factory=FusionConfig)
    tracking: TrackingConfig = field(default_factory=TrackingConfig)

    @classmethod
    def paper(cls) -> "SlamConfig":
        """The method of the paper: every addition of the defaults switched off (`presets.ADDITIONS`)."""
        from slam_core.config.presets import preset  # noqa: PLC0415  # it is made of this tree

        return preset("paper")

    def __post_init__(self) -> None:
        """Refuse values out of range: ConfigError names the setting, the value and the range."""
        for leaf in leaves(self):
            leaf.check(leaf.value)
