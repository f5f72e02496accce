"""What the tables of accuracy are made of: two methods, simulated drives, recordings, and what they must reach."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import get_args

from hectorscope.cli.opening import Scene, demo_bag
from hectorscope.inputs import SourceOptions
from hectorscope.simulation import SceneOptions
from slam_core.config import SlamConfig, with_value
from tests.conftest import ROOT

BESIDE = ROOT.parent / "shared" / "data"
SEEDS = (1, 2, 3, 4, 5)
DRIVE_SEEDS = tuple(range(1, 21))  # one drive in the rooms or another is lucky
LOST_M = 1.0  # a raw error beyond this is no inaccuracy any more

METHODS = {"paper": SlamConfig.paper(), "full": SlamConfig()}
CELLS_ALONE = with_value(SlamConfig(), "matcher.surfel_weight", 0.0)


@dataclass(frozen=True, slots=True)
class Drive:
    """A simulated drive through the rooms; with inertial data its raw error must stay below `goal_m`."""

    name: str
    options: SceneOptions
    goal_m: float


_SWAYING = SceneOptions(sway=15.0, sway_frequency=1.2)
DRIVES = (
    Drive("40 Hz, exact timing", SceneOptions(beam_timing=False), 0.015),
    Drive("40 Hz", SceneOptions(), 0.020),
    Drive("40 Hz, sway", _SWAYING, 0.030),
    Drive("10 Hz, sway", replace(_SWAYING, scan_rate=10.0), 0.050),
    Drive("5 Hz", SceneOptions(scan_rate=5.0), 0.050),
    Drive("5 Hz, sway", replace(_SWAYING, scan_rate=5.0), 0.050),
)
CORRIDOR = SceneOptions()
HALLS, HALL_SEEDS = SceneOptions(), SEEDS[:3]
GLASS, STRAYS = SceneOptions(duration=40.0), SceneOptions(duration=30.0)


@dataclass(frozen=True, slots=True)
class Recording:
    """A recording; where it has a truth, its aligned error must stay below `goal_m`.

    settings: what its devices need besides the options, by name.
    """

    name: str
    path: Path
    goal_m: float | None = None
    options: SourceOptions = field(default_factory=SourceOptions)
    settings: tuple[tuple[str, float], ...] = ()


MIT = BESIDE / "mit_csail"
_HALLWAY = SourceOptions(scan_sweep=-0.0693)  # found by `hectorscope inspect`, as what follows
DEMOS = tuple(Recording(f"{scene} (simulated)", demo_bag(scene)) for scene in get_args(Scene))
REAL = (
    Recording("jackal_vicon 15-54-31", BESIDE / "jackal_vicon/test_2026-02-17-15-54-31.bag", 0.0143),
    Recording("jarvis_nav350 circular", BESIDE / "jarvis_nav350/jarvis_circular_path_fast.bag", 0.030),
    Recording(
        "stage_sim_gt",
        BESIDE / "stage_sim_gt/run1_fixed.bag",
        options=SourceOptions(truth_topic="tf:map>base_link"),
    ),
    Recording(
        "mit_csail",
        MIT / "mit-csail.clf",
        options=SourceOptions(truth_topic=str(MIT / "csail-corrected.log.gz")),
    ),
    Recording("hallway eng403_good", BESIDE / "hallway_rplidar/eng403_good.bag", options=_HALLWAY),
    Recording("ccny_handheld", BESIDE / "ccny_handheld/demo_initial_commit.bag"),
    Recording(
        "mumble kitchen_1",
        BESIDE / "mumble_lidar_imu/kitchen_1",
        options=SourceOptions(imu_accel_unit="mg", imu_gyro_unit="deg/s", scan_mirrored=True, scan_delay=0.11),
        settings=(("navigation.accel_noise", 0.1),),  # cheap, read at uneven times: the default is five times less
    ),
)
FURTHER = (  # without a truth, and no part of the other tables
    Recording("jackal_vicon 11-53-31", BESIDE / "jackal_vicon/test_2026-02-19-11-53-31.bag"),
    Recording("coreslam_urg", BESIDE / "coreslam_urg/exp1.dat"),
    Recording("hallway", BESIDE / "hallway_rplidar/hallway.bag", options=_HALLWAY),
    Recording("ccny_tilted_handheld", BESIDE / "ccny_tilted_handheld/demo_v2.bag"),
    Recording(
        "turtlebot4",
        BESIDE / "turtlebot4_rosbag2/macfirst_floor_take_2",
        options=SourceOptions(scan_sweep=-0.1336),
    ),
)
INERTIAL = (
    Recording(
        "ardrone", BESIDE / "imu_only/ardrone_imu.bag", options=SourceOptions(attitude_topic="/ardrone/imu")
    ),
    Recording(
        "phidgets, upside down",
        BESIDE / "imu_only/phidgets_imu_upside_down.bag",
        options=SourceOptions(imu_rotation=(3.14159, 0.0, 0.0)),
    ),
    Recording("razor", BESIDE / "imu_only/sparkfun_razor.bag"),
)
TIMED = (*DEMOS, *REAL[:2])
COMPARED = (*DEMOS, *REAL[:3], REAL[4])  # with others


def present(recordings: tuple[Recording, ...]) -> list[Recording]:
    """Those that are there: the real ones lie beside the project and are no part of it."""
    return [recording for recording in recordings if recording.path.exists()]
