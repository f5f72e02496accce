"""Writes a simulation as a bag: standard messages on the topics that drivers use."""

from collections.abc import Callable

import numpy as np

from hectorscope.ros.recorder import Recorder
from hectorscope.simulation.aids import MAGNETOMETER, ORIGIN, RANGEFINDER, RECEIVER
from hectorscope.simulation.options import Extra, SimulateOptions, SimulationError
from hectorscope.simulation.sensors import BAROMETER, MEMS, START_NS
from hectorscope.simulation.simulation import Simulation
from slam_core.geometry import from_euler
from slam_core.measurements import (
    Float64s,
    GpsPosition,
    GpsVelocity,
    GroundDistance,
    Height,
    Imu,
    LaserScan,
    MagneticField,
    Transform,
    TruthPose,
)

Progress = Callable[[float], None]
"""Called with the share that is done, from 0 to 1."""

SEA_LEVEL = 101325.0  # Pa


def simulate(options: SimulateOptions, progress: Progress = lambda share: None) -> None:
    """Drive the scene and write the bag `options.out`; RecorderError or SimulationError for a bad choice."""
    simulation = Simulation(options.scenario, options)
    if options.gps_outage and "gps" not in simulation.extras:
        raise SimulationError(
            f"gps_outage is {options.gps_outage:g} s, but there is no receiver: add gps to extras"
        )
    with Recorder(options.out) as bag:
        _write_mounts(bag, {"laser": simulation.scene.T_base_laser, **_mounts(simulation.extras)})
        for arrival_ns, item in simulation.arrivals():
            match item:
                case LaserScan():
                    bag.write("/scan", _scan(bag, item, 1.0 / options.scan_rate), arrival_ns)
                    progress((arrival_ns - START_NS) * 1e-9 / simulation.duration)
                case Imu():
                    bag.write("/imu/data_raw", _imu(bag, item), arrival_ns)
                case Height():
                    bag.write("/pressure", _pressure(bag, item), arrival_ns)
                case MagneticField():
                    bag.write("/imu/mag", _magnetic(bag, item), arrival_ns)
                case GpsPosition():
                    bag.write("/fix", _fix(bag, item), arrival_ns)
                case GpsVelocity():
                    bag.write("/fix_velocity", _velocity(bag, item), arrival_ns)
                case GroundDistance():
                    bag.write("/range_down", _range(bag, item), arrival_ns)
                case TruthPose():
                    bag.write("/ground_truth", _pose(bag, item), arrival_ns)
    progress(1.0)


def pressure_at(height: float) -> float:
    """Pascal at a height over the start, which lies at sea level of the standard atmosphere:
    p = p0 (1 - L h / T0)^(g M / R L), so h = 44330 m (1 - (p / p0)^0.1903) gives the height back.
    """
    return float(SEA_LEVEL * (1.0 - 2.25577e-5 * height) ** 5.25588)


def _mounts(extras: tuple[Extra, ...]) -> dict[str, Transform]:
    """Where everything but the laser sits on the base."""
    mounts = {"imu_link": Transform()}
    if "gps" in extras:
        mounts["gps"] = Transform(np.array(RECEIVER.antenna))
    if "rangefinder" in extras:
        mounts["rangefinder"] = Transform(np.array(RANGEFINDER.origin), from_euler(0.0, np.pi / 2, 0.0))
    return mounts


def _write_mounts(bag: Recorder, mounts: dict[str, Transform]) -> None:
    frames = [
        bag.make(
            "geometry_msgs/msg/TransformStamped",
            header=bag.header(START_NS, "base_link"),
            child_frame_id=child,
            transform=bag.make(
                "geometry_msgs/msg/Transform",
                translation=_vector(bag, mount.translation),
                rotation=_quaternion(bag, mount.rotation),
            ),
        )
        for child, mount in mounts.items()
    ]
    bag.write("/tf_static", bag.make("tf2_msgs/msg/TFMessage", transforms=frames), START_NS)


def _scan(bag: Recorder, scan: LaserScan, scan_time: float) -> object:
    return bag.make(
        "sensor_msgs/msg/LaserScan",
        header=bag.header(scan.stamp_ns, "laser"),
        angle_min=scan.angle_min,
        angle_max=scan.angle_min + scan.angle_increment * (len(scan.ranges) - 1),
        angle_increment=scan.angle_increment,
        time_increment=scan.time_increment,
        scan_time=scan_time,
        range_min=scan.range_min,
        range_max=scan.range_max,
        ranges=scan.ranges,
        intensities=np.zeros(0, np.float32),
    )


