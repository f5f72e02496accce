"""A robot that is driven by hand: what it does, what it measures, and what stands in its way."""

import numpy as np
import pytest

from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.simulation.driven import DrivenRobot
from hectorscope.simulation.options import SimulationError
from hectorscope.steering import FAULTS, PutBox, SetDoor, SetFault, Steer, TakeBox
from slam_core.config import SlamConfig, with_value
from slam_core.geometry import to_euler
from slam_core.kernels.bilinear import WHOLE
from slam_core.measurements import Imu, LaserScan, TruthPose

REST = 65  # steps: longer than the robot rests
HALT = Steer(0.0, 0.0)
OCCUPIED = 0.1 * WHOLE  # of a cell's probability, above one half


def driven(robot, steps, steer=HALT):
    """All that is measured in so many steps."""
    robot.obey(steer)
    return [item for _ in range(steps) for item in robot.step()]


def place(items):
    """x, y where the robot truly is at the end."""
    return [item for item in items if isinstance(item, TruthPose)][-1].T_map_base.translation[:2]


def test_the_same_seed_and_hand_give_the_same_measurements():
    """Bit by bit; another seed gives other noise."""
    first, same, other = (DrivenRobot("rooms", seed) for seed in (7, 7, 8))
    runs = [driven(robot, REST + 10, Steer(1.0, 0.3)) for robot in (first, same, other)]
    scans = [np.concatenate([i.ranges for i in run if isinstance(i, LaserScan)]) for run in runs]
    rates = [np.concatenate([i.angular_velocity for i in run if isinstance(i, Imu)]) for run in runs]
    assert scans[0].tobytes() == scans[1].tobytes() != scans[2].tobytes()
    assert rates[0].tobytes() == rates[1].tobytes() != rates[2].tobytes()


def test_the_pipeline_follows_the_hand():
    """The pose stays within 5 cm of the truth on a curved drive."""
    robot, pipeline = DrivenRobot("rooms"), Pipeline(Settings(SlamConfig()), live=True)
    items = driven(robot, REST) + driven(robot, 100, Steer(0.8, 0.4))
    for item in items:
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
    assert np.linalg.norm(place(items)) > 1.0
    assert pipeline.result is not None
    assert np.linalg.norm(pipeline.result.T_map_base.translation[:2] - place(items)) < 0.05


def test_the_filter_finds_the_bias_that_a_slider_gave_the_gyroscopes():
    """Within a tenth of a degree per second after some seconds at rest and in motion."""
    robot, pipeline = DrivenRobot("rooms"), Pipeline(Settings(SlamConfig()), live=True)
    robot.obey(SetFault("gyro_bias", 0.5))
    for item in driven(robot, REST) + driven(robot, 150, Steer(0.5, 0.3)):
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
    assert pipeline.result is not None and pipeline.result.navigation is not None
    assert np.degrees(pipeline.result.navigation.gyro_bias) == pytest.approx([0.5] * 3, abs=0.1)


def pipeline_after(config: SlamConfig, fault: str, value: float, *moves: tuple[int, Steer]) -> Pipeline:
    """A run over a rest and these moves (steps, steering), with one error of a sensor."""
    robot, pipeline = DrivenRobot("rooms"), Pipeline(Settings(config), live=True)
    robot.obey(SetFault(fault, value))
    for steps, steer in ((REST, HALT), *moves):
        for item in driven(robot, steps, steer):
            for measurement in pipeline.admit(item):
                pipeline.step(measurement)
    return pipeline


def test_a_forward_bias_of_the_accelerometers_looks_like_a_pitch_until_the_robot_turns():
    """At rest the whole of it is a pitch of 3 degrees; a turn on the spot tells them apart."""
    for moves, bias, pitch in (((), 0.0, -2.9), (((60, Steer(0.0, 1.0)),), 0.5, 0.0)):
        pipeline = pipeline_after(SlamConfig(), "accel_bias", 0.5, *moves)
        assert pipeline.result is not None and pipeline.result.navigation is not None
        assert pipeline.result.navigation.accel_bias[0] == pytest.approx(bias, abs=0.08)
        assert np.degrees(to_euler(pipeline.result.T_map_base.rotation)[1]) == pytest.approx(pitch, abs=0.3)


