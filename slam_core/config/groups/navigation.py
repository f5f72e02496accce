"""Settings of the motion between matches: filter, aiding sensors, platform, planar model."""

from dataclasses import dataclass
from typing import Annotated

from slam_core.config.leaves import Param


@dataclass(frozen=True, slots=True)
class NavigationConfig:
    """Section V-A: the navigation filter, its noise, and the pseudo measurements that keep it bounded."""

    gravity: Annotated[float, Param("Magnitude of g in eq. (3).", "m/s²", 1.0, 12.0)] = 9.80665
    gyro_noise: Annotated[float, Param("Noise density of the gyroscopes.", "rad/s/√Hz", 1e-05, 0.1, log=True)] = (
        0.002
    )
    accel_noise: Annotated[
        float, Param("Noise density of the accelerometers.", "m/s²/√Hz", 0.0001, 1.0, log=True)
    ] = 0.02
    gyro_bias_walk: Annotated[
        float, Param("Random walk of the gyroscope biases.", "rad/s²/√Hz", 1e-07, 0.01, log=True)
    ] = 2e-05
    accel_bias_walk: Annotated[
        float, Param("Random walk of the accelerometer biases.", "m/s³/√Hz", 1e-06, 0.1, log=True)
    ] = 0.0002
    gyro_bias_sigma: Annotated[
        float, Param("Standard deviation of the gyroscope biases at the start.", "rad/s", 0.0001, 0.2, log=True)
    ] = 0.02
    accel_bias_sigma: Annotated[
        float, Param("Standard deviation of the accelerometer biases at the start.", "m/s²", 0.001, 2.0, log=True)
    ] = 0.1
    gyro_range: Annotated[
        float,
        Param(
            "Rate at which the gyroscopes are clipped (0: detected from repeated extreme values).",
            "rad/s",
            0.0,
            100.0,
        ),
    ] = 0.0
    height_sigma: Annotated[
        float, Param("Standard deviation of a height measurement.", "m", 0.001, 20.0, log=True)
    ] = 0.2
    height_gate: Annotated[
        float,
        Param(
            "Mahalanobis limit of a height: one further from the prediction is rejected (0: off, the paper).",
            "σ",
            0.0,
            100.0,
        ),
    ] = 5.0
    gate_reset_time: Annotated[
        float,
        Param(
            "A source is used again when it was rejected for this time, its measurements agree, and no other"
            " source measures the same states.",
            "s",
            0.1,
            60.0,
        ),
    ] = 5.0
    zero_velocity_threshold: Annotated[
        float,
        Param(
            "The pseudo zero-velocity update acts while the standard deviation of the velocity is larger than"
            " this (section V-A).",
            "m/s",
            0.1,
            20.0,
            log=True,
        ),
    ] = 2.0
    zero_velocity_sigma: Annotated[
        float, Param("Standard deviation of the pseudo zero-velocity update.", "m/s", 0.05, 20.0, log=True)
    ] = 1.0
    tilt_threshold: Annotated[
        float,
        Param(
            "The measured gravity corrects roll and pitch while their standard deviation is larger than this.",
            "rad",
            0.001,
            1.0,
            log=True,
        ),
    ] = 0.02
    gravity_sigma: Annotated[
        float,
        Param(
            "Standard deviation of that correction: accelerations of the base appear as gravity.",
            "m/s²",
            0.01,
            10.0,
            log=True,
        ),
    ] = 1.0
    height_threshold: Annotated[
        float,
        Param(
            "A pseudo measurement holds the height at that of the start while its standard deviation is"
            " larger than this.",
            "m",
            0.1,
            100.0,
            log=True,
        ),
    ] = 1.0
    history: Annotated[
        float, Param("Length of the state buffer: a measurement may be late by this time.", "s", 0.1, 10.0)
    ] = 1.5
    level_time: Annotated[
        float,
        Param(
            "Duration of the initial alignment: roll and pitch are taken from the mean acceleration.",
            "s",
            0.1,
            5.0,
            restart=True,
        ),
    ] = 0.5
    start_in_motion: Annotated[
        bool,
        Param(
            "A base that moves at the start: the map begins once scans have confirmed attitude and velocity,"
            " some seconds later."
        ),
    ] = True