def _imu(bag: Recorder, imu: Imu) -> object:
    no_orientation = np.zeros(9)
    no_orientation[0] = -1.0  # as the definition of the message has it
    return bag.make(
        "sensor_msgs/msg/Imu",
        header=bag.header(imu.stamp_ns, "imu_link"),
        orientation=_quaternion(bag, Transform().rotation),
        orientation_covariance=no_orientation,
        angular_velocity=_vector(bag, imu.angular_velocity),
        angular_velocity_covariance=(np.eye(3) * MEMS.gyro_noise**2).ravel(),
        linear_acceleration=_vector(bag, imu.linear_acceleration),
        linear_acceleration_covariance=(np.eye(3) * MEMS.accel_noise**2).ravel(),
    )


def _pressure(bag: Recorder, height: Height) -> object:
    per_metre = pressure_at(0.0) - pressure_at(1.0)
    return bag.make(
        "sensor_msgs/msg/FluidPressure",
        header=bag.header(height.stamp_ns, "base_link"),
        fluid_pressure=pressure_at(height.height),
        variance=(per_metre * BAROMETER.noise) ** 2,
    )


def _magnetic(bag: Recorder, magnetic: MagneticField) -> object:
    return bag.make(
        "sensor_msgs/msg/MagneticField",
        header=bag.header(magnetic.stamp_ns, "imu_link"),
        magnetic_field=_vector(bag, magnetic.field),
        magnetic_field_covariance=(np.eye(3) * MAGNETOMETER.noise**2).ravel(),
    )


def _fix(bag: Recorder, fix: GpsPosition) -> object:
    latitude, longitude, altitude = ORIGIN.geodetic(fix.position)
    assert fix.covariance is not None
    return bag.make(
        "sensor_msgs/msg/NavSatFix",
        header=bag.header(fix.stamp_ns, "gps"),
        status=bag.make("sensor_msgs/msg/NavSatStatus", status=0, service=1),
        latitude=latitude,
        longitude=longitude,
        altitude=altitude,
        position_covariance=fix.covariance.ravel(),
        position_covariance_type=2,
    )


def _velocity(bag: Recorder, velocity: GpsVelocity) -> object:
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = np.eye(3) * RECEIVER.velocity_noise**2
    twist = bag.make(
        "geometry_msgs/msg/Twist", linear=_vector(bag, velocity.velocity), angular=_vector(bag, np.zeros(3))
    )
    return bag.make(
        "geometry_msgs/msg/TwistWithCovarianceStamped",
        header=bag.header(velocity.stamp_ns, "gps"),
        twist=bag.make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=covariance.ravel()),
    )


def _range(bag: Recorder, ground: GroundDistance) -> object:
    return bag.make(
        "sensor_msgs/msg/Range",
        header=bag.header(ground.stamp_ns, "rangefinder"),
        radiation_type=1,
        field_of_view=0.05,
        min_range=0.0,
        max_range=RANGEFINDER.reach,
        range=ground.distance,
        **({} if bag.format == "bag" else {"variance": RANGEFINDER.noise**2}),
    )


def _pose(bag: Recorder, truth: TruthPose) -> object:
    pose = bag.make(
        "geometry_msgs/msg/Pose",
        position=bag.make("geometry_msgs/msg/Point", **_xyz(truth.T_map_base.translation)),
        orientation=_quaternion(bag, truth.T_map_base.rotation),
    )
    return bag.make("geometry_msgs/msg/PoseStamped", header=bag.header(truth.stamp_ns, "map"), pose=pose)


def _xyz(vector: Float64s) -> dict[str, float]:
    return dict(zip("xyz", vector.tolist(), strict=True))


def _vector(bag: Recorder, vector: Float64s) -> object:
    return bag.make("geometry_msgs/msg/Vector3", **_xyz(vector))


def _quaternion(bag: Recorder, rotation: Float64s) -> object:
    return bag.make("geometry_msgs/msg/Quaternion", **_xyz(rotation[1:]), w=float(rotation[0]))