def test_the_map_of_a_tilting_lidar_smears_without_stabilisation():
    """Twice as many cells are occupied, and the pose is off; with it the sway leaves no trace in the map."""
    moves = ((60, Steer(0.8, 0.15)), (100, Steer(0.6, 0.3)), (100, Steer(0.6, -0.3)))
    off = with_value(SlamConfig(), "scan.stabilise", False)
    runs = [
        pipeline_after(config, "sway", sway, *moves)
        for config, sway in ((SlamConfig(), 0.0), (SlamConfig(), 15.0), (off, 15.0))
    ]
    level, swaying, smeared = (int((run.slam.map.levels[0].cells > OCCUPIED).sum()) for run in runs)
    assert swaying < 1.2 * level
    assert smeared > 2 * swaying


def test_a_box_stops_the_robot_until_it_is_taken_away():
    """The robot halts before the box that stands ahead, and goes on without it."""
    robot = DrivenRobot("rooms")
    driven(robot, REST)
    assert robot.obey(PutBox(0, None)) == ""
    halted = place(driven(robot, 200, Steer(1.0, 0.0)))
    assert 0.5 < halted[0] < 1.2 - 0.2
    robot.obey(TakeBox(0))
    assert place(driven(robot, 100, Steer(1.0, 0.0)))[0] > 2.0


def test_a_closed_door_is_a_wall_to_the_laser():
    """The beam through the doorway of the rooms comes back sooner once the door is closed."""
    robot = DrivenRobot("rooms")
    open_ = [item for item in driven(robot, 1) if isinstance(item, LaserScan)][-1]
    robot.obey(SetDoor(0, False))
    closed = [item for item in driven(robot, 1) if isinstance(item, LaserScan)][-1]
    nearer = open_.ranges - closed.ranges > 0.5
    assert nearer.sum() > 5


def test_nothing_is_put_into_the_robot():
    """A box at its place is refused with a sentence, and the world stays as it was."""
    robot = DrivenRobot("rooms")
    assert "drive away" in robot.obey(PutBox(1, (0.1, 0.0)))
    assert robot.state.boxes == (None, None)


def test_values_out_of_range_are_clamped_and_foreign_ones_ignored():
    """Whatever the page sends, the robot keeps to its limits and its own doors and boxes."""
    robot = DrivenRobot("corridor")
    robot.obey(SetFault("sway", 1e9))
    robot.obey(SetFault("gyro_bias", float("nan")))
    robot.obey(SetFault("no such", 1.0))
    robot.obey(SetDoor(5, False))
    robot.obey(PutBox(9, None))
    driven(robot, REST)
    far = place(driven(robot, 50, Steer(1e9, float("nan"))))
    assert robot.state.faults == {**{name: each.default for name, each in FAULTS.items()}, "sway": 20.0}
    assert 1.0 < far[0] < 2.5


@pytest.mark.parametrize("world", ["rooms", "arena", "corridor", "offices", "glass"])
def test_every_world_can_be_driven(world):
    """Each gives scans with returns, and the robot moves."""
    robot = DrivenRobot(world)
    items = driven(robot, REST) + driven(robot, 25, Steer(0.5, 0.0))
    assert place(items)[0] > 0.1
    assert np.isfinite([i for i in items if isinstance(i, LaserScan)][-1].ranges).sum() > 100


def test_an_unknown_world_is_named():
    """The message has the value and the choices."""
    with pytest.raises(SimulationError, match="'moon': choose from rooms"):
        DrivenRobot("moon")  # type: ignore[arg-type]