@dataclass(frozen=True, slots=True)
class AidingConfig:
    """Sections III and V: other sensors, which correct the filter, or the planar motion without an IMU."""

    gate: Annotated[
        float,
        Param(
            "Mahalanobis limit of an aiding measurement: one further from the prediction is rejected (0: off).",
            "σ",
            0.0,
            100.0,
            title="Gate of aiding sensors",
        ),
    ] = 5.0
    gps: Annotated[bool, Param("Use satellite fixes, once the pose of the map on the earth is known.")] = True
    gps_sigma: Annotated[
        float, Param("Standard deviation of a fix that comes without a covariance.", "m", 0.01, 100.0, log=True)
    ] = 2.5
    gps_velocity_sigma: Annotated[
        float, Param("Standard deviation of a satellite velocity.", "m/s", 0.01, 10.0, log=True)
    ] = 0.2
    compass: Annotated[bool, Param("Use the magnetic field to correct the heading.")] = True
    compass_sigma: Annotated[
        float, Param("Standard deviation of a magnetic heading.", "rad", 0.01, 1.0, log=True)
    ] = 0.1
    declination: Annotated[
        float,
        Param(
            "Magnetic declination: angle from true north to magnetic north, positive to the east.",
            "rad",
            -3.14,
            3.14,
        ),
    ] = 0.0
    ground: Annotated[bool, Param("Use the distance to the ground to correct the height.")] = True
    ground_sigma: Annotated[
        float, Param("Standard deviation of a distance to the ground.", "m", 0.001, 5.0, log=True)
    ] = 0.05
    attitude: Annotated[bool, Param("Use roll and pitch of an attitude that another estimator measured.")] = True
    attitude_sigma: Annotated[
        float, Param("Standard deviation of roll and pitch of such an attitude.", "rad", 0.001, 1.0, log=True)
    ] = 0.03
    standstill: Annotated[
        bool,
        Param(
            "Detect standstill in the inertial data: the velocity is zero then, and the gyroscopes measure"
            " their biases."
        ),
    ] = True


@dataclass(frozen=True, slots=True)
class PlatformConfig:
    """Section III: constraints of the platform, which take states out of the filter."""

    planar: Annotated[
        bool,
        Param(
            "The platform moves in a plane: roll, pitch, height and vertical velocity are zero (section III;"
            " needs an IMU).",
            tier="basic",
        ),
    ] = False
    no_slip: Annotated[
        bool, Param("Non-holonomic constraint: the lateral velocity is zero, as on wheels that do not slip.")
    ] = False


@dataclass(frozen=True, slots=True)
class MotionConfig:
    """The planar motion model without an IMU (nearly constant velocity), and the wheel odometry."""

    acceleration: Annotated[
        float, Param("Process noise of the velocity, forward and left.", "m/s²/√Hz", 0.01, 20.0, log=True)
    ] = 1.0
    yaw_acceleration: Annotated[
        float, Param("Process noise of the yaw rate.", "rad/s²/√Hz", 0.01, 50.0, log=True)
    ] = 3.0
    deskew_refinements: Annotated[
        int,
        Param(
            "A sweep is deskewed and matched again with the velocity that its match gives, at most so often"
            " (0: off, the paper).",
            "",
            0,
            5,
        ),
    ] = 3
    odometry_sigma: Annotated[
        float, Param("Standard deviation of a wheel velocity at rest.", "m/s", 0.001, 2.0, log=True)
    ] = 0.05
    odometry_slip: Annotated[
        float,
        Param("Standard deviation of a wheel velocity as a share of it, added in quadrature: slip.", "", 0.0, 2.0),
    ] = 0.2
