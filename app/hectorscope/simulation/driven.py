"""A robot that is driven by hand through a world: its measurements, one step of its motion after another.

What it measures is a function of the seed and of the requests before each step.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from hectorscope.simulation.beams import first_returns
from hectorscope.simulation.course import STILL
from hectorscope.simulation.furniture import Furniture
from hectorscope.simulation.motion import DEGREE, STEP, Motion
from hectorscope.simulation.options import SceneOptions, SimulationError
from hectorscope.simulation.scene import ease_in
from hectorscope.simulation.scene_arena import on_tracks
from hectorscope.simulation.sensors import BAROMETER, measured, nanoseconds
from hectorscope.simulation.simulation import SCENES
from hectorscope.steering import FAULTS, DriveState, PutBox, Request, SetDoor, SetFault, Steer, TakeBox
from slam_core.measurements import Float64s, Height, Imu, LaserScan, TruthPose

DriveWorld = Literal["rooms", "arena", "corridor", "offices", "glass"]

SPEED, TURN = 1.0, float(np.radians(75.0))  # at full deflection: m/s, rad/s
PICK_UP, SPIN_UP = 1.2, float(np.radians(250.0))  # m/s^2, rad/s^2
RADIUS = 0.3  # m: the middle of the robot stays so far from what is ahead of it
CONE = np.radians(np.linspace(-50.0, 50.0, 11))  # in which it looks ahead
BRAKE = 2.0  # m/s of speed for each metre to an obstacle
SWAY_FREQUENCY = 0.5  # Hz
IMU_AT = np.array([0.0, 0.01, 0.02, 0.03])  # s within a step
BEAMS = 541  # of a sweep; one sweep a step


class DrivenRobot:
    """x, y, yaw follow the hand with limited accelerations; a spline through them is the truth, as in `Motion`.

    The robot rests for STILL seconds, so that a filter can settle. SimulationError for an unknown world.
    """

    def __init__(self, world: DriveWorld, seed: int = 1) -> None:
        if world not in get_args(DriveWorld):
            raise SimulationError(f"world is {world!r}: choose from {', '.join(get_args(DriveWorld))}")
        self._scene = replace(SCENES[world](SceneOptions(people=False)), people=())
        self._has_floor = world == "arena"
        self.furniture = Furniture(self._scene.world, world)
        self._world, self._name = self._scene.world, world
        self._faults = {name: fault.default for name, fault in FAULTS.items()}
        self._ranges, self._gyro, self._accel, self._height = (np.random.default_rng([seed, k]) for k in range(4))
        self._pose, self._speed, self._turn = np.zeros(3), 0.0, 0.0
        self._steer = Steer(0.0, 0.0)
        self._steps = 0
        self._controls: deque[Float64s] = deque((self._control(k) for k in range(-2, 3)), DEGREE + 1)

    @property
    def state(self) -> DriveState:
        """What a page shows."""
        return DriveState(self._name, dict(self._faults), self.furniture.doors, self.furniture.boxes)

    def obey(self, request: Request) -> str:
        """From the next step on; a sentence if that cannot be. Values out of range are clamped."""
        match request:
            case Steer(forward, turn):
                self._steer = Steer(*np.clip(np.nan_to_num([forward, turn]), -1.0, 1.0).tolist())
            case SetFault(name, value) if name in FAULTS:
                self._faults[name] = FAULTS[name].clamped(value)
            case SetDoor(number, is_open):
                return self.furniture.set_door(number, is_open, self._pose)
            case PutBox(number, place):
                return self.furniture.put_box(number, place, self._pose)
            case TakeBox(number):
                self.furniture.take_box(number)
        return ""

    def step(self) -> Iterator[TruthPose | Imu | Height | LaserScan]:
        """The measurements of the next STEP seconds, in order of arrival."""
        t = self._steps * STEP
        self._world = self.furniture.world
        self._move(self._steer if t >= STILL else Steer(0.0, 0.0))
        self._controls.append(self._control(self._steps + 3))
        motion = Motion(np.array(self._controls), STEP)
        self._steps += 1
        for at in (0.0, STEP / 2):
            yield TruthPose(nanoseconds(t + at), motion.transform(at))
        yield from self._inertial(motion, t)
        if self._steps % 2:
            over_start = motion.at(np.zeros(1))[0, 2]
            yield Height(nanoseconds(t), float(over_start + self._height.normal(scale=BAROMETER.noise)))
        yield self._scan(motion, t)

    def _move(self, steer: Steer) -> None:
        """Pose after another STEP; speed and turn rate approach what is wanted."""
        wanted = SPEED * steer.forward
        wanted = float(np.copysign(min(abs(wanted), BRAKE * self._free(wanted < 0.0)), wanted))
        self._speed += float(np.clip(wanted - self._speed, -2 * PICK_UP * STEP, PICK_UP * STEP))
        self._turn += float(np.clip(TURN * steer.turn - self._turn, -SPIN_UP * STEP, SPIN_UP * STEP))
        yaw = self._pose[2] + self._turn * STEP / 2
        self._pose = self._pose + STEP * np.array(
            (self._speed * np.cos(yaw), self._speed * np.sin(yaw), self._turn)
        )

    def _free(self, backwards: bool) -> float:
        """Metres that the robot may go on in its direction, at the height of its laser."""
        yaw = self._pose[2] + CONE + (np.pi if backwards else 0.0)
        height = self._scene.T_base_laser.translation[2] + (self._controls[-1][2] if self._controls else 0.0)
        origins = np.tile([*self._pose[:2], height], (len(yaw), 1))
        ahead = np.column_stack((np.cos(yaw), np.sin(yaw), np.zeros(len(yaw))))
        distances, _ = self._world.cast(origins, ahead, 10.0)
        return max(0.0, float(distances.min()) - RADIUS)

    def _control(self, index: int) -> Float64s:
        """(6,) x, y, z, roll, pitch, yaw near `index` steps: the pose, the ground below it, and the sway."""
        t = np.array([index * STEP])
        swayed = np.zeros((1, 6))
        phase = 2 * np.pi * SWAY_FREQUENCY * t
        amplitude = np.radians(self._faults["sway"]) * ease_in(t, STILL, 2.0)
        swayed[:, 3], swayed[:, 4] = amplitude * np.sin(phase), amplitude * np.sin(0.83 * phase + 1.0)
        pose, bare = self._pose[None], self._scene.world
        swayed[:, [0, 1, 5]] = pose
        values = on_tracks(bare, lambda _: pose, lambda _: swayed)(t) if self._has_floor else swayed
        control: Float64s = values[0]
        return control

    def _inertial(self, motion: Motion, t: float) -> Iterator[Imu]:
        faults, shape = self._faults, (len(IMU_AT), 3)
        gyro = self._gyro.normal(scale=np.radians(faults["gyro_noise"]), size=shape)
        accel = self._accel.normal(scale=faults["accel_noise"], size=shape)
        rates = motion.body_rates(IMU_AT) + np.radians(faults["gyro_bias"]) + gyro
        forces = motion.specific_force(IMU_AT) + np.array([faults["accel_bias"], 0.0, 0.0]) + accel
        for at, omega, force in zip(IMU_AT, rates, forces, strict=True):
            yield Imu(nanoseconds(t + at), omega, force)

    def _scan(self, motion: Motion, t: float) -> LaserScan:
        """One sweep; the scanner turns once in a step."""
        sigma = self._faults["range_noise"]
        scanner = replace(self._scene.scanner, sigma_near=sigma, sigma_far=3.0 * sigma)
        increment = scanner.field / (BEAMS - 1)
        time_increment = STEP * increment / (2 * np.pi)
        count = np.arange(BEAMS, dtype=np.float64)
        angles = increment * count - scanner.field / 2
        scene = replace(self._scene, motion=motion, world=self._world)
        true, depths = first_returns(scene, time_increment * count, angles, scanner.range_max, self._ranges)
        return LaserScan(
            stamp_ns=nanoseconds(t),
            ranges=measured(scanner, true, depths, 1.0, self._ranges).astype(np.float32),
            angle_min=float(angles[0]),
            angle_increment=float(increment),
            time_increment=float(time_increment),
            range_min=scanner.range_min,
            range_max=scanner.range_max,
            T_base_laser=scene.T_base_laser,
        )
